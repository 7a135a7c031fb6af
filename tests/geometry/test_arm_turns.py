"""Arms that turn about a shoulder: wherever the bed lies their angles go on over all of it, and
where they end a line is refused."""

from __future__ import annotations

import itertools
from math import cos, inf, radians, sin

import pytest
from tests.oracles import kinematics

from passo import Machine, config
from passo._core import Geometry
from passo.config.load import shipped_text
from passo.errors import InputError
from passo.geometry.dual_scara import DualScara

LIMITS = ("min_deg = -60.0\nmax_deg = 120.0", "min_deg = 60.0\nmax_deg = 250.0")


def arms(x, y, limits=("", ""), arm2=150.0, home=(-60.0, 60.0)):
    """The shipped SCARA, bed of 200 x 200 mm, the shoulder at x, y on it."""
    changes = {
        "arm2 = 150.0": f"arm2 = {arm2}",
        "x_offset = 100.0": f"x_offset = {x}",
        "y_offset = -56.0": f"y_offset = {y}",
        **dict(zip(LIMITS, limits, strict=True)),
        "position = -60.0": f"position = {home[0]}",
        "position = 60.0": f"position = {home[1]}",
    }
    text = shipped_text("scara")
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    return config.load_text(text)


def angles_over(geometry, xs, ys):
    """Both angles at these places, by an oracle and by the core, row by row."""
    core = Geometry(geometry.spec())
    for y in ys:
        row = []
        for x in xs:
            point = (float(x), float(y), 0.0)
            a, b, _ = kinematics.inverse(geometry, point)
            assert (core.inverse(0, point), core.inverse(1, point)) == pytest.approx((a, b))
            row.append((a, b))
        yield row


BED = range(0, 201, 10)


def assert_goes_on(rows):
    rows = list(rows)
    for line in [*rows, *zip(*rows, strict=True)]:
        for before, after in itertools.pairwise(line):
            assert all(abs(p - q) < 20 for p, q in zip(before, after, strict=True))


@pytest.mark.parametrize("towards", range(0, 360, 15))
def test_angles_are_continuous_over_all_of_the_bed(towards):
    away = 156.0
    x, y = 100 - away * cos(radians(towards)), 100 - away * sin(radians(towards))
    assert_goes_on(angles_over(arms(x, y).geometry, BED, BED))


def test_angles_of_two_shoulders_are_continuous_below_them():
    lengths = {"proximal1": 150.0, "proximal2": 150.0, "distal1": 100.0, "distal2": 100.0}
    below = DualScara(kind="dual_scara", **lengths).facing((0.0, -100.0, 0.0), [(-inf, inf)] * 3)
    assert_goes_on(angles_over(below, range(-100, 101, 5), range(-150, -59, 5)))


@pytest.mark.parametrize("y", [99.0, 100.0, 101.0])
@pytest.mark.parametrize("turn", [0, -360])
def test_angles_lie_within_the_limits_of_their_motors(y, turn):
    between = (50 + turn, 180 + turn), (180 + turn, 310 + turn)
    machine = arms(256.0, y, [f"min_deg = {low}.0\nmax_deg = {high}.0" for low, high in between])
    for row in angles_over(machine.geometry, BED, BED):
        for angles in row:
            assert all(low <= q <= high for q, (low, high) in zip(angles, between, strict=True))


def planned(tmp_path, machine, *lines):
    path = tmp_path / "a.gcode"
    path.write_text("\n".join(lines))
    return list(Machine(machine).plan(path))


# Their program begins at home, on the right of the shoulder.
AROUND = ("G1 X200 Y180 F6000", "G1 X60 Y180")


def test_line_left_of_a_shoulder_keeps_its_feedrate(tmp_path):
    machine = arms(256.0, 100.0, home=(90.0, 180.0))
    moves = planned(tmp_path, machine, "G1 X100 Y101 F600", "G1 X100 Y99")
    assert moves[-1].end_s - moves[-1].start_s == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize(
    ("start", "end", "place"),
    [
        ("X60 Y90", "X140 Y90", "X 100.000, Y 90.000"),
        ("X95 Y90", "X110 Y96", "X 100.000, Y 92.000"),
        ("X60 Y99.96", "X140 Y99.96", "X 100.000, Y 99.960"),
        ("X60 Y101", "X110 Y80", "X 100.000, Y 84.200"),
    ],
)
def test_a_line_behind_a_shoulder_is_refused(tmp_path, start, end, place):
    machine = arms(100.0, 99.99)
    before, behind = f"G1 {start} Z1 F600", f"G1 {end}"
    with pytest.raises(InputError) as error:
        planned(tmp_path, machine, *AROUND, before, behind)
    (problem,) = error.value.problems
    assert (problem.line, problem.code) == (4, "input.unreachable")
    assert f"the point {place}, Z 1.000 mm cannot be reached" in problem.sentence
    assert "behind the shoulder at X 100, Y 99.99 its arms would have to turn back" in str(
        error.value
    )
    assert planned(tmp_path, machine, *AROUND, before, "G1 Y110", f"G1 {end[:4]} Y110", behind)


@pytest.mark.parametrize(
    ("arm2", "y", "nearest"), [(150.0, 99.995, "0.010"), (149.8, 100.18, "0.210")]
)
def test_a_line_over_a_shoulder_is_refused(tmp_path, arm2, y, nearest):
    with pytest.raises(InputError) as error:
        over = f"G1 X61 Y{y} F600", f"G1 X139.3 Y{y}"
        planned(tmp_path, arms(100.0, 99.99, arm2=arm2), *AROUND, *over)
    assert error.value.problems[0].line == 4
    assert f"the arms reach from {nearest} to" in str(error.value)


def test_arms_are_never_quite_stretched(tmp_path):
    machine = arms(100.0, -100.0)
    with pytest.raises(InputError) as error:
        planned(tmp_path, machine, "G1 X100 Y150 F6000", "G1 X100 Y199.995")
    assert "to 299.990 mm from the shoulder, not 299.995 mm" in str(error.value)
    moves = planned(tmp_path, machine, "G1 X100 Y150 F6000", "G1 X100 Y199.98", "G1 X100 Y150")
    assert moves[-1].end_s < 15
