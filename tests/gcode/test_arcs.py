"""G2 and G3: chords near enough to the circle, with the end where the program says."""

from __future__ import annotations

from itertools import pairwise
from math import acos, dist, hypot, pi

import pytest

from passo._core import Fault, Job, JobStatus

from .driver import run, spec

AXES = {"G17": (0, 1, 2), "G18": (2, 0, 1), "G19": (1, 2, 0)}


def points(out, plane="G17"):
    u, v, w = AXES[plane]
    start = out.moves[0].start_mm
    return [(p[u], p[v], p[w]) for p in [start, *(m.end_mm for m in out.moves)]]


def arc(line, before="G1 X100 Y100 Z100 E0"):
    """The chords of the one arc in `line`."""
    out = run(f"{before}\n{line}\n")
    assert out.errors == []
    assert out.statistics["arcs"] == 1
    out.moves = [m for m in out.moves if m.line == before.count("\n") + 2]
    return out


def sweep(path, centre):
    """Angle that the chords turn by about the centre, counter-clockwise positive."""
    angle = 0.0
    for a, b in pairwise(path):
        ax, ay, bx, by = a[0] - centre[0], a[1] - centre[1], b[0] - centre[0], b[1] - centre[1]
        cross, dot = ax * by - ay * bx, ax * bx + ay * by
        angle += acos(min(1, max(-1, dot / hypot(ax, ay) / hypot(bx, by)))) * (
            1 if cross > 0 else -1
        )
    return angle


def assert_chords(path, centre, radius, error=0.005):
    for a, b in pairwise(path):
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        assert dist(a[:2], centre) == pytest.approx(radius, abs=1e-9)
        assert radius - error < dist(middle, centre) < radius


@pytest.mark.parametrize(
    ("line", "end", "centre", "turned"),
    [
        ("G2 X120 Y100 I10", (120, 100), (110, 100), -pi),
        ("G3 X120 Y100 I10", (120, 100), (110, 100), pi),
        ("G2 X110 Y110 I10 J0", (110, 110), (110, 100), -pi / 2),
        ("G3 X110 Y110 I10", (110, 110), (110, 100), 3 * pi / 2),
        ("G3 X110 Y110 J10", (110, 110), (100, 110), pi / 2),
        ("G2 I20", (100, 100), (120, 100), -2 * pi),
        ("G3 X100 Y100 J-7", (100, 100), (100, 93), 2 * pi),
        ("G2 I5 P3", (100, 100), (105, 100), -6 * pi),
        ("G3 X110 Y100 I5 P2", (110, 100), (105, 100), 3 * pi),
        ("G2 X110 Y110 R10", (110, 110), (110, 100), -pi / 2),
        ("G3 X110 Y110 R10", (110, 110), (100, 110), pi / 2),
        ("G2 X110 Y110 R-10", (110, 110), (100, 110), -3 * pi / 2),
        ("G3 X110 Y110 R-10", (110, 110), (110, 100), 3 * pi / 2),
        ("G2 X120 Y100 R10", (120, 100), (110, 100), -pi),
        ("G91 G2 X10 Y10 I10", (110, 110), (110, 100), -pi / 2),
        ("G2 X100.02 Y100 I.01", (100.02, 100), (100.01, 100), -pi),
    ],
)
def test_arcs_follow_their_circle(line, end, centre, turned):
    path = points(arc(line))
    assert path[-1] == (*end, 100)
    assert_chords(path, centre, dist((100, 100), centre))
    assert sweep(path, centre) == pytest.approx(turned, abs=1e-6)


