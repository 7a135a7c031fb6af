"""The first move of an axis after a change of tools carries out the offset on all axes."""

from __future__ import annotations

import pytest
from tests.gcode.driver import run

from passo import config
from passo._core import Fault, Job, JobStatus

OFFSETS = [(0.0, 0.0, 0.0), (25.0, -3.0, -0.6), (-10.0, 4.0, 0.2)]  # mm, of T0, T1, T2
BEGIN = "G28\nG1 X100 Y100 Z5 F6000\nM83\n"


def three_tools():
    """T0 and T2 have the first extruder."""
    spec = config.load("dual-extruder").core_spec()
    first, second = spec["tools"]
    tools = [first, second, first]
    return spec | {
        "tools": [tool | {"offset": mm} for tool, mm in zip(tools, OFFSETS, strict=True)]
    }


def ends(text, **policy):
    """Ends of the moves after BEGIN, which has one."""
    out = run(BEGIN + text, three_tools(), **policy)
    assert out.errors == []
    return out.ends[1:]


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("tool", [1, 2])
def test_a_travel_moves_axes_that_it_does_not_name(axis, tool):
    """By one move, and once only."""
    to = [100.0, 100.0, 5.0]
    to[axis] += 2
    letter, offset = "XYZ"[axis], OFFSETS[tool]
    expected = tuple(round(at - mm, 9) for at, mm in zip(to, offset, strict=True))
    for move in (f"G1 {letter}{to[axis]:g}", f"G91\nG0 {letter}2"):
        moves = ends(f"T{tool}\n{move}\n{letter}{to[axis] if 'G91' not in move else 0:g}\n")
        assert [m[:3] for m in moves] == [expected]


@pytest.mark.parametrize("line", ["G1 Y120 E1", "G1 X100 Y120 Z5 E1", "G91\nG1 Y20 E1"])
def test_filament_is_laid_where_the_line_is(line):
    """A travel first, to where the line begins with this nozzle."""
    expected = [(75, 103, 5.6, 0), (75, 123, 5.6, 1)]
    assert ends(f"T1\n{line}\n") == expected
    kinds = [str(m.kind) for m in run(BEGIN + f"T1\n{line}\n", three_tools()).moves[1:]]
    assert [kind.split(".")[-1].lower() for kind in kinds] == ["travel", "print"]


@pytest.mark.parametrize(
    ("plane", "arc", "end"),
    [
        ("G17", "G2 X120 I10 J0 E3", (95, 103, 5.6, 3)),
        ("G17", "G3 I10 J0", (75, 103, 5.6, 0)),  # a full circle names no axis
        ("G17", "G2 X120 R10 Z6", (95, 103, 6.6, 0)),
        ("G18", "G2 X104 I2 K0 E1", (79, 103, 5.6, 1)),
        ("G19", "G3 Y104 J2 K0", (75, 107, 5.6, 0)),
    ],
)
def test_an_arc_begins_where_the_tool_is_meant_to_be(plane, arc, end):
    moves = ends(f"T1\n{plane}\n{arc}\n")
    assert moves[0] == (75, 103, 5.6, 0)
    assert moves[-1] == pytest.approx(end)
    centre, axes = {"G17": ((85, 103), (0, 1)), "G18": ((77, 5.6), (0, 2))}.get(
        plane, ((105, 5.6), (1, 2))
    )
    for move in moves:
        u, v = (move[a] - c for a, c in zip(axes, centre, strict=True))
        assert (u * u + v * v) ** 0.5 == pytest.approx(10 if plane == "G17" else 2, abs=1e-6)


