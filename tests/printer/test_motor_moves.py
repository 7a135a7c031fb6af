"""FORCE_MOVE, STEPPER_BUZZ and G1 H: motors turn, homed or not."""

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario


def steps(s):
    """What each motor has turned so far, in steps."""
    return {name: s.printer.rig.connection.net_steps(name) for name in s.printer.machine.steppers}


def test_motor_of_an_axis_that_is_not_homed_turns():
    with Scenario("i3") as s:
        before, per_mm = steps(s), s.printer.machine.steppers["x"].steps_per_unit
        assert s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=5 VELOCITY=20", 10)[-1] == "ok"
        after = steps(s)
        assert abs(after["x"] - before["x"]) == 5 * per_mm
        assert {n for n in after if after[n] != before[n]} == {"x"}
        assert 0 in s.printer.rig.job.locked_axes


def test_homed_axis_stays_homed_and_within_its_limits():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X240 F6000")
        refused = s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=11 VELOCITY=20", 10)
        assert any("X is 251: expected 0 to 250 mm" in text for text in refused)
        s.host.ok("FORCE_MOVE STEPPER=stepper_x DISTANCE=9 VELOCITY=20", 10)
        assert s.positions()["x"] == 249
        assert s.printer.rig.job.locked_axes == []


def test_buzz_turns_the_motor_ten_times_and_back():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X250 F6000")  # it turns inwards first
        s.host.ok("M400", 10)
        before, begin_s = s.positions(), s.printer.rig.queue.now_s
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_x", 60)
        # 20 times 0.25 s of motion and 0.3 s of pause
        assert 10 < s.printer.rig.queue.now_s - begin_s < 16
        assert s.positions() == before
        assert s.printer.rig.job.locked_axes == []


def test_motor_of_a_corexy_moves_both_axes():
    with Scenario("corexy") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X50 Y50 F6000")
        s.host.ok("M400", 10)
        before = steps(s)
        s.host.ok("FORCE_MOVE STEPPER=stepper_a DISTANCE=4 VELOCITY=20", 10)
        after = steps(s)
        assert {n for n in after if after[n] != before[n]} == {"a"}
        assert s.printer.rig.job.machine_position[:2] == pytest.approx([52, 52])


def test_tower_of_a_delta_turns_alone():
    with Scenario("delta") as s:
        before = steps(s)
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_a", 60)
        assert steps(s) == before
        assert s.printer.rig.job.locked_axes == [0, 1, 2]
        s.host.ok("G28", 60)
        s.host.ok("STEPPER_BUZZ STEPPER=stepper_b", 60)
        assert s.printer.rig.job.locked_axes == []
        s.host.ok("FORCE_MOVE STEPPER=stepper_b DISTANCE=-3 VELOCITY=20", 10)
        after = steps(s)
        assert {n for n in after if after[n] != before[n]} >= {"b"}
        assert s.printer.rig.job.locked_axes == []


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


def nozzle(s):
    return tuple(round(mm, 3) for mm in s.printer.rig.job.machine_position[:3])


@pytest.mark.parametrize(
    ("machine", "lines", "moved"),
    [
        ("i3", ["G91", "G1 H2 X5 F600"], {"x": 5.0}),
        ("i3", ["G91", "G20", "G1 H2 Z1 F60"], {"z": 25.4}),
        ("corexy", ["G91", "G1 H2 X4 Y-2 F600"], {"a": 4.0, "b": -2.0}),
        ("corexy", ["G91", "G1 B3 F600"], {"b": 3.0}),
        ("delta", ["G91", "G1 H2 X-3 Z-1.5 F600"], {"a": -3.0, "c": -1.5}),
        ("delta", ["G91", "G1 B-2 F600"], {"b": -2.0}),
        ("scara", ["G91", "G1 H2 X4 Y-3 F600"], {"a": 4.0, "b": -3.0}),
        ("scara", ["G91", "G1 H2 Z2 F300"], {"z": 2.0}),
    ],
)
def test_raw_move_turns_these_motors_of_an_unhomed_machine(machine, lines, moved):
    with Scenario(machine) as s:
        before = s.positions()
        for line in lines:
            said = answers(s, line)
        assert said[-1] == "echo:Not homed: X, Y, Z"
        after = s.positions()
        by = {name: round(after[name] - before[name], 2) for name in moved}
        assert by == pytest.approx(moved, abs=0.012)  # a step of the delta
        assert {n for n in after if after[n] != before[n]} == set(moved)
        assert s.printer.rig.job.locked_axes == [0, 1, 2]


def test_nozzle_of_a_homed_delta_is_where_the_motors_are():
    with at_home(edited("delta")) as s:
        answers(s, "G1 X10 Y-20 Z50 F6000")
        answers(s, "M400")
        before = s.positions()
        (said,) = answers(s, f"G1 A{before['a'] - 4} C{before['c'] + 3} F1200")
        after = s.positions()
        assert after["a"] == pytest.approx(before["a"] - 4, abs=0.007)
        assert after["b"] == before["b"]
        assert after["c"] == pytest.approx(before["c"] + 3, abs=0.007)
        there = s.machine.geometry.forward((after["a"], after["b"], after["c"]))
        assert nozzle(s) == pytest.approx(there, abs=0.01)
        x, y, z = nozzle(s)
        assert said == f"echo:The nozzle is at X{x:.3f} Y{y:.3f} Z{z:.3f} of the machine"
        assert s.printer.rig.job.locked_axes == []
        answers(s, "G1 X10 Y-20 Z50")
        answers(s, "M400")
        assert s.positions() == before  # no step is lost