@pytest.mark.parametrize(
    ("plane", "line"),
    [
        ("G18", "G3 Z110 X110 K0 I10"),
        ("G18", "G3 Z110 X110 R10"),
        ("G19", "G3 Y110 Z110 J0 K10"),
        ("G19", "G3 Y110 Z110 R10"),
        ("G17", "G3 X110 Y110 I0 J10"),
    ],
)
def test_arcs_in_all_three_planes(plane, line):
    path = points(arc(line, f"G1 X100 Y100 Z100\n{plane}"), plane)
    centre = (100, 110)
    assert path[-1][:2] == (110, 110)
    assert {p[2] for p in path} == {100}
    assert_chords(path, centre, 10)
    assert sweep(path, centre) == pytest.approx(pi / 2, abs=1e-6)


def test_a_helix_rises_and_extrudes_in_proportion():
    out = arc("G3 X100 Y100 I20 Z104 E8 P2")
    n = len(out.moves)
    for i, move in enumerate(out.moves, 1):
        assert move.end_mm[2] == pytest.approx(100 + 4 * i / n, abs=1e-9)
        assert move.end_mm[3] == pytest.approx(8 * i / n, abs=1e-9)
    assert out.moves[-1].end_mm[:4] == (100, 100, 104, 8)
    assert out.moves[0].kind == "print"


def test_arcs_in_inches_and_by_modal_motion():
    out = run("G1 X100 Y100\nG20 G91\nG2 X1 I.5\nX-1 I-.5\n")
    assert out.errors == []
    assert [max(m.end_mm[0] for m in out.moves), out.moves[-1].end_mm[0]] == pytest.approx(
        [125.4, 100]
    )


@pytest.mark.parametrize(
    ("line", "fault", "word"),
    [
        ("G2 X10 Y10 R1", Fault.ARC, "R"),
        ("G2 X10 Y10 R3.5", Fault.ARC, "R"),  # half of the way is 3.536
        ("G2 R5", Fault.ARC, "R"),
        ("G2 X10 Y10", Fault.CENTRE, "I, J and R"),
        ("G2 X10 I0 J0", Fault.CENTRE, "I, J and R"),
        ("G3 Z12", Fault.CENTRE, "I, J and R"),
        ("G2 F100", Fault.CENTRE, "I, J and R"),
        ("G18 G2 X10 J5", Fault.CENTRE, "K, I and R"),
        ("G19 G2 Y10 R0", Fault.CENTRE, "J, K and R"),
    ],
)
def test_impossible_arcs_are_errors(line, fault, word):
    out = run(f"G1 X5 Y5\n{line}\n")
    assert [e[:3] for e in out.errors] == [(2, fault, word)]
    assert len(out.moves) == 1


def test_maximum_number_of_turns_of_an_arc():
    ((line, fault, word, turns, most),) = run("G1 X5 Y5\nG2 I5 P100000000\n").errors
    assert (line, fault, word, turns) == (2, Fault.RANGE, "P", 1e8)
    assert most == pytest.approx(135_047)
    many = f"G1 X5 Y5\nG2 I5 P{most + 2:.0f}\n"
    assert [e[1] for e in run(many).errors] == [Fault.RANGE]


@pytest.mark.parametrize(
    ("line", "radii"),
    [
        ("G2 X120 Y100 I10.03", None),  # 10.03 and 9.97: 0.06 mm, as much as 0.6 %
        ("G2 X120 Y100 I10.02", ()),
        ("G2 X101 Y100 I0.52", ()),  # coordinates with one decimal
        ("G3 X150 Y120 I20 J5", None),
        ("G2 X0 Y100 I-50.1", ()),
        ("G2 X0 Y100 I-50.2", None),
        ("G3 X99.55 Y101 I-130", ()),
        ("G3 X99.45 Y101 I-130", None),  # less than 0.5 %, but 0.546 mm
        ("G18 G2 X120 Z100 I12 K0", None),
    ],
)
def test_an_arc_whose_ends_lie_on_two_circles_is_an_error(line, radii):
    """0.5 % of the radius is allowed, at least 0.05 mm and at most 0.5 mm."""
    out = run(f"G1 X100 Y100 Z100 E0\n{line}\nG1 E5\n")
    if radii is None:
        ((number, fault, _, start, end),) = out.errors
        assert (number, fault) == (2, Fault.RADII)
        assert abs(start - end) > 0.05
        assert out.statistics["arcs"] == 0
    else:
        assert out.errors == []
        assert out.statistics["arcs"] == 1
    assert out.ends[-1][3] == 5


