"""Words that name axes behind commands that have none: a move is never dropped without a word."""

import pytest

from passo._core import Fault

from .driver import run

NAMELESS = (
    "G15 G40 G43 G49 G53 G54 G55 G59 G59.1 G59.3 G61.1 G64 G69 G91.1 G93 G94 G95 G97 G98 G99"
    " M3 M4 M5 M6 M7 M8 M9"
)


@pytest.mark.parametrize("code", NAMELESS.split())
@pytest.mark.parametrize("modal", ["", "G0 X1\n", "G1 X1\n"])
def test_a_move_after_a_command_without_axes(code, modal):
    out = run(f"{modal}{code} X10 Y5\nY6\n")
    assert out.errors == []
    assert out.ends[-2:] == [(10, 5, 0, 0), (10, 6, 0, 0)]


def test_several_commands_in_one_line_keep_their_axes():
    out = run("G90 G94 G17 G80 G40 G49 X10 F600\nG40G49X20\n")
    assert out.ends == [(10, 0, 0, 0), (20, 0, 0, 0)]
    assert out.commands == ["G94", "G80", "G40", "G49", "G40", "G49"]


def test_a_spindle_keeps_its_own_words():
    out = run("M3 S100 X10 F600 I\n")
    assert out.commands == ["M3 S100 X10 F600 I"]
    assert out.ends == [(10, 0, 0, 0)]
    assert out.statistics["move_s"] == pytest.approx(1, abs=0.01)


def test_a_spindle_leaves_the_feed_rate_to_moves():
    out = run("M4 S0 F600\nG1 X10\n")
    assert out.commands == ["M4 S0 F600"]
    assert out.statistics["move_s"] == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize(
    "code", ["G12", "G29", "G30", "G41", "G42", "G52", "G68", "G80", "G92.2", "G43.1"]
)
def test_commands_with_axis_words_keep_them(code):
    out = run(f"G1 X1\n{code} X10 Y5\nY6\n")
    assert out.ends == [(1, 0, 0, 0), (1, 6, 0, 0)]
    assert out.commands == [f"{code} X10 Y5"]


@pytest.mark.parametrize("code", ["G5", "G5.1", "G33", "G38.2", "G76", "G84", "G89"])
def test_words_after_unsupported_motion_belong_to_it(code):
    """X20 Z0 after a drilling cycle is a hole, and no move on the way of which the tool breaks."""
    cycle = f"G0 X5 Z9\n{code} X10 Z-2 R2 F100\nX20 Z0\nN5 Z3\n"
    for end in ("G80\nX30\n", "G80 X29\nX30\n", "G1 X30\n", "G0 X30\n"):
        out = run(cycle + end + "X31\n")
        assert out.errors == []
        assert out.ends == [(5, 0, 9, 0), (30, 0, 9, 0), (31, 0, 9, 0)]
        assert out.commands[:3] == [f"{code} X10 Z-2 R2 F100", f"{code} X20 Z0", f"{code} Z3"]


def test_stray_command_without_axes_changes_nothing():
    assert run("G0 X5\nG33\nX6\n").ends == [(5, 0, 0, 0), (6, 0, 0, 0)]


@pytest.mark.parametrize("line", ["M6 T1", "M06 T1", "M6T1", "T1 M6", "m6 t1"])
def test_a_tool_after_a_change_of_tools_is_taken(line):
    out = run(f"{line}\nG1 X30 E1\n", "dual-extruder")
    assert sorted(out.commands) == ["M6", "T1"]
    assert out.moves[-1].extruder == 1
    assert [e[:4] for e in run(f"{line}\n").errors] == [(1, Fault.MISSING_TOOL, "T", 1)]


