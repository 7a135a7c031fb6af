"""Properties of plans and of what the board executes, against the plain oracle."""

from __future__ import annotations

import itertools
from math import floor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import motion as oracle

from passo._core import Motion

from . import machines
from .machines import cartesian

STEPS_PER_MM = {0: 80.0, 1: 80.0, 2: 400.0, 3: 95.5}

coordinate = st.integers(-4000, 4000).map(lambda n: n / 1000)
step = st.tuples(
    coordinate, coordinate, st.sampled_from([0, 0, 0, 0.2, -0.1]), coordinate, st.integers(1, 200)
)
paths = st.lists(step, min_size=1, max_size=12)


def run(path, spec=None, with_steps=True):
    motion = Motion(spec or cartesian(), with_steps)
    at = [0.0, 0.0, 0.0, 0.0]
    for dx, dy, dz, de, feed in path:
        at = [a + d for a, d in zip(at, (dx, dy, dz, de / 20), strict=True)]
        kind = "print" if dx or dy or dz else "extrude"
        motion.push(at, float(feed), kind)
    motion.flush()
    return motion, motion.take_moves(), at


@given(paths)
@settings(max_examples=60, deadline=None)
def test_plans_obey_every_limit(path):
    spec = cartesian()
    _, moves, _ = run(path, with_steps=False)
    oracle.assert_trapezoids(moves)
    for m in moves:
        for slot, row in [
            (0, spec["axes"][0]),
            (1, spec["axes"][1]),
            (2, spec["axes"][2]),
            (3, spec["extruders"][0]),
        ]:
            part = abs(m.end_mm[slot] - m.start_mm[slot]) / m.length
            assert part * m.cruise_speed <= row["speed"] * (1 + 1e-9)
            assert part * max(abs(m.acceleration), m.deceleration) <= row["accel"] * (1 + 1e-9)
    for before, after in itertools.pairwise(moves):
        if before.kind == after.kind == "print" and after.start_cap > 0:
            cap = oracle.junction_deviation_cap(before, after, 0.02)
            change = abs(slope(after) - slope(before))
            if change > 1e-12:
                cap = min(cap, 1.0 / change)
            assert abs(after.start_cap - cap) < 1e-6 * max(cap, 1.0)


def slope(move):
    return (move.end_mm[3] - move.start_mm[3]) / move.length


@given(paths)
@settings(max_examples=40, deadline=None)
def test_every_step_is_within_the_bound(path):
    motion, moves, end = run(path)
    messages = motion.take_messages()
    clocks = [m[2] for m in messages]
    assert clocks == sorted(clocks)
    for axis, per_mm in STEPS_PER_MM.items():
        ideal = [step for m in moves for step in oracle.crossing_ticks(m, axis, per_mm)]
        for _ in range(motion.dropped_pairs(axis)):
            drop_closest_reversal(ideal)
        executed = oracle.executed_ticks(messages, axis)
        oracle.assert_within_bound(executed, ideal)
        pulses = 2e-6 * oracle.HZ  # and the pause behind it: of steps of either direction
        assert all(b[0] - a[0] >= pulses for a, b in itertools.pairwise(executed))
        assert sum(d for _, d in executed) == floor(end[axis] * per_mm + 0.5)
        assert motion.counts()[axis] == floor(end[axis] * per_mm + 0.5)


def test_fast_steps_keep_to_a_quarter_of_their_gap():
    """160 kHz: 100 ticks from step to step, of which a quarter is less than the 2 µs."""
    spec = cartesian(print_accel=1e6, travel_accel=1e6)
    spec["axes"][0] = machines.axis("X", accel=1e6)
    spec["steppers"][0] = machines.stepper("x", "actuator", 0, 1600.0)
    motion = Motion(spec, True)
    motion.push([1.0, 0, 0, 0], 100.0)
    motion.flush()
    (move,) = motion.take_moves()
    assert move.cruise_speed == 100.0
    ideal = list(oracle.crossing_ticks(move, 0, 1600.0))
    oracle.assert_within_bound(oracle.executed_ticks(motion.take_messages(), 0), ideal)


