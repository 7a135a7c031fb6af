"""The motion state of a program: units, zero points, extruder rules, tools, limits."""

from __future__ import annotations

from math import inf

import pytest

from passo._core import Fault, Job

from .driver import run, spec


@pytest.mark.parametrize(
    ("modes", "x", "e"),
    [
        ("G90 M82", 5, 2),
        ("G90 M83", 5, 3),
        ("G91 M82", 15, 3),
        ("G91 M83", 15, 3),
        ("M83 G90 M82", 5, 2),
        ("M83 G91 G90", 5, 3),
        ("G91 G90", 5, 2),
    ],
)
def test_e_is_relative_while_g91_or_m83_is_in_force(modes, x, e):
    out = run("G1 X10 E1\n" + "".join(f"{m}\n" for m in modes.split()) + "G1 X5 E2\n")
    assert out.ends == [(10, 0, 0, 1), (x, 0, 0, e)]


def test_the_extruder_axis_continues_after_relative_moves():
    out = run("G1 X1 E5\nM83\nG1 X2 E1\nM82\nG1 X3 E7\n")
    assert [end[3] for end in out.ends] == [5, 6, 7]


def test_g92_moves_the_zero_and_not_the_machine():
    out = run("G1 X10 Y10 E5\nG92 X0 E0\nG1 X5 Y12 E1\nG92\nG1 X1 Y1 E1\n")
    assert out.ends == [(10, 10, 0, 5), (15, 12, 0, 6), (16, 13, 0, 7)]
    assert run("G1 E10\nG92 E0\nG92 E3\nG1 E4\n").ends == [(0, 0, 0, 10), (0, 0, 0, 11)]


def test_g20_scales_all_lengths():
    out = run("G20\nG1 X1 Y.5 E.1 F60\nG91\nG1 X1\nG21\nG1 X1\n")
    assert out.ends == [(25.4, 12.7, 0, 2.54), (50.8, 12.7, 0, 2.54), (51.8, 12.7, 0, 2.54)]
    assert out.moves[0].cruise_speed == pytest.approx(25.4)


def test_homing_puts_the_named_axes_home():
    out = run("G1 X10 Y10 Z5\nG28 X\nG1 X1 Y11\n")
    assert out.commands == ["G28 X"]
    assert out.statistics["position_mm"][:3] == [1, 11, 5]
    assert run("G1 X10 Y10 Z5\nG28\n").statistics["position_mm"][:3] == [0, 0, 0]


def test_feed_rates_stay_until_the_next():
    out = run("G1 X10 F600\nG1 X20\nF1200\nG1 X30\nG0 X40\n")
    assert [m.cruise_speed for m in out.moves] == pytest.approx([10, 10, 20, 20])


def test_g4_dwells_for_s_or_p():
    out = run("G1 X1\nG4 P1500\nG4 S2\nG4 S1 P9\nG4\nG4 P0\nG4 P-5\n")
    assert [m.kind for m in out.moves] == ["travel", "dwell", "dwell", "dwell"]
    assert out.statistics["dwell_s"] == 4.5


def test_moves_are_travel_print_or_extrude():
    out = run("G1 X1\nG1 X2 E1\nG1 E0\nG1 X3 E-1\nG1 X3\n")
    assert [m.kind for m in out.moves] == ["travel", "print", "extrude", "travel"]


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ("G1 X1 E5", "extrude"),
        ("G1 Y1 E-5", "extrude"),
        ("G1 Z6 E5", "extrude"),
        ("M82\nG1 X9 E1", "travel"),
        ("M82\nG1 X1 E1", None),
    ],
)
@pytest.mark.parametrize("hop", ["", "M207 Z.7\nG10\n"])
def test_a_rounding_is_not_a_move(line, kind, hop):
    """Ten tenths are not 1: the difference made a print of a retraction."""
    steps = 10 * "G1 X.1 Y.1 Z.1 E.1\n"
    out = run(f"{hop}G1 Z5 F600\nG91\nM83\n{steps}G90\n{line}\n", "unbounded")
    behind = [move.kind for move in out.moves if move.line > 14 + hop.count("\n")]
    assert behind == ([kind] if kind else [])


