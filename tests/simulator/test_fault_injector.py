"""Faults of the simulated printer by command, option and Python, and when they begin and end."""

from __future__ import annotations

import asyncio

import pytest
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

import passo
from passo import config
from passo.board.fault_injection import FaultOrder
from passo.cli.main import main
from passo.events import Message
from passo.printer.status import PrinterState

FIRMWARE = config.load("i3")
FIRMWARE = FIRMWARE.model_copy(
    update={"board": FIRMWARE.board.model_copy(update={"firmware": "passo"})}
)


def test_a_console_lists_parts_and_faults():
    with Scenario("i3") as s:
        s.host.ok("SIMULATE_FAULT NAME=x-endstop VALUE=open")
        assert s.host.ok("SIMULATE_FAULT")[:-1] == [
            "echo:hotend-sensor=none (of none, open, short, noise, loose)",
            "echo:hotend-heater=none (of none, on, off)",
            "echo:bed-sensor=none (of none, open, short, noise, loose)",
            "echo:bed-heater=none (of none, on, off)",
            "echo:x-endstop=open (of none, triggered, open)",
            "echo:y-endstop=none (of none, triggered, open)",
            "echo:z-endstop=none (of none, triggered, open)",
            "echo:cable=none (of none, cut, noise)",
        ]
        assert s.host.ok("M119")[1:-1] == ["x_min: open", "y_min: open", "z_min: open"]
        s.host.ok("SIMULATE_FAULT name=x-endstop value=TRIGGERED")
        assert "x_min: TRIGGERED" in s.host.ok("M119")
        s.host.ok("SIMULATE_FAULT NAME=x-endstop VALUE=none")
        assert "x_min: open" in s.host.ok("M119")


@pytest.mark.parametrize(
    ("parameters", "answer"),
    [
        ("NAME=nozzle VALUE=open", "nozzle is not a fault of this machine: expected hotend-sensor"),
        ("NAME=hotend-sensor VALUE=cut", "hotend-sensor=cut is not a fault of this machine"),
        ("NAME=cable VALUE=noise:2", "expected none, cut, noise (or noise:SHARE, from 0 to 1)"),
        ("NAME=cable VALUE=cut:0.1", "cable=cut:0.1 is not a fault of this machine"),
        ("VALUE=open", "'' is not a fault of this machine"),
        ("NAME=cable VALUE=cut AFTER=soon", "AFTER=soon is not understood: expected seconds"),
        ("NAME=cable VALUE=cut AFTER=-1", "AFTER=-1 is not understood: expected seconds"),
        ("NAME=hotend-sensor VALUE=cut AFTER=9", "hotend-sensor=cut is not a fault"),
        ("PART=cable VALUE=cut", "PART is not understood"),
    ],
)
def test_unknown_fault_is_answered_with_known_ones(parameters, answer):
    with Scenario("i3") as s:
        assert answer in s.host.ok(f"SIMULATE_FAULT {parameters}")[0]
        s.passes(20)
        assert s.printer.rig.connection.injector.active == {}


def test_real_boards_refuse_simulated_faults():
    with Scenario("i3") as s:
        s.printer.rig.connection.injector = None
        for line in ("SIMULATE_FAULT", "SIMULATE_FAULT NAME=cable VALUE=cut"):
            assert s.host.ok(line)[0] == (
                "echo:the boards of this machine are real, and no fault can be simulated on them."
                " Start passo serve with --simulated."
            )


@pytest.mark.parametrize(
    ("text", "order"),
    [
        ("cable=cut", FaultOrder("cable", "cut")),
        ("cable=cut@60s", FaultOrder("cable", "cut", 60.0)),
        ("cable=cut@60s+2.5s", FaultOrder("cable", "cut", 60.0, 2.5)),
        ("cable=noise:0.1@1.5min+1min", FaultOrder("cable", "noise:0.1", 90.0, 60.0)),
        ("bed-sensor=none@90", FaultOrder("bed-sensor", "none", 90.0)),
        (" cable = cut + 3 s ", FaultOrder("cable", "cut", 0.0, 3.0)),
    ],
)
def test_fault_commands_are_parsed(text, order):
    assert FaultOrder.parse(text) == order


@pytest.mark.parametrize("text", ["", "cable", "cable=", "=cut", "cable=cut@", "cable=cut@1h"])
def test_invalid_fault_order_gets_an_example(text):
    with pytest.raises(passo.CommandError, match="expected PART=FAULT"):
        FaultOrder.parse(text)


