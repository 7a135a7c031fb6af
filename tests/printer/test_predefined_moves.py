"""Moves that the machine file names: by command, and before and after homing and probing."""

from array import array

import pytest
from tests.support.edited_machine import STILL, answers, at_home, edited
from tests.support.scenario import Scenario

from passo import Machine
from passo.errors import ConfigError

LIFT = """
[moves.lift]
position_mm = { z = 5 }
relative = true
speed_mm_s = 5
hook = "before_homing"
"""
AFTER = """
[moves.second]
position_mm = { x = 100, y = 90 }
hook = "after_homing"
[moves.first]
position_mm = { z = 20 }
speed_mm_s = 10
priority = 3
hook = "after_homing"
[moves.never]
position_mm = { x = 7 }
hook = "after_homing"
enabled = false
"""
PROBING = """
[moves.brush]
position_mm = { x = 200, y = 10 }
hook = "before_probing"
[moves.aside]
position_mm = { x = 33 }
hook = "after_probing"
"""
PER_MM = {"x": 80, "y": 80, "z": 400}


def steps(s, line):
    """Clocks, and distances in mm since the line began, of all steps of X, Y and Z."""
    for axis in "xyz":
        s.board.trace_steps(axis, s.printer.rig.connection.now, 1 << 60)
    answers(s, line)
    found = {}
    for axis in "xyz":
        clocks, directions = s.board.take_steps(axis, 0, 1 << 60)
        at, travel = 0, []
        for clock, direction in zip(array("q", clocks), array("b", directions), strict=True):
            at += direction
            travel.append((clock, at / PER_MM[axis]))
        found[axis] = travel
    return found


def test_moves_follow_homing_in_the_order_of_their_priority():
    with Scenario(edited("i3", more=AFTER)) as s:
        found = steps(s, "G28")
        assert s.positions() == {"x": 100.0, "y": 90.0, "z": 20.0, "e": 0.0}
        first_x = next(clock for clock, mm in found["x"] if mm == found["x"][-1][1] - 100)
        assert found["z"][-1][0] < found["x"][-1][0]
        lifted = next(clock for clock, mm in reversed(found["z"]) if mm < found["z"][-1][1] - 19.9)
        assert first_x < lifted
        assert (found["z"][-1][0] - lifted) / s.printer.rig.queue.hz == pytest.approx(2, abs=0.2)
        answers(s, "G1 X50 Y40 F6000")
        answers(s, "G28 X")
        assert s.positions() == {"x": 0.0, "y": 40.0, "z": 20.0, "e": 0.0}
        answers(s, "G28 O")  # nothing to home
        assert s.positions()["x"] == 0.0


def test_head_lifts_before_it_homes_whether_its_height_is_known():
    with Scenario(edited("i3", more=LIFT)) as s:
        found = steps(s, "G28 X")
        assert max(mm for _, mm in found["z"]) == 5.0
        assert found["z"][-1] < found["x"][0]
        answers(s, "G28")
        top = s.machine.axes["z"].max_mm
        answers(s, f"G1 Z{top - 2} F3000")
        found = steps(s, "G28 X")
        assert s.positions()["z"] == top  # a homed axis stays within its limits


def test_moves_surround_the_measurement_of_the_bed():
    with at_home(edited("i3-probe", STILL, more=PROBING)) as s:
        found = steps(s, "G32")
        assert {200.0, 33.0} <= {mm for _, mm in found["x"]}
        assert s.positions()["x"] == 33.0
        answers(s, "G1 X150 F6000")
        answers(s, "G32 P1")
        assert s.positions()["x"] != 33.0
        answers(s, "G1 X150 F6000")
        s.board.force_switch("probe", True)
        assert "probe" in answers(s, "G32")[-1]
        assert s.positions()["x"] != 33.0


def test_move_is_made_by_its_name_and_changed_by_options(tmp_path):
    with Scenario(edited("i3", more=AFTER), state=str(tmp_path)) as s:
        (refused,) = answers(s, "MOVE_TO NAME=second")
        assert "axis X is not homed" in refused
        answers(s, "G28 X Y Z")
        answers(s, "MOVE_TO NAME=never")
        assert s.positions() == {"x": 7.0, "y": 0.0, "z": 0.0, "e": 0.0}
        (refused,) = answers(s, "MOVE_TO NAME=third")
        assert "NAME is third: expected a name in [moves]: second, first, never" in refused
        (refused,) = answers(s, "SET_MOVE NAME=first Z=999")
        assert "Z is 999: expected 0 to 250 mm" in refused
        assert answers(s, "M925 IMove2Z") == ["20"]
        for line in ("M926 IMove2Z V12", "M926 IMove1Enabled V0", "M930", "M500"):
            answers(s, line)
    with Scenario(edited("i3", more=AFTER), state=str(tmp_path)) as s:
        answers(s, "G28")
        assert s.positions() == {"x": 0.0, "y": 0.0, "z": 12.0, "e": 0.0}


def test_print_without_consoles_makes_the_same_moves(tmp_path):
    path = tmp_path / "a.gcode"
    path.write_text("G28\nG91\nG1 X5 F6000\nG90\nMOVE_TO NAME=never\nG1 Y1\n")
    result = Machine(edited("i3", more=AFTER)).print(path)
    assert result.final_position_mm == {"x": 7.0, "y": 1.0, "z": 20.0, "e": 0.0}
    with Scenario(edited("i3", more=AFTER)) as s:
        for line in path.read_text().splitlines():
            answers(s, line)
        answers(s, "M400")
        assert s.positions() == result.final_position_mm


@pytest.mark.parametrize(
    ("machine", "lines", "reason"),
    [
        ("i3", "position_mm = { q = 3 }", "q is 3.0: expected a position of an axis: x, y, z."),
        ("i3", "position_mm = { x = 999 }", "x is 999.0: expected 0 to 250 mm"),
        (
            "i3",
            'position_mm = { z = 5 }\nhook = "before_homing"',
            "relative is false: expected true for a move before homing",
        ),
        (
            "i3",
            'position_mm = { x = -5 }\nrelative = true\nhook = "after_homing"',
            "x is -5.0: expected a distance that ends at 0 to 250 mm, not at -5 mm",
        ),
        (
            "delta",
            'position_mm = { z = 5 }\nrelative = true\nhook = "before_homing"',
            "z is 5.0: expected no such key: before homing, arms do not move the nozzle",
        ),
        (
            "delta",
            'position_mm = { x = 60, y = 60 }\nhook = "after_homing"',
            "position_mm is 'X60 Y60': expected a place that the nozzle reaches",
        ),
    ],
)
def test_move_that_cannot_be_is_an_error_of_the_machine_file(machine, lines, reason):
    with pytest.raises(ConfigError) as error:
        edited(machine, more=f"[moves.a]\n{lines}\n")
    assert reason in str(error.value)
