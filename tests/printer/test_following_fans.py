"""Fans that are on while motors are."""

from __future__ import annotations

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.config.sensor_tables import share_at
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


def test_motor_fan_starts_with_its_motor_only(s):
    s.host.ok("M17 X Y")
    s.passes(5)
    assert not on(s)
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X5 F3000")  # all motors go on
    assert s.until(lambda: on(s), 1)


def test_motor_fan_ignores_commands_and_survives_halt(s):
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


THERMOSTAT = """[sensors.board]
sensor_pin = "T2"
ambient_c = 30.0
[fans.cooler]
pin = "D11"
thermostat = { sensor = "board", target_c = 40.0 }
"""
WHOLE = 1_600_000  # ticks of a cycle of 10 Hz


def warms(s, celsius: float) -> None:
    """The sensor of the board reads this temperature."""
    s.board.force_sensor("board", share_at(s.board.board.sensors[-1].table, celsius))


def power(s) -> float:
    return s.board.output_value("cooler") / WHOLE


def test_thermostat_switches_its_fan_with_a_hysteresis():
    with Scenario(machine(THERMOSTAT)) as s:
        for celsius, on in ((41, 0), (43, 1), (39, 1), (37, 0), (41, 0)):
            warms(s, celsius)
            s.passes(1.5)
            assert power(s) == on, celsius


def test_thermostat_with_a_pid_has_power_between_its_limits():
    gains = "kp = 25.5, ki = 0.0, kd = 0.0, min_power = 0.2"
    text = THERMOSTAT.replace("40.0 }", f"40.0, {gains} }}")
    with Scenario(machine(text)) as s:
        for celsius, share in ((30, 0.2), (44, 0.4), (60, 1.0)):
            warms(s, celsius)
            s.passes(1.5)
            assert power(s) == pytest.approx(share, abs=0.05)


def test_set_temperature_fan_target_sets_target_and_limits():
    with Scenario(machine(THERMOSTAT)) as s:
        s.host.ok("SET_TEMPERATURE_FAN_TARGET TEMPERATURE_FAN=cooler TARGET=25 MAX_SPEED=0.5")
        assert s.until(lambda: power(s) == 0.5, 2)
        assert s.printer.status.read().fan_targets_c == {"cooler": 25.0}
        s.host.ok("SET_TEMPERATURE_FAN_TARGET TEMPERATURE_FAN=cooler")
        assert s.until(lambda: power(s) == 0, 2)
        refused = s.host.ok("SET_TEMPERATURE_FAN_TARGET TEMPERATURE_FAN=no TARGET=25")[0]
        assert "cooler" in refused
        s.host.ok("M142 S20")
        assert s.until(lambda: power(s) == 0.5, 2)
        s.host.ok("M142")
        assert s.until(lambda: power(s) == 0, 2)


def test_fan_of_a_broken_sensor_has_full_power():
    with Scenario(machine(THERMOSTAT)) as s:
        s.passes(2)
        assert power(s) == 0
        s.board.force_sensor("board", 1.0)
        assert s.until(lambda: power(s) == 1, 2)


def test_fan_follows_targets_and_then_idles():
    text = FAN.replace('follows_motors = ["z", "e"]', 'follows_targets = ["bed"]\nidle_power = 0.4')
    with Scenario(machine(text)) as s:
        s.host.ok("M140 S50")
        assert s.until(lambda: s.board.output_value("case") == FULL, 2)
        s.host.ok("M140 S0")
        assert s.until(lambda: s.board.output_value("case") == WHOLE * 0.4, 2)
        assert s.until(lambda: s.board.output_value("case") == 0, 21)


def test_a_motor_that_is_not_there_is_named():
    with pytest.raises(ConfigError, match="names of motors") as raised:
        machine(FAN.replace('"e"', '"f"'))
    assert "fans.case.follows_motors" in str(raised.value)
    assert "e, x, y, z" in str(raised.value)


def test_fan_of_several_heaters_is_on_while_one_is_warm():
    text = FAN.replace(
        'follows_motors = ["z", "e"]', 'follows = "hotend"\nfollows_heaters = ["bed"]'
    )
    with Scenario(machine(text)) as s:
        s.passes(2)
        assert not on(s)
        s.host.ok("M140 S60")
        assert s.until(lambda: on(s), 300)
        assert 50 < s.printer.rig.connection.heaters["bed"].celsius < 51
