"""The tables of the how-tos about outputs, sensors, fans and lights are those of a machine file,
and their commands work."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo.config.load import load_text, shipped_text
from passo.config.machine import MachineConfig

FOLDER = Path(__file__).parents[2] / "docs" / "how-to"


def machine(page: str) -> MachineConfig:
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    tables = "\n".join(re.findall(r"```toml\n(.*?)```", text, re.DOTALL))
    return load_text(f"{shipped_text('i3')}\n{tables}", "i3.toml")


def commands(page: str) -> list[str]:
    """The commands at the beginning of the rows of tables."""
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    return re.findall(r"^\| `([A-Z][^`]*)` \|", text, re.MULTILINE)


@pytest.mark.parametrize("page", ["use-lights", "use-fans", "switch-outputs", "show-temperatures"])
def test_tables_and_commands_of_the_page_work(page):
    with Scenario(machine(page)) as s:
        s.passes(1)
        for line in commands(page):
            if "WAIT" in line or line.startswith(("M191", "M240")):
                continue  # they take as long as the chamber, or need a camera
            s.host.ok(line)
        s.passes(3)
        assert not s.printer.state.halted
        assert not [line for line in s.host.heard if "rror" in line or "expected" in line]


def test_fan_of_the_page_pauses_or_reports():
    with Scenario(machine("use-fans")) as s:
        s.host.ok("M104 S200")
        s.passes(60)
        assert s.printer.status.read().fan_rpm["hotend"] == pytest.approx(5000, rel=0.02)
        s.host.ok("SIMULATE_FAULT NAME=hotend-fan VALUE=stalled")
        s.host.expect("fan hotend has power and turns at 0 rpm", 8)
