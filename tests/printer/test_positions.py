"""Where the machine is now, and where the program is."""

import re

import pytest
from tests.support.scenario import Scenario


def numbers(line):
    return {k: float(v) for k, v in re.findall(r"([A-Z]\d?):(-?[\d.]+)", line.split("Count")[0])}


@pytest.mark.parametrize("machine", ["i3", "corexy", "delta", "big-fish-i3"])
def test_the_real_position_follows_the_motors(machine):
    with Scenario(machine) as s:
        s.host.ok("M302 P1")
        s.host.ok("G28", 60)
        at_home = numbers(s.host.ok("M114 R")[0])
        assert at_home == pytest.approx(numbers(s.host.ok("M114")[0]), abs=0.03)
        s.host.ok("G1 X10 Y10 Z20 F6000")
        s.host.ok("M400", 60)
        s.host.ok("G92 X0 E5")
        s.host.ok("G1 X30 E8 F600")
        s.passes(1.5)
        assert numbers(s.host.ok("M114")[0])["X"] == 30
        now = numbers(s.host.ok("M114 R")[0])
        assert 8 < now["X"] < 20
        assert now["E"] == pytest.approx(5 + now["X"] / 10, abs=0.05)
        assert now["Y"] == pytest.approx(10, abs=0.05)
        both = s.host.ok("M114 D")
        assert both[1].startswith("Real: X:")
        s.host.ok("M400", 60)
        end = numbers(s.host.ok("M114 R")[0])
        assert end == pytest.approx({"X": 30, "Y": 10, "Z": 20, "E": 8}, abs=0.03)


def test_counts_are_right_after_a_stop_and_a_new_home():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.send("G1 X100 F6000")
        s.passes(0.6)
        s.host.ok("M410")
        s.passes(1)
        stopped = s.positions()["x"]
        assert numbers(s.host.ok("M114 R")[0])["X"] == pytest.approx(stopped, abs=0.001)
        assert numbers(s.host.ok("M114")[0])["X"] == pytest.approx(stopped, abs=0.02)
        s.host.ok("G28 X", 60)
        assert numbers(s.host.ok("M114 R")[0])["X"] == pytest.approx(0, abs=0.02)


def test_get_position_has_steps_machine_and_program():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X10 Y20 Z5 F6000")
        s.host.ok("G92 X0")
        s.host.ok("M400", 60)
        *lines, ok = s.host.ok("GET_POSITION")
        steps, machine, program = lines
        assert ok == "ok"
        assert steps.startswith("mcu: stepper_x:800 stepper_y:1600 stepper_z:2000")
        assert machine == "toolhead: X:10.000000 Y:20.000000 Z:5.000000 E:0.000000"
        assert program == "gcode: X:0.000000 Y:20.000000 Z:5.000000 E:0.000000"


def test_one_motor_goes_off_and_its_axis_is_not_homed():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("SET_STEPPER_ENABLE STEPPER=stepper_y ENABLE=0", 10)
        assert s.printer.status.read().homed == {"x", "z"}
        refused = s.host.ok("SET_STEPPER_ENABLE STEPPER=stepper_q ENABLE=0")
        assert "stepper_x, stepper_y, stepper_z, extruder" in " ".join(refused)


def test_set_display_text_is_the_message_until_it_is_removed():
    with Scenario("i3") as s:
        s.host.ok('SET_DISPLAY_TEXT MSG="Half way there"')
        assert s.printer.status.read().message == "Half way there"
        s.host.ok("SET_DISPLAY_TEXT")
        assert s.printer.status.read().message == ""