def test_the_radii_of_a_wrong_arc():
    ((_, fault, _, start, end),) = run("G1 X10 Y10\nG2 X30 Y10 I7 J0\n").errors
    assert (fault, start, end) == (Fault.RADII, 7, 13)


def test_an_arc_out_of_range_stops_or_is_clamped():
    text = "G1 X5 Y5\nG2 X15 Y5 I5\nG3 X5 Y5 I-5\nG3 I-10\n"
    out = run(text)
    ((line, fault, axis, value, limit),) = out.errors
    assert (line, fault, axis, limit) == (4, Fault.OUT_OF_RANGE, "x", 0)
    assert value < 0
    out = run(text, clamp=True)
    assert out.errors == []
    assert min(m.end_mm[0] for m in out.moves) == 0
    assert out.ends[-1] == (5, 5, 0, 0)


@pytest.mark.parametrize("line", ["G2 X5 Y15 I0 J10", "G2 X5 Y15 R10", "G2 X-5 Y25 I10 J0"])
def test_an_arc_that_begins_at_a_limit_instead_is_clamped_too(line):
    text = f"G1 X-5 Y5\n{line}\nG1 X5 Y15\nG2 X25 Y15 I5\n"
    out = run(text, clamp=True)
    assert [e[:2] for e in out.errors] == [(4, Fault.RADII)]  # both ends are there: it is checked
    assert min(m.end_mm[0] for m in out.moves) == 0
    assert out.ends[-1][:2] == (5, 15)


def test_arc_clamped_to_a_point_extrudes_its_filament():
    out = run("G1 X-5 Y5\nG2 X-9 Y5 R2 E1\n", clamp=True)
    assert out.errors == []
    assert out.ends[-1] == (0, 5, 0, 1)


def test_speed_on_an_arc_is_bounded_by_curvature_and_feed():
    out = arc("G2 I2 F18000")
    speed = max(m.cruise_speed for m in out.moves)
    assert speed == pytest.approx((3000 * 2) ** 0.5, rel=0.01)
    assert max(m.cruise_speed for m in arc("G2 I50 F600").moves) == pytest.approx(10)
    assert all(m.inner for m in out.moves[1:])
    assert not out.moves[0].inner


@pytest.mark.parametrize(("plane", "along"), [("G18", 0), ("G19", 1)])
def test_centripetal_acceleration_stays_within_axis_limits(plane, along):
    """At its top and bottom an upright circle needs Z's acceleration, where only X or Y moves."""
    radius = 20.0
    chords = arc(f"G2 K-{radius:g} F12000", before=f"{plane} G1 X100 Y100 Z100 E0").moves
    pulls = []
    for m in chords:
        level = abs(m.end_mm[along] - m.start_mm[along]) / m.length  # Z's share of the pull
        pulls.append(level * max(m.start_speed, m.cruise_speed, m.end_speed) ** 2 / radius)
    assert max(pulls) == pytest.approx(100.0, rel=1e-3)  # Z's acceleration, mm/s²


def before_and_after(machine, before, line):
    """A job after these lines and after one more that is refused: its error, and where machine and
    program are before and after it, with the moves that it has made."""
    job = Job(spec(machine) if isinstance(machine, str) else machine, True)
    job.results.keep_moves(True)
    states = []
    for text in (before, line):
        job.feed(f"{text}\n".encode())
        while (found := job.advance()) == JobStatus.EVENT:
            pass
        if found == JobStatus.ERROR:
            job.abandon()
        job.flush()
        made = len(job.results.take_moves())
        states.append((job.machine_position, job.program_position, job.clock))
    assert found == JobStatus.ERROR
    return job, made, *states


