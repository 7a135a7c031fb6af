"""How fast heaters and fans are pulsed: the edges at their pins."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

HZ = 16_000_000


def text(heater: str = "", fan: str = "") -> str:
    found = shipped_text("i3").replace("[board]", '[board]\nfirmware = "passo"')
    found = found.replace("[heaters.hotend]", f"[heaters.hotend]\n{heater}")
    return found.replace("[fans.part]", f"[fans.part]\n{fan}")


def edges(s, name: str, seconds: float) -> list[tuple[int, int]]:
    pin = next(o.pin for o in s.board.board.outputs if o.name == name)
    number = s.printer.rig.connection.main.dictionary.enumerations["pin"][pin]
    s.board.device.trace_edges(number)
    s.passes(seconds)
    return s.board.device.take_edges(number)


@pytest.mark.parametrize(("key", "period"), [("", 0.1), ("pwm_hz = 50.0", 0.02), ("pwm_hz = 1", 1)])
def test_fan_is_pulsed_as_in_the_machine_file(key, period):
    with Scenario(config.load_text(text(fan=key))) as s:
        s.host.ok("M106 S51")
        s.passes(1)
        found = edges(s, "part", 20 * period)
        rises = [clock for clock, level in found if level == 1]
        falls = [clock for clock, level in found if level == 0 and clock > rises[0]]
        assert {b - a for a, b in pairwise(rises)} == {round(period * HZ)}
        wide = {b - a for a, b in zip(rises, falls, strict=False)}
        assert wide == {round(period * HZ * 51 / 255)}


@pytest.mark.parametrize("hz", [8, 20, 100])
def test_heater_power_is_whole_cycles_between_readings(hz):
    control = 'control = { kind = "pid", kp = 0.255, ki = 0.0, kd = 0.0, range_c = 1000.0 }'
    with Scenario(config.load_text(text(f"pwm_hz = {hz}\nmax_power = 0.25\n{control}"))) as s:
        s.host.ok("M104 S270")
        s.passes(2)
        found = edges(s, "hotend", 10)
        rises = [clock for clock, level in found if level == 1]
        cycles = {b - a for a, b in pairwise(rises)}
        assert cycles == {HZ // hz}
        on = sum(b - a for (a, level), (b, _) in pairwise(found) if level == 1)
        share = s.board.output_value("hotend") / (HZ // hz)
        assert 0.2 < share <= 0.25
        assert on / (found[-1][0] - found[0][0]) == pytest.approx(share, rel=0.05)


@pytest.mark.parametrize(
    ("heater", "fan", "told"),
    [
        ("pwm_hz = 3.9", "", "heaters.hotend.pwm_hz"),
        ("pwm_hz = 251", "", "at most 250 Hz at this board's clock"),
        ("", "pwm_hz = 0.5", "fans.part.pwm_hz"),
        ("", "pwm_hz = 500", "at most 250 Hz at this board's clock"),
        ("", 'pwm_hz = "fast"', "fans.part.pwm_hz"),
    ],
)
def test_impossible_pwm_is_named(heater, fan, told):
    with pytest.raises(ConfigError) as raised:
        config.load_text(text(heater, fan))
    assert told in str(raised.value)
    assert "pwm_hz" in str(raised.value)


FOLLOWER = """[fans.hotend-fan]
pin = "D11"
follows = "hotend"
above_c = 60.0
max_power = 0.8
"""


def test_a_fan_that_turns_gets_what_it_needs_to_turn():
    with Scenario(config.load_text(text(fan="min_power = 0.25\nmax_power = 0.75"))) as s:
        for command, share in (("S1", 0.25), ("S85", 0.25), ("S170", 0.5), ("S255", 0.75)):
            s.host.ok(f"M106 {command}")
            s.passes(1)
            assert s.board.output_value("part") == pytest.approx(share * HZ / 10, abs=1)
        s.host.ok("M106 S0")
        s.passes(1)
        assert s.board.output_value("part") == 0


def test_a_fan_follows_its_heater():
    alone = text('on_fault = "heater"').replace("[fans.part]", f"{FOLLOWER}[fans.part]")
    with Scenario(config.load_text(alone)) as s:
        full = round(0.8 * HZ / 10)

        def goes(on: bool, within: float) -> float:
            assert s.until(lambda: s.board.output_value("hotend-fan") == on * full, within)
            return s.printer.rig.connection.heaters["hotend"].celsius

        s.host.ok("M106 S255")  # not this one
        s.host.ok("M104 S100")
        assert goes(True, 60) == pytest.approx(61, abs=2)
        s.host.ok("M107")
        s.passes(1)
        assert s.board.output_value("part") == 0
        s.host.ok("M104 S0")
        assert s.board.output_value("hotend-fan") == full
        assert goes(False, 300) == pytest.approx(58, abs=2)
        s.board.force_sensor("hotend", 1.0)  # open: nobody knows
        goes(True, 10)


@pytest.mark.parametrize(
    ("fans", "told"),
    [
        (FOLLOWER.replace('"hotend"', '"hotent"'), "the name of one of the heaters"),
        (FOLLOWER.replace('follows = "hotend"', ""), "a number of its own"),
        (FOLLOWER + "min_power = 0.9\n", "at most max_power"),
        (FOLLOWER + "above_c = -1.0\n", "above_c"),
    ],
)
def test_wrong_fan_keys_are_named(fans, told):
    if fans.count("above_c") > 1:
        fans = fans.replace("above_c = 60.0\n", "")
    with pytest.raises(ConfigError, match=told):
        config.load_text(text().replace("[fans.part]", f"{fans}[fans.part]"))
