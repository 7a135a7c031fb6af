"""Fans that are on while motors are."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

FAN = """[fans.case]
pin = "D11"
follows_motors = ["z", "e"]
stays_on_s = 20.0
max_power = 0.8
"""
FULL = 1_280_000  # ticks of a cycle of 10 Hz, times 0.8


def machine(fan: str = FAN):
    return config.load_text(shipped_text("i3").replace("[fans.part]", f"{fan}[fans.part]"))


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.passes(1)
        yield s


def on(s) -> bool:
    value = s.board.output_value("case")
    assert value in (0, FULL)
    return value > 0


def test_a_fan_is_on_while_a_motor_is_and_a_while_longer(s):
    assert not on(s)
    s.host.ok("M17 Z")
    assert s.until(lambda: on(s), 0.5)
    s.passes(100)
    assert on(s)
    s.host.ok("M84 Z")
    s.passes(19.5)
    assert on(s)
    assert s.until(lambda: not on(s), 1)


def test_a_move_turns_it_on_and_other_motors_do_not(s):
    s.host.ok("M17 X Y")
    s.passes(5)
    assert not on(s)
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X5 F3000")  # all motors go on
    assert s.until(lambda: on(s), 1)


def test_commands_do_not_reach_it_and_it_comes_back_after_a_halt(s):
    s.host.ok("M106 S255")
    s.passes(1)
    assert not on(s)
    s.host.ok("M17")
    assert s.until(lambda: on(s), 0.5)
    s.host.send("M112")
    s.passes(2)
    assert not on(s)
    s.host.ok("M999", 30)
    assert s.until(lambda: on(s), 1)  # what it cools is still warm
    assert s.until(lambda: not on(s), 20)


def test_fan_may_follow_a_heater():
    with Scenario(machine(FAN + 'follows = "bed"\nabove_c = 40.0\n')) as s:
        s.host.ok("M140 S60")
        assert s.until(lambda: on(s), 200)
        assert s.printer.rig.connection.heaters["bed"].celsius == pytest.approx(40, abs=1)


def test_a_motor_that_is_not_there_is_named():
    with pytest.raises(ConfigError, match="names of motors") as raised:
        machine(FAN.replace('"e"', '"f"'))
    assert "fans.case.follows_motors" in str(raised.value)
    assert "e, x, y, z" in str(raised.value)