@pytest.mark.parametrize("on", [True, False])
def test_raw_move_leaves_the_other_motors_where_the_bed_is_corrected(on):
    with at_home(edited("i3-probe", STILL)) as s:
        answers(s, "G1 X20 Y20 Z5 F6000")
        answers(s, "SET_BED_FIT CX=0.005")
        answers(s, f"M420 S{int(on)}")
        before = s.positions()
        answers(s, "G91")
        answers(s, "G1 H2 X80 F6000")
        assert s.positions() == {**before, "x": before["x"] + 80}
        assert nozzle(s)[0] == pytest.approx(100, abs=0.01)
        assert nozzle(s)[2] == pytest.approx(before["z"] - (0.5 if on else 0.0), abs=0.01)


def test_raw_move_is_bounded_in_distance_and_speed():
    with Scenario("i3") as s:
        answers(s, "G91")
        before, begin_s = s.positions(), s.printer.rig.queue.now_s
        (said,) = answers(s, "G1 H2 X251 F600")
        assert "X is 251: expected -250 to 250 mm or degrees at once" in said
        answers(s, "G1 H2 X100 F1000000000")
        x = s.machine.axes["x"]
        assert s.printer.rig.queue.now_s - begin_s > 100 / x.speed_mm_s
        assert s.positions()["x"] == before["x"] + 100


def test_axes_home_where_h1_triggers_their_endstops():
    with Scenario("i3") as s:
        answers(s, "G91")
        answers(s, "M104 S150")
        said = answers(s, "G1 H1 X-300 F3000")
        assert said == [
            "echo:The nozzle is at X0.000 of the machine",
            "echo:Not homed: Y, Z",
        ]
        assert s.positions()["x"] == pytest.approx(0, abs=0.02)
        assert s.printer.rig.job.locked_axes == [1, 2]
        assert s.printer.rig.connection.heaters["hotend"].target == 150
        (said,) = answers(s, "G1 H1 X20 F3000")
        assert "X is 20: expected towards the endstop, and at most 300" in said
        s.board.force_switch("x", False)
        answers(s, "G1 X9 F3000")
        said = answers(s, "G1 H1 X-20 F3000")
        assert "was not triggered" in said[0]
        assert 0 in s.printer.rig.job.locked_axes


def test_towers_home_where_h1_triggers_their_endstops():
    with Scenario("delta") as s:
        answers(s, "G91")
        (said,) = answers(s, "G1 H1 X300 F3000")
        assert "expected all of a, b, c" in said
        far = s.machine.axes["z"].max_mm
        answers(s, f"G1 H1 X{far} Y{far} Z{far} F3000")
        assert s.printer.rig.job.locked_axes == []
        at = s.machine.homing["a"].position
        assert [s.positions()[n] for n in "abc"] == pytest.approx([at] * 3, abs=0.05)


def test_motors_do_not_turn_by_themselves_during_a_print(tmp_path):
    (tmp_path / "a.gcode").write_text("G28\nG1 X50 F600\nG4 S60\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        answers(s, "M23 a.gcode")
        answers(s, "M24")
        s.passes(20)
        answers(s, "M25")
        before = s.positions()
        for line in (
            "FORCE_MOVE STEPPER=stepper_x DISTANCE=1 VELOCITY=5",
            "G1 H2 X1 F60",
            "SET_KINEMATIC_POSITION X=3",
        ):
            assert "a print is running or paused" in "".join(answers(s, line, 120))
        assert s.positions()["x"] == before["x"]


def test_position_of_an_axis_is_set_and_taken_away():
    with Scenario("i3") as s:
        answers(s, "SET_KINEMATIC_POSITION X=30 Y=40 Z=5 SET_HOMED=xy")
        assert s.printer.rig.job.locked_axes == [2]
        assert nozzle(s) == (30, 40, 5)
        answers(s, "SET_KINEMATIC_POSITION CLEAR_HOMED=x")
        assert s.printer.rig.job.locked_axes == [0, 2]
        (said,) = answers(s, "SET_KINEMATIC_POSITION Z=9999")
        assert "Z is 9999: expected" in said


def test_the_file_of_a_print_may_turn_motors(tmp_path):
    lines = ["FORCE_MOVE STEPPER=stepper_z DISTANCE=5 VELOCITY=5", "G28", "G1 X50 F6000", "M400"]
    (tmp_path / "a.gcode").write_text("\n".join(lines) + "\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        answers(s, "M23 a.gcode")
        answers(s, "M24")
        s.host.expect("Done printing file", 60)
        assert s.positions()["x"] == 50
