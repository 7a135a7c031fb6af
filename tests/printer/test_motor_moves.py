"""FORCE_MOVE and STEPPER_BUZZ: motors turn, homed or not."""

import pytest
from tests.support.scenario import Scenario


def steps(s):
    """What each motor has turned so far, in steps."""
    return {name: s.printer.connection.net_steps(name) for name in s.printer.machine.steppers}


def test_motor_of_an_axis_that_is_not_homed_turns():
    with Scenario("i3") as s:
        before, per_mm = steps(s), s.printer.machine.steppers["x"].steps_per_unit
        assert s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=5 VELOCITY=20", 10)[-1] == "ok"
        after = steps(s)
        assert abs(after["x"] - before["x"]) == 5 * per_mm
        assert {n for n in after if after[n] != before[n]} == {"x"}
        assert 0 in s.printer.job.locked_axes


def test_homed_axis_stays_homed_and_within_its_limits():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X240 F6000")
        refused = s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=11 VELOCITY=20", 10)
        assert any("X is 251: expected 0 to 250 mm" in text for text in refused)
        s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=9 VELOCITY=20", 10)
        assert s.positions()["x"] == 249
        assert s.printer.job.locked_axes == []


def test_buzz_turns_the_motor_ten_times_and_back():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X250 F6000")  # it turns inwards first
        s.host.ok("M400", 10)
        before, begin_s = s.positions(), s.printer.queue.now_s
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_x", 60)
        # 20 times 0.25 s of motion and 0.3 s of pause
        assert 10 < s.printer.queue.now_s - begin_s < 16
        assert s.positions() == before
        assert s.printer.job.locked_axes == []


def test_motor_of_a_corexy_moves_both_axes():
    with Scenario("corexy") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X50 Y50 F6000")
        s.host.ok("M400", 10)
        before = steps(s)
        s.host.ok("FORCE_MOVE STEPPER=stepper_a DISTANCE=4 VELOCITY=20", 10)
        after = steps(s)
        assert {n for n in after if after[n] != before[n]} == {"a"}
        assert s.printer.job.machine_position[:2] == pytest.approx([52, 52])


def test_tower_of_a_delta_turns_alone():
    with Scenario("delta") as s:
        before = steps(s)
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_a", 60)
        assert steps(s) == before
        s.host.ok("G28", 60)
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_b", 60)
        assert s.printer.job.locked_axes == []
        s.host.ok("FORCE_MOVE STEPPER=stepper_b DISTANCE=-3 VELOCITY=20", 10)
        after = steps(s)
        assert {n for n in after if after[n] != before[n]} >= {"b"}
        assert set(s.printer.job.locked_axes) == {0, 1, 2}


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("FORCE_MOVE STEPPER=q DISTANCE=1 VELOCITY=5", "STEPPER is q: expected stepper_x"),
        ("FORCE_MOVE STEPPER=stepper_x VELOCITY=5", "needs DISTANCE="),
        (
            "FORCE_MOVE STEPPER=stepper_x DISTANCE=999 VELOCITY=5",
            "DISTANCE is 999",
        ),
        (
            "FORCE_MOVE STEPPER=stepper_x DISTANCE=9 VELOCITY=0",
            "VELOCITY is 0: expected",
        ),
        ("STEPPER_BUZZ STEPPER=extruder", "STEPPER is extruder: expected stepper_x"),
    ],
)
def test_move_of_a_motor_that_cannot_be_is_refused(line, reason):
    with Scenario("i3") as s:
        before = steps(s)
        said = s.host.ok(line)
        assert any(reason in text for text in said), said
        assert steps(s) == before
