"""How fast heaters and fans are pulsed: the edges at their pins."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.console.scenario import Scenario

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
    number = s.printer.connection.main.dictionary.enumerations["pin"][pin]
    s.board.device.trace_edges(number)
    s.passes(seconds)
    return s.board.device.take_edges(number)


@pytest.mark.parametrize(("key", "period"), [("", 0.1), ("pwm_hz = 50.0", 0.02), ("pwm_hz = 1", 1)])
def test_a_fan_is_pulsed_as_the_machine_file_says(key, period):
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
def test_a_heater_gets_its_share_in_whole_cycles_between_two_readings(hz):
    control = 'control = { kind = "pid", kp = 0.001, ki = 0.0, kd = 0.0, range_c = 1000.0 }'
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
def test_what_the_board_cannot_do_is_said(heater, fan, told):
    with pytest.raises(ConfigError) as raised:
        config.load_text(text(heater, fan))
    assert told in str(raised.value)
    assert "pwm_hz" in str(raised.value)