def test_g10_retracts_and_g11_recovers():
    out = run("M207 S2 F1200 Z.4\nG1 X10 E5\nG10\nG10\nG1 X20\nG11\nG11\nG1 X30 E6\n")
    assert out.ends == [
        (10, 0, 0, 5),
        (10, 0, 0, 3),
        (10, 0, 0.4, 3),
        (20, 0, 0.4, 3),
        (20, 0, 0, 3),
        (20, 0, 0, 5),
        (30, 0, 0, 6),
    ]
    assert out.moves[1].cruise_speed == pytest.approx(20)


def test_tool_change_retraction_has_own_length():
    lines = ["M83", "G1 X10 E20", "G10 S1", "G11", "M207 W5", "M208 S0.1 W0.5", "G10 S1"]
    out = run("\n".join([*lines, "M207 S2", "G11", "G10 S0", "G11"]))
    assert [end[3] for end in out.ends] == [20, 7, 20, 15, 20.5, 18.5, 20.6]


def test_homing_with_b_goes_back():
    """Without a console homing sets positions, and the way back is one across and one of Z."""
    out = run("G1 X10 Y20 Z5\nG28 B\nG1 X11\n")
    ways = [(10, 20, 5), (10, 20, 0), (10, 20, 5), (11, 20, 5)]
    assert [end[:3] for end in out.ends] == ways


def test_hop_with_absolute_heights_stays_below_limit():
    out = run("M207 S1 Z2\nG1 Z5\nG10\nG1 Z6\nG11\n")
    assert [end[2] for end in out.ends] == [5, 5, 7, 8, 6, 6]
    out = run("M207 S1 Z2\nG1 Z249\nG10\nG11\n")
    assert [end[2] for end in out.ends] == [249, 249, 250, 249, 249]


def test_recovery_with_extra_length():
    out = run("M207 S2 F1200\nM208 S.1 F600\nG1 E5\nG10\nG11\n")
    assert [end[3] for end in out.ends] == pytest.approx([5, 3, 5.1])
    assert [m.cruise_speed for m in out.moves[1:]] == pytest.approx([20, 10])


def test_a_refused_retraction_changes_nothing():
    out = run("M207 S2 F1200\nG1 E5\nM207 S-1 F600 Z1\nM208 S9000 F600\nG10\nG11\n")
    assert [e[0] for e in out.errors] == [3, 4]
    assert [end[2:] for end in out.ends] == [(0, 5), (0, 3), (0, 5)]
    assert [m.cruise_speed for m in out.moves[1:]] == pytest.approx([20, 20])


def test_recovery_with_less_length():
    """Less than nothing is never pushed back: G11 does not retract."""
    out = run("M207 S2\nM208 S-0.5\nG1 E5\nG10\nG11\nM207 R-3\nG10\nG11\n")
    assert out.errors == []
    assert [end[3] for end in out.ends] == pytest.approx([5, 3, 4.5, 2.5])


def test_g10_with_a_tool_number_sets_temperatures():
    out = run("G10 P0 R140 S205\n")
    assert out.commands == ["G10 P0 R140 S205"]
    assert out.moves == []


@pytest.mark.parametrize(
    ("line", "axis", "value", "limit"),
    [
        ("G1 X251", "x", 251, 250),
        ("G1 Y-.5 X10", "y", -0.5, 0),
        ("G0 Z250.1", "z", 250.1, 250),
        ("G91 G1 X-6", "x", -1, 0),
    ],
)
def test_out_of_range_stops_or_is_clamped(line, axis, value, limit):
    text = f"G1 X5 Y5 Z5\n{line}\nG90 G1 X6 Y6 Z6\n"
    out = run(text)
    assert out.errors == [(2, Fault.OUT_OF_RANGE, axis, value, limit)]
    assert out.ends[-1] == (6, 6, 6, 0)
    out = run(text, clamp=True)
    assert out.errors == []
    ((first, times),) = out.clamped
    assert (first[:5], times) == ((2, Fault.OUT_OF_RANGE, axis, value, limit), 1)
    assert out.moves[1].end_mm["xyz".index(axis)] == limit


def test_return_from_endstop_above_limits_is_allowed():
    """Arms that hang at their switches hold the nozzle above the highest place of Z."""
    text = "G28\nG91\nG1 Z-10 F600\nG1 X2\nG2 I2\nG1 Z0.5\nG1 Z-30\nG1 Z19\n"
    out = run(text, "rotary-delta")
    top = out.ends[0][2] + 10
    assert top > 80
    refused = [(line, fault, axis, limit) for line, fault, axis, _, limit in out.errors]
    assert refused == [(n, Fault.OUT_OF_RANGE, "z", 60) for n in (6, 8)]
    assert out.ends[-1] == (2, 0, pytest.approx(top - 40), 0)