def assert_same(was, then):
    for a, b in zip(was[:2], then[:2], strict=True):
        assert a == pytest.approx(b, abs=1e-12)
    assert was[2] == then[2]


@pytest.mark.parametrize(
    ("before", "line", "axis", "farthest"),
    [
        ("G1 X50 Y50", "G2 X0 Y0 R40 E10", "y", -1.77),
        ("G1 X50 Y50", "G3 X100 Y50 R-30 P1 E10", "", 0),
        ("G1 X10 Y10", "G2 X10 Y10 I-8 J-8 E5", "y", -9.31),
        ("G1 X10 Y10", "G2 X10 Y10 I0 J-100 E5", "y", -190),
        ("G1 X10 Y10", "G3 I-8 P9 Z5 E5", "x", -6),
        ("G1 X240 Y10 Z5", "G2 X240 Y30 Z8 J10 E3", "", 0),
        ("G1 X245 Y10 Z5", "G3 X245 Y30 Z8 J10 E3", "x", 255),
        ("G1 X100 Y210", "G2 X120 I10 E1", "", 0),
        ("G1 X100 Y211", "G2 X120 I10 E1", "y", 221),
        ("G1 X100 Y10 G91", "G3 X20 Y0 I10 J0 E1", "", 0),
        ("G1 X100 Y9.9 G91", "G3 X20 Y0 I10 J0 E1", "y", -0.1),
        ("G1 X100 Z9.9 G18", "G2 X120 I10 K0 E1", "z", -0.1),
        ("G1 X100 Z5 G18", "G3 X100 Y50 I10 K-2 E1", "z", -7.2),
        ("G1 X9 Z50 G18", "G3 Z70 K10 E1", "x", -1),
        ("G1 Y9 Z50 G19", "G2 Z70 K10 E1", "y", -1),
        ("G1 Y100 Z4 G19", "G3 X30 J5 E1", "z", -1),
        ("G1 Y100 Z4 G19", "G2 Y100 Z4 J2 K2 E1", "", 0),
        ("G1 X50 Y20 G92 X0 Y0", "G3 X20 I10 E1", "", 0),
        ("G1 X50 Y9 G92 X0 Y0", "G3 X20 I10 E1", "y", -1),
        ("G20 G1 X4 Y.3", "G3 X5 I.5 E.1", "y", -5.08),
        ("M207 S1 Z1\nG1 X100 Z9.9\nG10\nG18", "G2 X120 I10 K0", "z", -0.1),
    ],
)
def test_an_arc_beyond_the_limits_is_refused_before_it_moves(before, line, axis, farthest):
    before = f"M83\n{before.replace(' G', chr(10) + 'G')} F6000"
    if not axis:
        assert run(f"{before}\n{line}\n").errors == []
        return
    job, made, was, then = before_and_after("i3", before, f"{line} F1200")
    number, fault, name, value, limit = job.error[:5]
    assert (number, fault, name) == (before.count("\n") + 2, Fault.OUT_OF_RANGE, axis)
    assert value == pytest.approx(farthest, abs=0.01)
    assert limit in (0, 220, 250)
    assert made == 0
    assert_same(was, then)
    job.feed(b"G90\nG17\nG21\nG1 X60\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    assert [m.cruise_speed for m in job.results.take_moves()] == [
        pytest.approx(20 if "G20" not in before else 300)
    ]


@pytest.mark.parametrize(
    "line", ["G1 Y50\nG2 X7.8 Y50 I5 E1", "G1 Y50\nG2 X-2.2 Y50 I-1.1", "G3 X.3 Y2.5 J2.5"]
)
def test_an_arc_from_an_endstop_beyond_the_limit_leads_back_only(line):
    job = Job(spec("i3"), False)
    job.axes.set([(0, -2.2)])
    job.feed(f"M83\n{line}\n".encode())
    found = job.advance()
    if "I-1.1" in line:
        assert job.error[1:4] == (Fault.OUT_OF_RANGE, "x", pytest.approx(-4.4, abs=0.01))
    else:
        assert found == JobStatus.NEED_INPUT