def drop_closest_reversal(steps):
    gaps = [(b[0] - a[0], i) for i, (a, b) in enumerate(itertools.pairwise(steps)) if a[1] != b[1]]
    gap, i = min(gaps)
    assert gap < 2e-6 * oracle.HZ + 3
    del steps[i : i + 2]


@pytest.mark.parametrize(("beyond", "pairs"), [(6e-6, 1), (1e-5, 0)])
def test_a_reversal_too_close_for_the_driver_is_removed_in_pairs(beyond, pairs):
    """31 ticks from the step to its opposite, or 52; two pulses of 1 µs want 32."""
    motion = Motion(cartesian(junction="jerk"), True)
    motion.push([0.00625 + beyond, 0, 0, 0], 100.0)
    motion.push([0.0, 0, 0, 0], 100.0)
    motion.flush()
    executed = oracle.executed_ticks(motion.take_messages(), 0)
    assert motion.dropped_pairs(0) == pairs
    assert [way for _, way in executed] == [1, -1] * (1 - pairs)
    assert all(b[0] - a[0] >= 32 for a, b in itertools.pairwise(executed))


def test_long_gaps_set_the_clock_again():
    motion = Motion(cartesian(), True)
    motion.push([1, 0, 0, 0], 50.0)
    motion.push([1, 0, 0, 0], 50.0, "dwell", duration_s=300.0)
    motion.push([2, 0, 0, 0], 50.0)
    motion.flush()
    messages = motion.take_messages()
    assert [m[0] for m in messages].count("reset_clock") == 1
    executed = oracle.executed_ticks(messages, 0)
    ideal = [t for m in motion.take_moves() for t in oracle.crossing_ticks(m, 0, 80.0)]
    oracle.assert_within_bound(executed, ideal)


def test_records_are_due_at_their_boundary():
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.record(3, 128)
    motion.push([20, 0, 0, 0], 50.0)
    motion.record(3, 0)
    motion.flush()
    moves = motion.take_moves()
    pins = oracle.pins(motion.take_messages())
    assert pins == [(round(moves[1].start_ticks), 128), (round(moves[1].end_ticks), 0)]
    assert moves[0].end_speed == moves[1].start_speed == 50.0


@given(paths, st.integers(1, 5))
@settings(max_examples=20, deadline=None)
def test_the_stream_does_not_depend_on_when_messages_are_taken(path, every):
    whole, _, _ = run(path * 8)
    expected = whole.take_messages()
    motion = Motion(cartesian(), True)
    got, at = [], [0.0, 0.0, 0.0, 0.0]
    for i, (dx, dy, dz, de, feed) in enumerate(path * 8):
        at = [a + d for a, d in zip(at, (dx, dy, dz, de / 20), strict=True)]
        motion.push(at, float(feed), "print" if dx or dy or dz else "extrude")
        if i % every == 0:
            got += motion.take_messages()
    motion.flush()
    assert got + motion.take_messages() == expected


def test_moves_are_settled_as_they_come():
    """With each 256 that have come all are settled whose beginning has its final speed."""
    motion = Motion(cartesian(), False)
    settled = []
    for i in range(1024):
        motion.push([0.5 * (i % 2), 0.5 * i + 0.5, 0, 0], 50.0)
        settled += motion.take_moves()
        assert len(settled) >= (i + 1) // 256 * 256 - 2
        if (i + 1) % 256:
            assert len(settled) <= (i + 1) // 256 * 256


def test_half_of_an_accelerating_plan_is_settled():
    """At 8192 moves, so that no file fills the memory."""
    motion = Motion(cartesian(), False)
    for i in range(8448):
        assert motion.take_moves() == []
        motion.push([0.001 * (i + 1), 0, 0, 0], 300.0)
    settled = motion.take_moves()
    assert len(settled) == 4224
    motion.flush()
    moves = settled + motion.take_moves()
    oracle.assert_trapezoids(moves)
    assert moves[-1].end_ticks == pytest.approx(2 * (8.448 / 3000) ** 0.5 * oracle.HZ, rel=1e-3)