def test_tool_changes_are_events():
    out = run("G1 X10 E1\nT1\nG92 E0\nG1 X20 E2\nT0\nG92 E0\nG1 X30 E1\n", "dual-extruder")
    assert out.errors == []
    assert [m.extruder for m in out.moves if m.kind == "print"] == [0, 1, 0]
    assert [c for c in out.commands if c[0] == "T"] == ["T1", "T0"]
    assert out.statistics["position_mm"][3:] == [2, 2]


def test_a_missing_tool_stops_or_is_ignored():
    ((line, fault, word, value, limit),) = run("G4 P1\nT3\n").errors
    assert (line, fault, word, value, limit) == (2, Fault.MISSING_TOOL, "T", 3, 1)
    out = run("T3\nG1 X5 E1\n", ignore_tools=True)
    assert out.errors == []
    assert out.ends == [(5, 0, 0, 1)]


def test_speed_of_a_move_of_the_extruder_alone():
    out = run("G1 X0 E5 F60\n")
    assert out.moves[0].cruise_speed == pytest.approx(1)


def test_a_time_in_seconds_stretches_a_move():
    out = run("G1 X10 T2\n")
    (move,) = out.moves
    assert (move.end_ticks - move.start_ticks) / 16e6 == pytest.approx(2, rel=0.2)


def test_without_f_the_machine_is_the_limit():
    assert run("G1 X200\n").moves[0].speed_cap == 300
    assert inf not in [m.cruise_speed for m in run("G1 X200\nG1 E50\n").moves]


def test_layers_and_features_of_slicers():
    out = run(";LAYER:0\n;TYPE:WALL-OUTER\nG1 X1 E1\n;LAYER:1\n;TYPE:FILL\nG1 X2 Z.4 E2\n")
    assert out.statistics["layers"] == 2
    assert [m.layer for m in out.moves] == [1, 2]
    assert set(out.statistics["feature_s"]) == {"WALL-OUTER", "FILL"}
    assert run("G1 X1 Z.2 E1\nG1 X2 E2\nG1 Z2\nG1 Z.4\nG1 X1 E3\n").statistics["layers"] == 2


def test_only_a_tool_that_there_is_can_be_used():
    job = Job(spec("multi-material"), False)
    job.tools.use(4)
    assert job.tool == 4
    with pytest.raises(IndexError, match="no such tool"):
        job.tools.use(5)
    assert job.tool == 4
    without = Job(spec("laser"), False)
    without.tools.use(0)
    with pytest.raises(IndexError, match="no such tool"):
        without.tools.use(1)


@pytest.mark.parametrize("words", ["D0", "S0", "D1.75", "T0 D1.75"])
def test_a_machine_without_tools_has_no_volumes(words):
    """Slicers switch them off in the first lines."""
    out = run(f"M200 {words}\nG1 X5\n", "laser")
    assert out.errors == []
    assert out.ends == [(5, 0, 0, 0)]
    assert run("M200 T1 D0\n", "laser").errors == [(1, Fault.MISSING_TOOL, "T", 1, 0)]


def test_axes_after_what_means_nothing_here_are_moves():
    """Headers of many mills: the first cut begins where they go."""
    out = run("G0 G90 G54 X50 Y40 S300 M3\nG43 H1 Z15\nG94 F600\nG1 Z1\nG43 H2\nG54\n", "cnc")
    assert out.errors == []
    assert [end[:3] for end in out.ends] == [(50, 40, 0), (50, 40, 15), (50, 40, 1)]
    assert out.moves[-1].speed_cap == 10
    assert out.commands == ["G54", "S0 S300", "M3", "G43", "G94", "G43 H2", "G54"]


def test_return_from_endstop_below_limits_is_allowed():
    """The SCARA's arms are at home at Y -56, where its limit is 0."""
    out = run("G28\nG1 Y-30\nG1 X220 Y-10\n", "scara")
    assert out.errors == []
    assert [end[1] for end in out.ends] == [-30, -10]
    out = run("G28\nG1 Y-30\nG1 Y-31\n", "scara")
    assert [(e[0], e[1], e[2], e[4]) for e in out.errors] == [(3, Fault.OUT_OF_RANGE, "y", 0)]