@pytest.mark.parametrize(
    ("machine", "before", "line", "fault"),
    [
        ("delta", "G1 X0 Y0 Z20\nG1 X10", "G2 X10 I21 J33 E1", Fault.UNREACHABLE),
        ("delta", "G1 X0 Y0 Z158", "G18\nG3 X40 I20 K0 E1", Fault.ACTUATOR),
        ("scara", "G1 X100 Y200 Z5", "G2 X100 Y200 J30 E1", Fault.UNREACHABLE),
        ("scara", "G1 X100 Y40 Z5", "G3 X100 Y40 J-49 E1", Fault.ACTUATOR),
        ("rotary-delta", "G1 X0 Y40 Z5", "G2 X0 Y40 J30 E1", Fault.ACTUATOR),
    ],
)
def test_an_arc_beyond_reach_is_refused_before_it_moves(machine, before, line, fault):
    *modes, line = line.split("\n")
    wide = [axis | {"min": -300, "max": 300} for axis in spec(machine)["axes"]]
    job, made, was, then = before_and_after(
        spec(machine) | {"axes": wide}, "\n".join(["M83", before, *modes, "G1 F3000"]), line
    )
    assert job.error[1] == fault
    assert made == 0
    assert_same(was, then)


def test_refused_arc_keeps_tool_offset_due():
    """The travel to the arc's begin with the new tool is not made, but by the next move."""
    before = "M83\nG1 X60 Y50 F6000\nT1"
    job, made, was, then = before_and_after("dual-extruder", before, "G2 X60 I-40 E1")
    assert job.error[1:3] == (Fault.OUT_OF_RANGE, "x")
    assert made == 0
    assert_same(was, then)
    job.feed(b"G1 Y60\n")
    job.advance()
    assert job.machine_position[:2] == [35, 60]


def test_stopped_arc_counts_filament_moved_so_far():
    job = Job(spec("i3"), True)
    job.feed(b"G1 X50 Y100 E1 F3000\nG2 X50 Y100 I50 P3 E61\n")
    assert job.advance(6 * 16e6) == JobStatus.FULL  # the arc has not been read to its end
    job.flush()
    job.stops.stop_from(0.5 * job.clock)
    e = job.machine_position[3]
    assert 1 < e < 60
    assert job.program_position[3] == pytest.approx(e, abs=1e-12)


def test_move_skipped_after_event_of_its_line_counts_no_filament():
    job = Job(spec("i3"), True)
    job.feed(b"G1 X50 E5 S100\n")
    assert job.advance() == JobStatus.EVENT
    job.abandon()
    assert job.program_position == [0, 0, 0, 0]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_rest_of_arc_is_offset_after_babystep(axis):
    job = Job(spec("unbounded"), False)
    job.results.keep_moves(True)
    job.feed(b"G1 X25 Y110 F6000\nG2 X25 Y110 I100\nG1 X0\n")
    job.advance(6 * 16e6)
    known = len(job.results.take_moves())
    assert known < 300  # of 332 moves
    job.plan.shift_from(job.clock, axis, 0.5)
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    centre, height = [125.0, 110.0, 0.0], 0.5 * (axis == 2)
    centre[axis] += 0.5
    *chords, line = job.results.take_moves()[-30:]
    for chord in chords:
        x, y, z = chord.end_mm[:3]
        assert hypot(x - centre[0], y - centre[1]) == pytest.approx(100, abs=1e-9)
        assert z == height
    assert chords[-1].end_mm[:2] == pytest.approx((centre[0] - 100, centre[1]), abs=1e-9)
    assert line.end_mm[0] == 0.5 * (axis == 0)


