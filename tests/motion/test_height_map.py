"""Heights of the bed: Z goes along with them, on every geometry that lifts the nozzle."""

from __future__ import annotations

from decimal import Decimal
from itertools import pairwise
from math import floor
from random import Random

import pytest
from tests.oracles import motion as oracle
from tests.oracles import pieces

from passo._core import Motion

from .machines import cartesian
from .test_pieces import HZ, journey, machine, pieces_of

FIRST, SPACING = (-20.0, -15.0), (13.0, 9.5)
HEIGHTS = [[0.31, -0.22, 0.05, 0.4], [-0.1, 0.27, -0.35, 0.12], [0.2, 0.02, 0.33, -0.41]]


def height(x, y):
    """Bilinear within the grid, its nearest edge beyond."""
    x, y = Decimal(x), Decimal(y)
    place = []
    for at, first, step, n in ((x, FIRST[0], SPACING[0], 4), (y, FIRST[1], SPACING[1], 3)):
        share = min(max((at - Decimal(first)) / Decimal(step), Decimal(0)), Decimal(n - 1))
        cell = min(floor(share), n - 2)
        place.append((cell, share - cell))
    (i, u), (j, v) = place
    a, b, c, d = (Decimal(HEIGHTS[j + m][i + n]) for m in (0, 1) for n in (0, 1))
    return a * (1 - u) * (1 - v) + b * u * (1 - v) + c * (1 - u) * v + d * u * v


def lift(x, y, z, fade):
    """What is added to Z; less from the start of a fade on, and its target alone from its end."""
    c = height(x, y)
    if fade is None:
        return c
    start, end, target = map(Decimal, fade)
    return target + min(max((end - z) / (end - start), Decimal(0)), Decimal(1)) * (c - target)


def raised(model, spec, stepper, rows, fade=None):
    """The true position of a motor above the bed."""
    x, y, z = (pieces.polynomial(row) for row in rows[:3])
    kind = spec["geometry"]["kind"]

    def at(t):
        px, py = x(t), y(t)
        return px, py, z(t) + lift(px, py, z(t), fade)

    if kind == "delta":
        tower, rod = [Decimal(c) for c in model.towers[stepper]], Decimal(model.rods[stepper])

        def position(t):
            px, py, pz = at(t)
            return pz + (rod**2 - (tower[0] - px) ** 2 - (tower[1] - py) ** 2).sqrt()

    elif kind == "cartesian" or kind.startswith("core"):
        unit = [Decimal(model.inverse(e)[stepper]) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]

        def position(t):
            return sum((u * p for u, p in zip(unit, at(t), strict=True)), Decimal(0))

    else:

        def position(t):
            return Decimal(model.inverse(tuple(float(p) for p in at(t)))[stepper])

    return position


MACHINES = ["cartesian", "corexz", "delta", "rotary_delta", "scara"]


def above(name, fade=None):
    """A machine with the heights under the middle of what it reaches."""
    model, spec, middle = machine(name)
    if name == "scara":  # the heights are around the origin: so shall its middle be
        model = model.model_copy(update={"y_offset": model.y_offset - middle[1]})
        spec["geometry"], middle[1] = model.spec(), 0.0
    motion = Motion(spec)
    motion.set_position([*middle, 0.0])
    if fade is not None:
        fade = (middle[2] + fade[0], middle[2] + fade[1], fade[2])
    motion.set_height_map(FIRST, SPACING, HEIGHTS, fade)
    return model, spec, middle, motion, fade


def expected(model, spec, stepper, moves, fade):
    """(tick, direction) of each step of a motor, and the nearest that any came to a threshold."""
    steps, margin = [], 1.0
    for move in moves:
        start = move.start_ticks
        for seconds, rows in pieces_of(move):
            position = (
                pieces.polynomial(rows[3])
                if stepper == 3
                else raised(model, spec, stepper, rows, fade)
            )
            found, near = pieces.step_times(
                position, seconds, spec["steppers"][stepper]["steps_per_unit"]
            )
            steps += [(start + float(t) * HZ, way) for t, way in found]
            margin = min(margin, near)
            start += seconds * HZ
    return steps, margin


@pytest.mark.parametrize("name", MACHINES)
def test_each_step_follows_the_bed(name):
    assert_each_step(name, None, (0, 0.1))


@pytest.mark.parametrize("name", ["cartesian", "corexz", "delta"])
def test_each_step_follows_a_bed_that_fades(name):
    """A layer within the fade, then up through its end."""
    assert_each_step(name, (0.1, 0.9, 0.05), (0.5, 0.5, 1.2))