@pytest.mark.parametrize("fast", [False, True])
def test_a_fault_begins_and_ends_at_print_times(fast):
    async def body():
        async with passo.Printer("i3", fast=fast) as printer:
            times = []

            def note(event):
                if isinstance(event, Message) and "Simulated" in event.text:
                    times.append((round(printer.status.time_s), event.text.rpartition(" ")[2]))

            printer.on_event(note)
            printer.inject_fault("y-endstop", "triggered", after_s=20.0, for_s=10.0)
            printer.inject_fault("x-endstop", "open", after_s=25.0)
            printer.inject_fault("x-endstop", "none", after_s=40.0)
            await printer.send("G92 X0 Y0 Z0")
            await printer.send("G4 S60")
            await printer.send("M400")
            return times

    assert passo.run(body(), clock="virtual") == [
        (20, "y-endstop=triggered"),
        (25, "x-endstop=open"),
        (30, "y-endstop=none"),
        (40, "x-endstop=none"),
    ]


def test_a_fault_ends_while_the_printer_is_halted():
    async def body():
        async with passo.Printer("i3") as printer:
            printer.inject_fault("bed-sensor", "short", for_s=30.0)
            await asyncio.sleep(5)
            assert printer.status.state is PrinterState.HALTED
            with pytest.raises(passo.CommandError, match="reads 400"):  # it is still there
                await printer.send("M999")
            assert printer.status.state is PrinterState.HALTED
            await asyncio.sleep(30)
            await printer.send("M999")
            await asyncio.sleep(2)
            return printer.status.state

    assert passo.run(body(), clock="virtual") is PrinterState.IDLE


def test_a_halted_printer_cools_down():
    async def body():
        async with passo.Printer("i3") as printer:
            await printer.send("M109 S200")
            await printer.send("M112")
            await asyncio.sleep(1)
            hot_c = printer._printer.board.temperature("hotend")
            await asyncio.sleep(300)
            return hot_c, printer._printer.board.temperature("hotend")

    hot_c, later_c = passo.run(body(), clock="virtual")
    assert hot_c > 190
    assert later_c < 60


def test_print_survives_cut_cable_with_passo_firmware(tmp_path):
    path = tmp_path / "part.gcode"
    path.write_text("G28\n" + "".join(f"G1 X{10 + i % 2 * 90} F3000\n" for i in range(40)))

    async def printed(*, cut):
        async with passo.Printer(FIRMWARE) as printer:
            told = []
            printer.on_event(lambda e: told.append(e.text) if isinstance(e, Message) else None)
            if cut:
                printer.inject_fault("cable", "cut", after_s=20.0, for_s=2.0)
            summary = await printer.print(path)
            return summary, printer._printer.board.net_steps("x"), told

    whole = passo.run(printed(cut=False), clock="virtual")
    torn = passo.run(printed(cut=True), clock="virtual")
    assert torn[0].outcome == "done"
    assert torn[1] == whole[1]
    assert any("The board is back" in text for text in torn[2])
    assert torn[0].print_s > whole[0].print_s + 2


def test_cables_of_several_boards_are_named():
    async def body():
        async with passo.Printer(two_boards()) as printer:
            cables = [part for part in printer.faults if part.endswith("cable")]
            printer.inject_fault("tool-cable", "cut")
            await asyncio.sleep(30)
            return cables, printer.status.state

    assert passo.run(body(), clock="virtual") == (["cable", "tool-cable"], PrinterState.HALTED)


def test_serve_lists_the_faults_and_refuses_others(capsys, tmp_path):
    assert main(["serve", "--fault", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "hotend-sensor=none|open|short|noise|loose"
    assert lines[-1] == "cable=none|cut|noise"
    for fault, status in (("cable", 4), ("nozzle=open", 4), ("cable=open@60s", 4)):
        assert main(["serve", "--fault", fault, "--tcp", "127.0.0.1:0"]) == status
        assert "expected" in capsys.readouterr().err
    machine = tmp_path / "real.toml"
    machine.write_text(
        config.shipped_text("i3").replace("[board]", '[board]\nlink = "tcp"\nport = "h:1"')
    )
    assert main(["serve", "--machine", str(machine), "--fault", "cable=cut"]) == 4
    assert "the boards of this machine are real" in capsys.readouterr().err


def test_a_print_without_consoles_warns_of_it(capsys, tmp_path):
    path = tmp_path / "a.gcode"
    path.write_text("G28\nSIMULATE_FAULT NAME=cable VALUE=cut\nG1 X9 F3000\n")
    assert main(["print", str(path)]) == 0
    assert "SIMULATE_FAULT" in capsys.readouterr().err


def test_tilted_bed_is_measured_so_and_flat_again():
    with Scenario("i3-probe") as s:

        def height():
            s.host.ok("G28", within=60)
            (line,) = [line for line in s.host.ok("G30 X200 Y110", within=60) if "Z" in line]
            return float(line.rsplit("Z", 1)[1].lstrip(": ").split()[0])

        before = height()
        s.host.ok("SIMULATE_FAULT NAME=bed VALUE=tilted")
        assert height() - before == pytest.approx(1.0 * (200 - 125) / 250, abs=0.02)
        s.host.ok("SIMULATE_FAULT NAME=bed VALUE=none")
        assert height() == pytest.approx(before, abs=0.02)