def test_rest_of_arc_extrudes_evenly_with_another_flow():
    job = Job(spec("unbounded"), False)
    job.results.keep_moves(True)
    job.feed(b"M83\nG1 X25 Y110 F6000\nG2 X25 Y110 I100 E33\n")
    job.advance(6 * 16e6)
    (feed,) = {round(m.end_mm[3] - m.start_mm[3], 9) for m in job.results.take_moves()[1:]}
    job.filament.scale_flow_from(job.clock, 0, 0.5)
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    chords = job.results.take_moves()[-60:]
    assert [m.end_mm[3] - m.start_mm[3] for m in chords] == pytest.approx([feed / 2] * 60, abs=1e-9)


@pytest.mark.parametrize("radius", ["7.07", "-7.07", "7.068"])
def test_a_radius_that_rounding_made_too_small_is_half_a_circle(radius):
    out = run(f"G1 X100 Y100\nG3 X110 Y110 R{radius}\n")
    assert out.errors == []
    middle = [hypot(m.end_mm[0] - 105, m.end_mm[1] - 105) for m in out.moves[1:]]
    assert middle == pytest.approx([hypot(5, 5)] * len(middle), abs=1e-9)
    assert len(middle) > 10


@pytest.mark.parametrize("plane", AXES)
@pytest.mark.parametrize(
    "words",
    ["{u}-0 {v}-0", "{u}0", "{v}-0", "{u}0 {v}0 P3", "R0", "R0.001", "R-0.001", "{u}0.0005"],
)
@pytest.mark.parametrize("word", ["G2", "G3"])
def test_a_tiny_arc_without_a_circle_is_a_straight_line(plane, words, word):
    u, v, w = AXES[plane]
    centre = words.format(u="IJK"[u], v="IJK"[v])
    ends = {"XYZ"[u]: 99.999, "XYZ"[v]: 100.001, "XYZ"[w]: 100.5}
    line = f"{word} {' '.join(f'{k}{mm}' for k, mm in ends.items())} {centre} E0.00007 F1200"
    out = run(f"M83\n{plane}\nG1 X100 Y100 Z100 F6000\n{line}\nG1 X101 E0.1\n")
    assert out.errors == []
    assert out.statistics["arcs"] == 0
    tiny, after = out.moves[1:]
    assert tiny.end_mm[:3] == (ends["X"], ends["Y"], ends["Z"])
    assert tiny.end_mm[3] == pytest.approx(0.00007, abs=1e-12)
    assert tiny.kind == "print"
    assert after.cruise_speed == pytest.approx(20)
    assert after.end_mm[3] == pytest.approx(0.10007, abs=1e-12)


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("G2 X100.05 I0 J0 E1", None),
        ("G2 X100.051 I0 J0 E1", Fault.CENTRE),
        ("G2 X100.03 Y100.03 Z104 I0 J0 E1", None),
        ("G2 X100.04 Y100.04 I0 J0 E1", Fault.CENTRE),
        ("G2 X100 Y100 I0 J0 E1", None),
        ("G2 X100.001 E1", Fault.CENTRE),
        ("G2 X100.05 R0.01 E1", None),
        ("G2 X100.06 R0.01 E1", Fault.ARC),
        ("G2 X100 Y100 R5 E1", Fault.ARC),
        ("G2 X100 Y100 R0 E1", Fault.CENTRE),
        ("G20 G2 X3.938 Y3.937008 I0 J0 E1", None),
        ("G91 G2 X-0.001 Y0.001 I-0 J-0 E1", None),
    ],
)
def test_arcs_without_a_circle_are_lines_up_to_the_tolerance(line, fault):
    out = run(f"G1 X100 Y100 Z100\n{line}\n")
    assert [e[1] for e in out.errors] == ([] if fault is None else [fault])
    assert len(out.moves) == (2 if fault is None else 1)
