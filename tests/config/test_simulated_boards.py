"""Machines with simulated boards in place of their real ones."""

from __future__ import annotations

import pytest

from passo import config
from passo.config.load import load_text, shipped_text

HEAD = 'link = "serial"\nport = "/dev/ttyUSB7"\nbaud = 115200\n'
TOOL = """
[boards.tool]
base = "ramps"
link = "tcp"
port = "192.168.1.20:8888"
"""
KLIPPERS = 'firmware = "klipper"\n'


def real(*lines: str, tool: str = TOOL) -> config.MachineConfig:
    text = shipped_text("i3").replace("[board]\n", f"[board]\n{HEAD}{''.join(lines)}")
    return load_text(text.replace('socket = "E0"', 'socket = "tool:E0"') + tool)


@pytest.mark.parametrize(("lines", "runs"), [([], "passo"), ([KLIPPERS], "klipper")])
def test_a_plan_keeps_the_limits_of_real_boards(lines, runs):
    machine = real(*lines)
    simulated = config.on_simulated_boards(machine)
    assert [b.link for b in simulated.all_boards.values()] == ["simulated", "simulated"]
    assert [b.port for b in simulated.all_boards.values()] == [None, None]
    assert simulated.board.firmware == runs
    assert simulated.board.link_bytes_s == pytest.approx(0.095 * 115200)
    assert simulated.core_spec() == machine.core_spec()
    assert [b.survives for b in simulated.all_boards.values()] == [runs == "passo", True]


def test_simulated_boards_stay_as_they_are():
    machine = config.load("i3")
    assert config.on_simulated_boards(machine) == machine
