"""Every row of docs/how-to/simulate-faults.md happens as it stands there, and its example runs."""

from __future__ import annotations

import asyncio
import re
from pathlib import Path

import pytest
from tests.docs.test_api import example_output

import passo
from passo.events import Message
from passo.printer.status import PrinterState

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/how-to/simulate-faults.md").read_text(encoding="utf-8")
HEAD = "| command, then | fault | what the machine does | what you see | what to do |\n"
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.split(HEAD)[1].split("\n\n")[0].splitlines()[1:]
]


@pytest.mark.parametrize("row", ROWS, ids=[f"{row[1]} {row[0]}" for row in ROWS])
def test_each_documented_fault_occurs_as_described(row):
    begin, fault, does, sees, _ = row
    line, seconds = re.fullmatch(r"`(.+)` (\d+) s", begin).groups()
    part, value = fault.strip("`").split("=")

    async def main():
        async with passo.Printer("i3") as printer:
            told = []
            printer.on_event(lambda e: told.append(e.text) if isinstance(e, Message) else None)
            await printer.send(line)
            await asyncio.sleep(float(seconds) + 0.1)
            printer.inject_fault(part, value)
            loop = asyncio.get_running_loop()
            begun = loop.time()
            if homes := "`G28` fails" in does or "every step" in does:
                try:
                    await printer.send("G28")
                except passo.CommandError as error:
                    told.append(str(error))
            if within := re.search(r"within (\d+) s", does):
                if not homes:
                    while printer.status.state is not PrinterState.HALTED:
                        await asyncio.sleep(0.1)
                assert int(within[1]) - 6 < loop.time() - begun < int(within[1])
            else:
                await asyncio.sleep(60)
            await asyncio.sleep(4)
            await check(printer, does)
            for text in re.findall(r"`([^`]+)`", sees):
                assert any(text in message for message in told), (text, told)
            if not sees:
                assert [m for m in told if "notification" not in m] == [
                    f"echo:Simulated fault: {part}={value}"
                ]
            printer.inject_fault(part, "none")
            if "by hand" in row[4]:
                printer._printer.board.place("x", 20.0)
            await printer.send("M999")
            await asyncio.sleep(2)
            assert printer.status.state is PrinterState.IDLE
            await printer.send("G28")
            assert printer.status.homed == {"x", "y", "z"}

    passo.run(main(), clock="virtual")


async def check(printer, does):
    """The state that the third column describes."""
    status, board = printer.status, printer._printer.board
    if "continues" in does:
        assert (status.state, status.halted) == (PrinterState.IDLE, "")
        if "every step" in does:
            assert status.homed == {"x", "y", "z"}
            assert [board.position(axis) for axis in "xyz"] == pytest.approx([0, 0, 0], abs=0.02)
    elif "unhomed" in does:
        assert status.state is PrinterState.IDLE
        assert "x" not in status.homed
    else:
        assert status.state is PrinterState.HALTED
        powers = [board.output_value(name) for name in printer.config.heaters]
        assert powers == [0] * len(powers)
        hot = {name: board.temperature(name) for name in printer.config.heaters}
        await asyncio.sleep(60)
        warmer = {name for name, celsius in hot.items() if board.temperature(name) > celsius + 1}
        assert len(warmer) == ("cannot stop this heater" in does)


def test_the_example_prints_what_is_shown(tmp_path):
    code, output = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", PAGE, re.DOTALL)[0]
    assert example_output(tmp_path, code) == output


def test_all_parts_and_faults_are_named():
    async def main():
        async with passo.Printer("i3") as printer:
            return printer.faults

    faults = passo.run(main(), clock="virtual")
    tried = {row[1].strip("`").partition(":")[0] for row in ROWS}
    kinds = {
        f"{part.split('-')[-1]}={value}" for part, values in faults.items() for value in values[1:]
    }
    assert {fault.split("-")[-1] for fault in tried} == kinds