def assert_each_step(name, fade, rises):
    model, spec, middle, motion, fade = above(name, fade)
    random = Random(name + "+")
    counts = motion.counts()
    z = middle[2]
    for i, rise in enumerate(rises):
        target = [random.uniform(-18, 18), random.uniform(-13, 13), z + rise]
        motion.push([*target, 0.2 * i], 120.0, "print")
    motion.flush()
    moves, messages = motion.take_moves(), motion.take_messages()
    for i in range(3):
        steps, margin = expected(model, spec, i, moves, fade)
        here, ticks = counts[i], []
        for move in moves:
            found, here = motion.ideal_ticks(move, i, here)
            ticks += found
        if margin > 1e-6:
            assert len(ticks) == len(steps)
            for tick, (wanted, _) in zip(ticks, steps, strict=True):
                assert tick == pytest.approx(wanted, abs=2e-2)
            if motion.dropped_pairs(i) == 0:
                oracle.assert_within_bound(oracle.executed_ticks(messages, i), steps)
        end = raised(model, spec, i, [[c] for c in moves[-1].end_mm], fade)(Decimal(0))
        per_unit = spec["steppers"][i]["steps_per_unit"]
        assert motion.counts()[i] == here == floor(float(end) * per_unit + 0.5)


def test_a_plane_is_the_path_raised_by_it():
    """With c = 0.01 + 0.02 x - 0.015 y, the corrected path is a polynomial again."""
    points = [
        [0.0, 0.0, 0.2, 0.0],
        [15.0, 4.0, 0.2, 0.5],
        [3.0, -9.0, 0.4, 1.0],
        [0.0, 0.0, 0.2, 0.0],
    ]

    def c(x, y):
        return 0.01 + 0.02 * x - 0.015 * y

    bent, flat = Motion(cartesian()), Motion(cartesian())
    bent.set_position(points[0])
    counts = bent.counts()
    grid = [[c(-20 + 40 * i, -20 + 40 * j) for i in (0, 1)] for j in (0, 1)]
    bent.set_height_map((-20.0, -20.0), (40.0, 40.0), grid)
    assert bent.counts() == counts
    # No motor moved: Z of the plan is now lower by c(0, 0) = 0.01.
    points = [[x, y, z - 0.01, e] for x, y, z, e in points]
    lifted = [[x, y, z + c(x, y), e] for x, y, z, e in points]
    flat.set_position(lifted[0])
    bent.add_pieces(journey(points, 0.5), points[-1])
    flat.add_pieces(journey(lifted, 0.5), lifted[-1])
    for motion in (bent, flat):
        motion.flush()
    assert bent.counts() == flat.counts()
    ours, theirs = (oracle.executed_ticks(m.take_messages(), 2) for m in (bent, flat))
    assert len(ours) == len(theirs) > 100
    for (t, way), (wanted, goes) in zip(ours, theirs, strict=True):
        assert way == goes
        assert abs(t - wanted) <= 65


def test_z_speed_stays_within_limit_above_a_steep_bed():
    motion = Motion(cartesian())
    steep = [[0.0, 3.0, 0.0, 3.0], [0.0, 3.0, 0.0, 3.0]]
    motion.set_height_map((0.0, 0.0), (10.0, 10.0), steep)
    motion.push([30.0, 0.0, 0.0, 0.0], 300.0)
    motion.flush()
    (move,) = motion.take_moves()
    assert move.speed_cap == pytest.approx(12.0 / 0.3)
    ticks = [t for t, _ in oracle.executed_ticks(motion.take_messages(), 2)]
    assert len(ticks) == 3 * 1200
    assert min(b - a for a, b in pairwise(ticks)) >= HZ / (12.0 * 400.0) - 65


@pytest.mark.parametrize("seed", range(4))
def test_a_cut_above_the_bed_loses_nothing(seed):
    random, motion = Random(seed), Motion(cartesian())
    motion.set_position([0.0, 0.0, 1.0, 0.0])
    begin = motion.counts()
    motion.set_height_map(FIRST, SPACING, HEIGHTS)
    for _ in range(6):
        motion.push([random.uniform(-30, 30), random.uniform(-20, 20), 1.0, 0.0], 200.0)
        motion.flush()
        motion.hold_from(motion.clock * random.uniform(0.8, 1.0))
        motion.release()
        motion.flush()
    moves, messages = motion.take_moves(), motion.take_messages()
    x, y, z = moves[-1].end_mm[:3]
    lift = floor((z + float(height(x, y))) * 400 + 0.5)
    assert motion.counts() == [floor(x * 80 + 0.5), floor(y * 80 + 0.5), lift, 0]
    for i, count in enumerate(motion.counts()):
        net = sum(way for _, way in oracle.executed_ticks(messages, i))
        assert net == count - begin[i]