@pytest.mark.parametrize(
    ("line", "places"),
    [
        ("G90 T1", []),
        ("G21T1", []),
        ("G54 T1", []),
        ("G53 T1", []),
        ("M83 T1", []),
        ("M5 T1", []),
        ("G17 G90 T1 M6", []),
        ("G90 X10 T1", [(10, 0)]),
        ("G54 X10 T1", [(10, 0)]),
        ("X10 T1", [(10, 0)]),
        ("G1 X10 T1", [(10, 0)]),
        ("X10 T1 M6", [(10, 0)]),
        ("X10 T5", [(10, 5)]),
        ("X10 T0.5", [(10, 0.5)]),
        ("G90 X10 T5", [(10, 5)]),
    ],
)
def test_a_tool_after_a_move_or_what_has_no_words_is_taken(line, places):
    """A number that is no tool of the machine is the move's duration, in s."""
    out = run(f"{line}\nG1 E1\n", "dual-extruder")
    assert out.errors == []
    durations = [m.length / m.cruise_speed if m.speed_limit == 1 else 0 for m in out.moves[:-1]]
    assert [m.end_mm[0] for m in out.moves[:-1]] == [x for x, _ in places]
    assert durations == pytest.approx([s for _, s in places])
    assert out.moves[-1].extruder == (0 if places and places[0][1] else 1)


def test_number_after_wordless_command_is_a_missing_tool():
    for line in ("G90 T5", "G90 T5 X10", "M83 T5"):
        assert [e[1:4] for e in run(line).errors] == [(Fault.MISSING_TOOL, "T", 5)]


@pytest.mark.parametrize("line", ["G10 L2 P1 X5 Y5", "G10 L20 X5", "G10 P1 L20"])
def test_the_zero_of_a_coordinate_system_is_not_a_retraction(line):
    out = run(f"G1 X1\n{line}\nG1 X2\n")
    assert out.ends == [(1, 0, 0, 0), (2, 0, 0, 0)]
    assert len(out.commands) == 1
    assert out.commands[0].startswith("G10 L2")
    (event,) = out.events
    assert event[4] in ("G10 L2", "G10 L20")  # a name of its own, which nobody knows


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("G53 G0 X20", (20, 7, 3, 0)),
        ("G53 X20", (20, 7, 3, 0)),
        ("X20 G53 Y1", (25, 1, 3, 0)),
        ("G91 G53 G1 X20 E2", (20, 7, 3, 2)),
        ("G20 G53 X1", (25.4, 7, 3, 0)),
        ("G53 G1 R X20 Y1", (20, 1, 3, 0)),
        ("G53 G2 X25 I5", (25, 7, 3, 0)),
        ("G53 X20 M117 a", (20, 7, 3, 0)),
        ("G53 G1 X20 M400 G1 Y1", (20, 1, 3, 0)),
    ],
)
def test_g53_counts_from_the_zero_of_the_machine(line, end):
    out = run(f"G1 X15 Y7 Z3 F600\nG92 X10 Y20 Z0\n{line}\n")
    assert out.errors == []
    assert out.ends[-1] == pytest.approx(end)


def test_g53_holds_for_its_line_alone():
    out = run("G1 X15\nG92 X10\nG53 G1 X20\nG1 X20\nX21\nG53\nX22\n")
    assert [x for x, *_ in out.ends] == [15, 20, 25, 26, 27]
    out = run("G1 X15\nG92 X10\nG53 G1 X-1\nG1 X9\n")  # an error ends its line
    assert [e[:5] for e in out.errors] == [(3, Fault.OUT_OF_RANGE, "x", -1, 0)]
    assert out.ends[-1][0] == 14


def test_g53_ignores_tool_offsets():
    out = run("T1\nG1 X10\nG53 G1 X60\nG1 X10\n", "dual-extruder")
    assert [x for x, *_ in out.ends] == [-15, 60, -15]


@pytest.mark.parametrize(
    "line", ["G4 S-1", "G4 P-0.5", "G1 X5 T-2", "T-1 X5 Y5 T-3", "G2 X5 I2 P-1"]
)
def test_negative_times_and_turns_are_refused(line):
    out = run(f"G1 X1\n{line}\nG1 X2\n")
    assert [e[1] for e in out.errors] == [Fault.RANGE]
    assert [x for x, *_ in out.ends] == [1, 2]
