"""Servos: SET_SERVO and M280."""

from __future__ import annotations

from array import array

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

HZ = 16_000_000
SERVOS = """[servos.arm]
pin = "D11"
min_pulse_us = 500.0
max_pulse_us = 2500.0
number = 1
[servos.Lid]
pin = "!D6"
max_deg = 90.0
start_deg = 45.0
"""
PROBE = """[probe]
kind = "servo"
pin = "D19"
control_pin = "D5"
offset_mm = [0.0, 0.0]
trigger_height_mm = 1.0
"""


def machine(tables: str = SERVOS):
    return config.load_text(shipped_text("i3").replace("[fans.part]", f"{tables}[fans.part]"))


@pytest.fixture
def s():
    with Scenario(machine()) as s:
        s.passes(1)
        yield s


def pulse_us(s, name: str) -> float:
    """The length of the pulses; the signal of Lid is inverted."""
    us = s.board.output_value(f"servos.{name}") * 1e6 / HZ
    return 20_000 - us if name == "Lid" else us


def test_servos_start_with_their_angle_or_without_a_signal(s):
    assert pulse_us(s, "arm") == 0
    assert pulse_us(s, "Lid") == pytest.approx(1500)


@pytest.mark.parametrize(
    ("line", "us"),
    [
        ("SET_SERVO SERVO=arm ANGLE=0", 500),
        ("SET_SERVO SERVO=ARM ANGLE=90", 1500),
        ("SET_SERVO SERVO=arm ANGLE=180", 2500),
        ("SET_SERVO SERVO=arm WIDTH=0.0012", 1200),
        ("M280 P1 S90", 1500),
        ("M280 P1 S1000", 1000),
    ],
)
def test_angle_or_width_sets_the_pulse(s, line, us):
    s.host.ok(line)
    s.passes(1)
    assert pulse_us(s, "arm") == pytest.approx(us)
    s.host.ok("SET_SERVO SERVO=arm WIDTH=0")
    s.passes(1)
    assert pulse_us(s, "arm") == 0


def test_servo_turns_after_the_moves_before_it(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.board.trace_output("servos.arm")
    s.board.trace_steps("x", 0, 1 << 62)
    s.host.send("G1 X10 F3000", "SET_SERVO SERVO=arm ANGLE=90", "G1 X15", "M400")
    s.passes(3)
    [(clock, _)] = s.board.take_changes("servos.arm")
    clocks = array("q", s.board.take_steps("x", 0, 1 << 62)[0])
    done = sum(one <= clock for one in clocks)
    assert done == pytest.approx(10 * s.machine.steppers["x"].steps_per_unit, abs=1)


@pytest.mark.parametrize(
    ("line", "limit"),
    [
        ("SET_SERVO SERVO=lid ANGLE=91", "0 to 90°"),
        ("SET_SERVO SERVO=lid WIDTH=0.003", "0, or 0.001 to 0.002 s"),
        ("SET_SERVO SERVO=lit ANGLE=1", "arm, Lid"),
        ("M280 P1 S2600", "500 to 2500"),
        ("M280 P0 S90", "P is 0: expected 1"),
    ],
)
def test_wrong_values_name_their_limit(s, line, limit):
    s.host.ok(line)
    assert any(limit in answer for answer in s.host.heard)


def test_halted_printer_sends_no_pulses(s):
    assert s.printer.status.read().servos_us["Lid"] == 1500
    s.host.send("M112")
    s.passes(1)
    assert pulse_us(s, "Lid") == 0
    assert s.printer.status.read().servos_us["Lid"] == 0


def test_number_0_is_the_servo_of_the_probe_unless_another_has_it():
    with Scenario(machine(PROBE + SERVOS)) as s:
        s.passes(2)
        s.board.trace_output("probe-servo")
        s.host.ok("M280 P0 S90")
        s.passes(2)
        changes = [value * 1e6 / HZ for _, value in s.board.take_changes("probe-servo")]
        assert changes == [pytest.approx(544 + 928), 0]
    with Scenario(machine(PROBE + SERVOS.replace("number = 1", "number = 0"))) as s:
        s.host.ok("M280 P0 S90")
        s.passes(1)
        assert pulse_us(s, "arm") == pytest.approx(1500)


@pytest.mark.parametrize(
    ("keys", "limit"),
    [
        ("min_pulse_us = 2100.0", "more than min_pulse_us"),
        ("start_deg = 200.0", "at most max_deg, 180"),
    ],
)
def test_a_range_that_no_servo_has_is_refused(keys, limit):
    with pytest.raises(ConfigError, match=limit):
        machine(f'[servos.a]\npin = "D11"\n{keys}\n')
