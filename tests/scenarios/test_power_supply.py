"""A power supply that the board switches."""

from __future__ import annotations

import pytest
from tests.support.driver_machine import machine_text
from tests.support.scenario import Scenario

from passo import config
from passo.errors import ConfigError

MAINS = '[mains]\npin = "D12"\n'


def machine(more: str = MAINS):
    return config.load_text(f"{config.shipped_text('i3')}\n{more}")


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        yield s


TOOL = """[boards.tool]
base = "klipper"
clock_hz = 16_000_000
move_count = 500
"""


@pytest.mark.parametrize(
    ("pin", "more", "level"), [("!D12", "", 0), ("tool:PA1", TOOL, 1), ("!tool:PA1", TOOL, 0)]
)
def test_supply_may_be_on_any_pin_of_any_board(pin: str, more: str, level: int):
    with Scenario(machine(f'[mains]\npin = "{pin}"\n{more}')) as s:
        s.passes(1)
        assert s.board.output_value("mains") == level
        s.host.ok("M81")
        s.passes(0.5)
        assert s.board.output_value("mains") == 1 - level
        s.host.ok("M80")
        s.passes(0.5)
        assert s.board.output_value("mains") == level
        s.host.send("M112")
        s.passes(1)
        assert s.board.output_value("mains") == 1 - level


def on(s) -> bool:
    return s.board.output_value("mains") == 1


def test_m80_and_m81_switch_the_power_supply(s):
    assert on(s)
    assert s.host.ok("M80 S") == ["PS:1", "ok"]
    s.host.ok("M104 S100 F")
    s.host.ok("M81")
    s.passes(0.5)
    assert not on(s)
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert s.board.output_value("x-enable") == 1  # inverted: off
    assert s.host.ok("M80 S") == ["PS:0", "ok"]
    assert "the power supply is off" in s.host.ok("M104 S100")[0]
    s.host.ok("M104 S0")
    s.host.ok("M80")
    assert on(s)
    s.host.ok("M104 S100 F")
    s.host.ok("G28", 60)
    assert s.printer.state.halted == ""


def test_motion_is_refused_while_supply_is_off(s):
    s.host.ok("M81")
    s.host.ok("G92 X0 Y0 Z0")
    before = s.positions()
    s.host.send("G1 X10 F6000")
    s.passes(3)
    assert "the power supply is off" in s.printer.state.halted
    assert s.positions() == before


def test_power_supply_goes_off_with_board(s):
    s.host.send("M112")
    s.passes(1)
    assert not on(s)
    s.host.send("M999")
    s.host.expect("ready again", 10)
    assert on(s)


@pytest.mark.parametrize("away_s", [0.1, 0.7, 5.0])
def test_drivers_are_set_up_after_power_on(away_s):
    text = machine_text() + "\n" + MAINS.replace("D12", "D6")
    with Scenario(config.load_text(text)) as s:
        chips = list(s.board.drivers.values())
        currents = [chip.read(0x10) for chip in chips]
        s.host.ok("M81")
        for chip in chips:
            chip.plugged = False
        s.passes(away_s)
        s.host.send("M80")
        assert s.until(lambda: on(s), 1), s.host.heard
        for chip in chips:
            chip.plugged = True
            chip.power_on()
        assert [chip.read(0x10) for chip in chips] != currents
        s.host.expect("^ok$", 10)
        s.host.ok("G28", 60)
        assert s.printer.state.halted == ""
        assert [chip.read(0x10) for chip in chips] == currents


def test_power_supply_pin_cannot_be_used():
    with pytest.raises(ConfigError, match=r"mains\.pin"):
        machine('[mains]\npin = "D10"\n')  # the hotend's
