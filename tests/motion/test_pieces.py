"""The seam: polynomials of time through the step solver, on every geometry, against 40 digits."""

from __future__ import annotations

from itertools import pairwise
from math import comb
from random import Random

import pytest
from tests.geometry.test_kernels import CASES
from tests.geometry.test_kernels import machine as kernel
from tests.oracles import motion as oracle
from tests.oracles import pieces
from tests.support.link_bench import Bench, Planner, executed

from passo import _core
from passo._core import Motion

from .machines import cartesian

HZ = 16e6


def machine(name):
    """A machine of that geometry, 40 steps a mm or degree, and the middle of what it reaches."""
    model, _, low, high = kernel(name)
    spec = cartesian() | {"geometry": model.spec()}
    for stepper in spec["steppers"][:3]:
        stepper["steps_per_unit"] = 40.0
    return model, spec, [(a + b) / 2 for a, b in zip(low, high, strict=True)]


def bezier(points, seconds):
    """Coefficients by powers of t of the Bezier curve of degree 5 with these six points."""
    rows = []
    for axis in zip(*points, strict=True):
        rows.append(
            [
                sum((-1) ** (k - i) * comb(k, i) * axis[i] for i in range(k + 1))
                * comb(5, k)
                / seconds**k
                for k in range(6)
            ]
        )
    return rows


def curve(random, middle, size, seconds):
    points = [[c + random.uniform(-size, size) for c in middle] for _ in range(6)]
    return bezier([[*p, random.uniform(-1, 1)] for p in points], seconds)