@pytest.mark.parametrize(
    ("lines", "end"),
    [
        ("T1\nT0\nG1 Y120", (100, 120, 5)),
        ("T1\nT2\nG1 Y120", (110, 116, 4.8)),
        ("T1\nT2\nT0\nG1 Y120", (100, 120, 5)),
        ("T1\nG1 F1200\nG4 P10\nG92 E0\nM82\nG1 Y120", (75, 123, 5.6)),
        ("T1\nG92 X0\nG1 Y120", (75, 123, 5.6)),
        ("T1\nG92 X0\nG1 X7", (82, 103, 5.6)),
        ("T1\nG92 X0 Y0 Z0\nT0\nG1 X1", (101, 100, 5)),
        ("T1\nG60 S0\nT0\nG1 X90\nT1\nG61 S0", (75, 103, 5.6)),
        ("T1\nG53 G1 X50", (50, 100, 5)),
        ("T1\nG53 G1 X50\nG1 Y120", (50, 123, 5.6)),
        ("T1\nG28 X\nG1 Y120", (0, 123, 5.6)),
        ("T1\nG28\nG1 Y7", (0, 10, 0)),
        ("T1\nG28 B\nG1 Y120", (75, 123, 5.6)),
        ("T1\nG10\nG11\nG1 Y120", (75, 123, 5.6)),
        ("G20\nT1\nG1 Y4", (75, 104.6, 5.6)),
    ],
)
def test_commands_between_tool_change_and_move(lines, end):
    assert ends(lines + "\n")[-1][:3] == pytest.approx(end)


def test_move_of_filament_alone_ignores_tool_offset():
    assert ends("T1\nG1 E3\nG1 E-1\nG0 X120 Y50\n") == [
        (100, 100, 5, 3),
        (100, 100, 5, 2),
        (95, 53, 5.6, 2),
    ]


def test_the_program_sees_its_tool_where_it_means_it_to_be():
    job = Job(three_tools(), False)
    job.feed(f"{BEGIN}T1\n".encode())
    while job.advance() == JobStatus.EVENT:
        pass
    assert job.program_position[:3] == [100, 100, 5]
    assert job.tools.offset_due == pytest.approx([-25, 3, 0.6])
    job.tools.set_offset(1, 2, -0.5)  # M218, for the next move too
    assert job.tools.offset_due == pytest.approx([-25, 3, 0.5])
    job.feed(b"G1 Y101\n")
    job.advance()
    job.flush()
    assert job.machine_position[:3] == pytest.approx([75, 104, 5.5])
    assert job.program_position[:3] == pytest.approx([100, 101, 5])
    assert job.tools.offset_due == [0, 0, 0]


def test_an_axis_without_room_for_the_offset_refuses_the_move():
    """Nothing moves; the offset is still to be carried out."""
    job = Job(three_tools(), False)
    low = config.load("dual-extruder").axes["x"].min_mm
    job.feed(f"G28\nG1 X{low + 20:g} Y100 Z5 F6000\nT1\nG1 Y120\n".encode())
    while (status := job.advance()) == JobStatus.EVENT:
        pass
    assert status == JobStatus.ERROR
    assert job.error[1:5] == (Fault.OUT_OF_RANGE, "x", low - 5, low)
    job.abandon()
    job.flush()
    assert job.machine_position[:3] == [low + 20, 100, 5]
    job.feed(f"G1 X{low + 25:g} Y120\n".encode())
    job.advance()
    job.flush()
    assert job.machine_position[:3] == pytest.approx([low, 123, 5.6])


def test_an_arc_without_room_to_begin_is_refused_or_clamped():
    low = config.load("dual-extruder").axes["x"].min_mm
    text = f"G28\nG1 X{low + 20:g} Y100 Z5 F6000\nT1\nG2 X{low + 40:g} R10 E1\n"
    out = run(text, three_tools())
    assert [e[1:] for e in out.errors] == [(Fault.OUT_OF_RANGE, "x", low - 5, low)]
    assert len(out.moves) == 1
    assert run(text, three_tools(), clamp=True).ends[-1] == pytest.approx((low + 15, 103, 5.6, 1))


def test_an_error_in_the_first_move_leaves_the_offset_due():
    job = Job(three_tools(), False)
    job.feed(f"{BEGIN}T1\nG2 X110 I0.5 J0 E1\n".encode())
    while (status := job.advance()) == JobStatus.EVENT:
        pass
    assert (status, job.error[1]) == (JobStatus.ERROR, Fault.RADII)
    job.abandon()
    job.feed(b"G1 Y120\n")
    job.advance()
    job.flush()
    assert job.machine_position[:3] == pytest.approx([75, 123, 5.6])


@pytest.mark.parametrize("steps", [1, 7, 100])
def test_tool_offsets_do_not_depend_on_chunks(steps):
    text = BEGIN + "T1\nG1 Y120 E1\nT2\nG2 X120 R10 E1\nT0\nG1 Z6\n"
    assert run(text, three_tools(), chunk=steps).ends == run(text, three_tools()).ends