def test_removing_the_height_map_moves_no_motor():
    motion, plain = Motion(cartesian()), Motion(cartesian())
    motion.set_height_map(FIRST, SPACING, HEIGHTS)
    motion.set_height_map((0, 0), (1, 1), [])
    for m in (motion, plain):
        m.push([7.0, 8.0, 0.3, 0.2], 100.0)
        m.flush()
    assert motion.take_messages() == plain.take_messages()


@pytest.mark.parametrize(("rise", "z"), [(0.05, -0.35), (1.8, 1.5), (6.0, 5.8)])
def test_map_with_fade_moves_no_motor(rise, z):
    """At (10, 0) the bed is at 0.4; the fade goes from 1 to 2, where 0.2 is added everywhere:
    within it the nozzle is at 0.2 + z + 0.2 (2 - z) = 0.6 + 0.8 z, above it at 0.2 + z."""
    motion = Motion(cartesian())
    motion.set_position([10.0, 0.0, rise, 0.0])
    motion.set_height_map((0.0, 0.0), (10.0, 10.0), [[0.0, 0.4], [0.0, 0.4]], (1.0, 2.0, 0.2))
    before = motion.counts()
    assert before[2] == floor(rise * 400 + 0.5)
    motion.push([10.0, 5.0, z, 0.0], 100.0)
    motion.flush()
    assert motion.take_moves()[-1].start_mm[2] == pytest.approx(z, abs=1e-12)


def test_fade_limits_the_speed_of_z():
    """Z rises by 0.9 of the program's Z where the fade adds -0.1 a mm at most, or by 1.1."""
    motion = Motion(cartesian())
    heights = [[-0.1, 0.1], [-0.1, 0.1]]
    motion.set_height_map((0.0, 0.0), (10.0, 10.0), heights, (0.0, 1.0, 0.0))
    motion.push([0.0, 0.0, 1.0, 0.0], 300.0)
    motion.flush()
    assert motion.take_moves()[-1].speed_cap == pytest.approx(12.0 / 1.1)


BAD = {
    "one row": ([[0.0, 1.0]], (1.0, 1.0), "two rows of two"),
    "uneven rows": ([[0.0, 1.0], [0.0]], (1.0, 1.0), "differ in length"),
    "no number": ([[0.0, float("nan")], [0.0, 0.0]], (1.0, 1.0), "beyond 1000 mm"),
    "no spacing": ([[0.0, 0.0], [0.0, 0.0]], (0.0, 1.0), "a spacing above 0"),
}


@pytest.mark.parametrize("name", BAD)
def test_heights_that_make_no_grid_are_refused(name):
    heights, spacing, words = BAD[name]
    motion = Motion(cartesian())
    with pytest.raises(ValueError, match=words):
        motion.set_height_map((0.0, 0.0), spacing, heights)
    motion.push([1.0, 0.0, 0.0, 0.0], 10.0)
    motion.flush()
    assert motion.counts() == [80, 0, 0, 0]


def test_a_fade_shorter_than_the_heights_is_refused():
    motion = Motion(cartesian())
    with pytest.raises(ValueError, match="a fade must be longer than the heights differ"):
        motion.set_height_map(FIRST, SPACING, HEIGHTS, (1.0, 1.41, 0.0))
    motion.set_height_map(FIRST, SPACING, HEIGHTS, (1.0, 1.4101, 0.0))


@pytest.mark.parametrize("x", [-30.0, -15.5, 40.0])
@pytest.mark.parametrize("y", [-35.0, -11.25, 30.0])
def test_beyond_the_grid_its_edge_continues_level(x, y):
    motion = Motion(cartesian())
    motion.set_position([0.0, 0.0, 1.0, 0.0])
    motion.set_height_map(FIRST, SPACING, HEIGHTS)
    motion.push([x, y, 1.0, 0.0], 200.0)
    motion.flush()
    (z,) = {move.end_mm[2] for move in motion.take_moves()}
    assert motion.counts()[2] == floor((z + float(height(x, y))) * 400 + 0.5)
