"""The hop of firmware retraction: Z comes back from it, whatever the program does meanwhile."""

from __future__ import annotations

import pytest

from passo._core import Fault, Job, JobStatus

from .driver import run, spec

RETRACTED = "M207 S1 F1800 Z1\nG1 X10 Y20 Z10 F600\nG10\n"  # at Z 11


def heights(lines, machine="i3", **policy):
    """Z behind each move, without errors."""
    out = run(lines, machine, **policy)
    assert out.errors == []
    return [end[2] for end in out.ends]


@pytest.mark.parametrize(
    ("meanwhile", "z"),
    [
        ("G92 Z10\nG1 Z10\n", 10),
        ("G92 Z3\nG1 Z4\n", 11),
        ("G92 X0 Y0 Z0 E0\nG1 Z0.5\n", 10.5),
        ("G28 X\nG1 X5\n", 10),
        ("G28 Y\nG1 Z12\n", 12),
        ("G28 Z\nG1 Z2\n", 2),
        ("G28\n", 0),
        ("G28 B\n", 10),
        ("G28 X B\n", 10),
        ("G28 Z B\nG1 X11\n", 10),
        ("G60\nG1 Z30\nG61\n", 10),
        ("G91\nG1 Z2\nG90\n", 12),
        ("G20\nG1 Z1\nG21\n", 25.4),
    ],
)
def test_g11_returns_to_the_programs_z(meanwhile, z):
    assert heights(f"{RETRACTED}{meanwhile}G11\nG1 X1 E1\n")[-1] == pytest.approx(z)


def test_arms_that_lift_together_end_the_hop_together():
    lines = "M207 S1 Z1\nG1 X10 Y20 Z50\nG10\nG28 X\nG1 X0 Y0 Z5\nG11\n"
    assert heights(lines, "delta")[-1] == 5
    for back in ("G28 X B", "G28 B", "G28 Z B"):
        assert heights(lines.replace("G28 X", back), "delta")[-1] == 5


def test_g60_saves_the_programs_position():
    assert heights(f"{RETRACTED}G60\nG11\nG1 Z30\nG61\n")[-2:] == [30, 10]
    assert heights("G1 Z10\nG60\nG1 Z20\nM207 S1 Z1\nG10\nG61\nG11\n")[-4:] == [21, 11, 10, 10]


def test_hop_shortened_by_limit_returns_same_distance():
    assert heights("M207 S1 Z1\nG1 Z249.9\nG10\nG1 X10 Z250\nG11\n") == [
        249.9,
        249.9,  # the filament
        250,
        250,
        250,
    ]
    lines = "M207 S1 Z1\nG1 Z249.5\nG10\nG1 X9 Z249.8\nG91\nG1 Z-1\nG11\n"
    assert heights(lines)[2:] == [250, 250, 249, 248.8, 248.8]
    assert heights("M207 S1 Z1\nG1 Z249\nG10\nG91\nG1 X9 Z0.5\nG11\n")[2:] == [
        250,
        250,
        249.5,
        249.5,
    ]


def test_refused_command_leaves_hop_as_it_is():
    out = run("M207 S1 Z1\nG1 Z249\nG10\nG1 Z250.5\nG1 X-5 Z250\nG11\n")
    assert [e[:5] for e in out.errors] == [
        (4, Fault.OUT_OF_RANGE, "z", 250.5, 250),
        (5, Fault.OUT_OF_RANGE, "x", -5, 0),
    ]
    assert out.ends[-1][2] == 249


def test_clamp_applies_to_requested_position():
    out = run("M207 S1 Z1\nG1 Z249\nG10\nG1 Z251\nG11\n", clamp=True)
    assert out.clamped[0][0][2:5] == ("z", 251, 250)
    assert out.ends[-1][2] == 250


@pytest.mark.parametrize("line", ["G1 Z-0.5", "G91\nG1 Z-1.5", "G18\nG2 X12 Z1 I1 K-1"])
def test_a_hop_makes_no_room_below_the_limit(line):
    """G11 would go there."""
    lines = f"M207 S1 Z1\nG1 X10 Z1\nG10\n{line}\nG11\n"
    ((_, fault, axis, value, limit),) = run(lines).errors
    assert (fault, axis, limit) == (Fault.OUT_OF_RANGE, "z", 0)
    assert value < 0
    ends = [end[2] for end in run(lines, clamp=True).ends]
    assert min(ends[3:-2]) == 1  # above the limit by the hop, until G11 takes that back
    assert ends[-1] >= 0


@pytest.mark.parametrize("code", ["G2", "G3"])
def test_a_hop_does_not_stop_an_upright_arc(code):
    path = heights(f"M207 S1 Z1\nG1 X10 Z249.5\nG10\nG18\n{code} X10.8 I0.4\nG11\n")
    assert max(path) == 250
    assert path[-1] == 249.5


def test_a_tool_that_is_not_drawn_back_ends_the_hop():
    """Its print would lie in the air; nor does the G11 of the other one go down then."""
    lines = f"{RETRACTED}T1\nG1 X30 E1\nG1 Z12\nT0\nG1 Z13\nG11\nG1 Z14\n"
    assert heights(lines, "dual-extruder")[2:] == [11, 10, 10, 10, 12, 13, 13, 14]


def test_tools_that_are_drawn_back_share_the_hop():
    lines = f"{RETRACTED}T1\nG10\nT0\nG1 Z12\nT1\nG1 Z13\nG11\nG1 Z14\n"
    assert heights(lines, "dual-extruder")[2:] == [11, 10, 10, 11, 13, 14, 13, 13, 14]


def test_the_programs_height_is_reported_without_the_hop():
    job = Job(spec("i3"), False)
    job.feed(f"{RETRACTED}G92 Z3\nG28 X\n".encode())
    while job.advance() == JobStatus.EVENT:
        pass
    assert job.machine_position[2] == 11
    assert job.program_position[2] == 3


TOP = 159.0  # mm at X0 Y60 of the delta: less than half a mm below what its motor c reaches


@pytest.mark.parametrize(
    ("lines", "path"),
    [
        ("G1 Y60\nG10\nG4 P1\nG11\nG1 Y59\n", [(0, TOP), (60, TOP), (59, TOP)]),
        (
            "G10\nG4 P1\nG1 Y60\nG1 E1\nG1 Y59\nG4 P1\nG11\nG1 Y10\n",
            [(0, TOP), (0, TOP + 1), (60, TOP), (59, TOP), (10, TOP)],
        ),
        (
            "G10\nG1 Y60\nG11\nG1 Y0\nG10\nG1 Y1\nG11\n",
            [(0, TOP), (0, TOP + 1), (60, TOP), (0, TOP), (0, TOP + 1), (1, TOP + 1), (1, TOP)],
        ),
    ],
)
@pytest.mark.parametrize("chunk", [0, 9])
def test_a_hop_that_the_motors_do_not_reach_is_left_out(lines, path, chunk):
    out = run(f"M83\nM207 S1 Z1\nG1 Z{TOP}\n{lines}", "delta", chunk)
    assert out.errors == []
    ends = [(0, TOP), *((end[1], end[2]) for end in out.ends)]  # Y and Z
    assert [now for before, now in zip([None, *ends], ends, strict=False) if now != before] == path


def test_position_unreachable_without_hop_is_an_error():
    out = run(f"M207 S1 Z1\nG1 Z{TOP}\nG10\nG1 Y60 Z{TOP + 1}\n", "delta")
    assert [(e[0], e[1], p[2]) for e, p in zip(out.errors, out.points, strict=True)] == [
        (4, Fault.ACTUATOR, pytest.approx(TOP + 1, abs=1))
    ]