def position(model, spec, stepper, rows):
    """The true position of a motor."""
    if stepper == 3:
        return pieces.polynomial(rows[3])
    kind = spec["geometry"]["kind"]
    if kind == "delta":
        return pieces.tower(*model.towers[stepper], model.rods[stepper], rows)
    if kind == "cartesian" or kind.startswith("core"):
        unit = [model.inverse(e) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        return pieces.linear([u[stepper] for u in unit], rows[:3])
    return pieces.actuator(model.inverse, stepper, rows)


@pytest.mark.parametrize("name", [name for name in CASES if name != "none"])
def test_each_step_is_where_the_curve_crosses(name):
    model, spec, middle = machine(name)
    motion, random, seconds = Motion(spec), Random(name), 0.25
    checked = 0
    for _ in range(2):
        rows = curve(random, middle, 3.0, seconds)
        for i, row in enumerate(spec["steppers"]):
            true = position(model, spec, i, rows)
            steps, margin = pieces.step_times(true, seconds, row["steps_per_unit"])
            if margin < 1e-6:
                continue
            begin = round(float(true(0)) * row["steps_per_unit"])
            ticks, count = motion.ideal_piece_ticks(seconds, rows, i, begin)
            assert len(ticks) == len(steps)
            assert count - begin == sum(way for _, way in steps)
            for tick, (t, _) in zip(ticks, steps, strict=True):
                assert tick == pytest.approx(float(t) * HZ, abs=2e-3)
            checked += len(steps)
    assert checked > 200


def pieces_of(move):
    """The phases of a planned move as polynomials: p0 + u (s + v t + ½ a t²)."""
    unit = [(b - a) / move.length for a, b in zip(move.start_mm, move.end_mm, strict=True)]
    unit, start = [unit[i] for i in (0, 1, 2, 3)], [move.start_mm[i] for i in (0, 1, 2, 3)]
    s = 0.0
    phases = (
        (move.accelerate_ticks, move.start_speed, move.acceleration),
        (move.cruise_ticks, move.cruise_speed, 0.0),
        (move.decelerate_ticks, move.cruise_speed, -move.deceleration),
    )
    for ticks, v, a in phases:
        if ticks > 0:
            t = ticks / HZ
            yield t, [[p + u * s, u * v, u * a / 2] for p, u in zip(start, unit, strict=True)]
            s += v * t + 0.5 * a * t * t


@pytest.mark.parametrize("name", CASES)
def test_a_move_and_its_phases_make_the_same_steps(name):
    _, spec, middle = machine(name)
    random = Random(name)
    moves_way, pieces_way = Motion(spec), Motion(spec)
    start = [*middle, 0.0]
    for motion in (moves_way, pieces_way):
        motion.set_position(start)
    begin = moves_way.counts()
    for i in range(4):
        moves_way.push([c + random.uniform(-4, 4) for c in middle] + [0.3 * i], 60.0, "print")
    moves_way.flush()
    moves = moves_way.take_moves()
    list_of_pieces = [piece for move in moves for piece in pieces_of(move)]
    pieces_way.add_pieces(list_of_pieces, [moves[-1].end_mm[i] for i in range(4)])
    pieces_way.flush()
    assert pieces_way.counts() == moves_way.counts()
    assert pieces_way.clock == pytest.approx(moves_way.clock, abs=1e-3)
    messages = pieces_way.take_messages()
    for i, count in enumerate(begin):
        ideal, here = [], count
        for move in moves:
            ticks, after = moves_way.ideal_ticks(move, i, here)
            way = 1 if after > here else -1
            ideal += [(t, way) for t in ticks]
            here = after
        done = oracle.executed_ticks(messages, i)
        assert sum(way for _, way in done) == moves_way.counts()[i] - count
        if len(done) == len(ideal):
            for (t, _), (wanted, _) in zip(done, ideal, strict=True):
                assert abs(t - wanted) <= 32.5 + 1e-2


def rest_to_rest(a, b, seconds):
    """From rest to rest with the least jerk: 10 τ³ - 15 τ⁴ + 6 τ⁵."""
    return [
        [
            p,
            0.0,
            0.0,
            10 * (q - p) / seconds**3,
            -15 * (q - p) / seconds**4,
            6 * (q - p) / seconds**5,
        ]
        for p, q in zip(a, b, strict=True)
    ]


def journey(points, seconds):
    return [(seconds, rest_to_rest(a, b, seconds)) for a, b in pairwise(points)]


POINTS = [
    [0.0, 0.0, 0.0, 0.0],
    [10.0, 3.0, 0.0, 0.5],
    [10.0, 3.0, 0.2, -1.5],
    [4.0, -6.0, 0.2, 1.1],
    [0.005, 0.0, 0.0, 1.1],
]


def test_turns_and_standing_still_keep_the_step_bound():
    motion = Motion(cartesian())
    motion.add_pieces(journey(POINTS, 0.4))
    motion.flush()
    messages = motion.take_messages()
    for i, (row, per_mm) in enumerate(zip("xyze", (80.0, 80.0, 400.0, 95.5), strict=True)):
        ideal = []
        for n, (seconds, rows) in enumerate(journey(POINTS, 0.4)):
            steps, _ = pieces.step_times(pieces.polynomial(rows[i]), seconds, per_mm)
            ideal += [((n * seconds + float(t)) * HZ, way) for t, way in steps]
        assert motion.dropped_pairs(i) == 0, row
        oracle.assert_within_bound(oracle.executed_ticks(messages, i), ideal)
    assert motion.counts() == [0, 0, 0, 105]


def test_the_board_executes_pieces_between_moves():
    motion, bench = Motion(cartesian()), Bench()
    motion.push([2.0, 1.0, 0.0, 0.0], 50.0)
    plane = [[2.0, 1.0, 0.0, 0.0], [9.0, -4.0, 0.0, 0.0], [3.0, 5.0, 0.0, 0.0]]
    motion.add_pieces(journey(plane, 0.3))
    motion.push([-1.0, 7.5, 0.0, 0.0], 80.0)
    motion.flush()
    counts, messages = motion.counts(), motion.take_messages()
    plan, kinds = Planner(), _core.MessageKind
    for kind, target, clock, end, interval, count, add, forward in messages:
        plan.queue.push(
            getattr(kinds, kind.upper()),
            target,
            clock,
            end,
            interval,
            count,
            add,
            bool(forward),
        )
    for name in ("x", "y"):
        bench.simulated.trace_steps(name, 0, 2**62)
    base = bench.connection.start_job(plan.queue)
    bench.run(4.0)
    for i, name in enumerate(("x", "y")):
        clocks, ways = executed(bench, name, base)
        assert list(zip(clocks, ways, strict=True)) == oracle.executed_ticks(messages, i)
        assert sum(ways) == counts[i] == (-80, 600)[i]


def test_pieces_do_not_depend_on_how_they_arrive():
    whole, one_by_one = Motion(cartesian()), Motion(cartesian())
    whole.add_pieces(journey(POINTS, 0.3))
    whole.flush()
    taken = []
    for piece in journey(POINTS, 0.3):
        one_by_one.add_pieces([piece])
        taken += one_by_one.take_messages(one_by_one.clock - 0.2 * HZ)
    one_by_one.flush()
    assert taken + one_by_one.take_messages() == whole.take_messages()


def test_records_and_cuts_move_to_the_end_of_pieces():
    motion = Motion(cartesian())
    motion.record(5, 1)
    motion.add_pieces(journey(POINTS[:2], 0.5))
    motion.record(6, 1)
    end = motion.clock
    assert end == 0.5 * HZ
    motion.push([50.0, 3.0, 0.0, 0.5], 100.0)
    motion.flush()
    after = motion.clock
    assert motion.hold_from(0.1 * HZ) == end
    assert motion.clock == end
    motion.release()
    motion.flush()
    assert motion.clock == pytest.approx(after, abs=2)
    assert motion.counts() == [4000, 240, 0, 48]
    pins = [(m[1], m[2]) for m in motion.take_messages() if m[0] == "pin"]
    assert pins == [(5, 0), (6, end)]


BAD = {
    "a gap": ([(1.0, [[0.1], [0.0], [0.0], [0.0]])], None, "does not start where"),
    "a gap within": (
        [(1.0, [[0.0, 1.0], [0.0], [0.0], [0.0]]), (1.0, [[1.1], [0.0], [0.0], [0.0]])],
        None,
        "does not end where",
    ),
    "another end": ([(1.0, [[0.0, 1.0], [0.0], [0.0], [0.0]])], [2.0, 0, 0, 0], "does not end"),
    "no time": ([(0.0, [[0.0], [0.0], [0.0], [0.0]])], None, "a time above 0"),
    "not a number": ([(1.0, [[0.0, float("nan")], [0.0], [0.0], [0.0]])], None, "does not end"),
    "an axis too few": ([(1.0, [[0.0], [0.0], [0.0]])], None, "one row of coefficients an axis"),
    "a degree too high": ([(1.0, [[0.0] * 7, [0.0], [0.0], [0.0]])], None, "1 to 6"),
}


@pytest.mark.parametrize("name", BAD)
def test_pieces_that_do_not_join_are_refused(name):
    list_of_pieces, end, words = BAD[name]
    motion = Motion(cartesian())
    with pytest.raises(ValueError, match=words):
        motion.add_pieces(list_of_pieces, end)
    motion.flush()
    assert motion.clock == 0
    assert motion.take_messages() == []


def test_a_piece_beyond_the_reach_is_refused():
    _, spec, middle = machine("delta")
    motion = Motion(spec)
    start = [*middle, 0.0]
    motion.set_position(start)
    with pytest.raises(ValueError, match="reach of stepper x"):
        motion.add_pieces([(2.0, [[start[0], 160.0, -80.0], [start[1]], [start[2]], [0.0]])])
    assert motion.clock == 0


def test_a_piece_too_fast_for_a_motor_is_refused():
    motion = Motion(cartesian())
    with pytest.raises(ValueError, match="too fast for stepper y"):
        motion.add_pieces([(0.01, [[0.0], [0.0, 7000.0], [0.0], [0.0]])])
    motion.add_pieces([(0.01, [[0.0], [0.0, 6000.0], [0.0], [0.0]])])
    motion.flush()
    assert motion.counts() == [0, 4800, 0, 0]
