"""Deltas and arms: each step where the plain inverse wants it, no motor beyond its limits."""

from __future__ import annotations

from bisect import bisect_left
from itertools import pairwise
from math import atan2, cos, degrees, floor, inf, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import motion as oracle

from passo._core import Motion

from .machines import REACH, joints, nonlinear

share = st.integers(-1000, 1000).map(lambda n: n / 1000)
point = st.tuples(share, share, share)  # of half the box that a machine reaches
paths = st.lists(st.tuples(point, st.integers(5, 250)), min_size=1, max_size=5)


def in_the_middle(name, with_steps=True):
    """A motion of one of REACH, the nozzle in the middle; its machine and its plain geometry."""
    spec, geometry = nonlinear(name)
    motion = Motion(spec, with_steps)
    motion.set_position([*map(float, REACH[name][0]), 0.0])
    return motion, spec, geometry


def push_shares(motion, name, path):
    centre, half = REACH[name]
    for where, feed in path:
        target = [c + h * s for c, h, s in zip(centre, half, where, strict=True)]
        motion.push([*target, 0.0], float(feed))


def nozzle(move, tick):
    s = oracle.position_at(move, tick) / move.length
    return tuple(a + (b - a) * s for a, b in zip(move.start_mm[:3], move.end_mm[:3], strict=True))


@pytest.mark.parametrize("name", REACH)
@given(path=paths)
@settings(max_examples=10, deadline=None)
def test_steps_are_where_the_inverse_kinematics_puts_them(name, path):
    motion, spec, geometry = in_the_middle(name)
    begin = motion.counts()
    push_shares(motion, name, path)
    assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin)


def assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin):
    motion.flush()
    moves = motion.take_moves()
    messages = motion.take_messages()
    for i, row in enumerate(spec["steppers"][: len(geometry.actuators)]):
        per_unit = row["steps_per_unit"]
        count = begin[i]

        def true_at(point, count, i=i, per_unit=per_unit):
            near = [count / per_unit] * len(geometry.actuators)
            return joints(geometry, point, near)[i] * per_unit

        which = 0
        for tick, direction in oracle.executed_ticks(messages, i):
            while which + 1 < len(moves) and tick > moves[which].end_ticks:
                which += 1
            move = moves[which]
            wanted = count + 0.5 * direction
            true = true_at(nozzle(move, tick), count)
            near = [true_at(nozzle(move, tick + d), count) for d in (-33, 33)]
            slack = max(abs(near[0] - true), abs(near[1] - true)) + 1e-3
            assert abs(true - wanted) <= slack, (row["name"], tick)
            count += direction
        if moves:
            end = true_at(tuple(moves[-1].end_mm[:3]), count)
            assert abs(count - end) <= 0.5 + 1e-6


@pytest.mark.parametrize("name", REACH)
def test_tiny_travel_with_much_filament_is_solved(name):
    """It does not measure the path any more, but none of its steps waits for the next move."""
    motion, spec, geometry = in_the_middle(name)
    begin = motion.counts()
    target = [c + mm for c, mm in zip(REACH[name][0], (0.09, -0.09, 0.09), strict=True)]
    motion.push([*target, 2000.0], 100.0)
    motion.flush()
    assert motion.counts()[:3] != begin[:3]
    assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin)


@pytest.mark.parametrize("name", REACH)
@given(path=paths)
@settings(max_examples=10, deadline=None)
def test_no_motor_beyond_its_limits(name, path):
    motion, spec, geometry = in_the_middle(name, with_steps=False)
    push_shares(motion, name, path)
    assert_no_motor_beyond_its_limits(motion, spec, geometry)


def assert_no_motor_beyond_its_limits(motion, spec, geometry):
    motion.flush()
    h = 1e-3 * oracle.HZ
    for move in motion.take_moves():
        ticks = np.arange(move.start_ticks + h, move.end_ticks - h, h)
        for i, row in enumerate(spec["steppers"][: len(geometry.actuators)]):
            for tick in ticks[:: max(1, len(ticks) // 40)]:
                corner = any(
                    abs(tick - edge) < 1.1 * h
                    for edge in (
                        move.start_ticks + move.accelerate_ticks,
                        move.end_ticks - move.decelerate_ticks,
                    )
                )
                here = geometry.inverse(nozzle(move, tick))
                q = [joints(geometry, nozzle(move, tick + d), here)[i] for d in (-h, 0, h)]
                assert abs(q[2] - q[0]) / 2e-3 <= row["speed"] * 1.01
                if not corner:
                    assert abs(q[2] - 2 * q[1] + q[0]) / 1e-6 <= row["accel"] * 1.01 + 1e-3


@pytest.mark.parametrize("name", REACH)
@given(path=paths)
@settings(max_examples=10, deadline=None)
def test_no_interval_is_shorter_than_the_driver_takes(name, path):
    """Also between the places at which a line is looked at."""
    motion = hasty(name)
    push_shares(motion, name, path)
    assert_intervals_are_as_long_as_the_driver_takes(motion)


def hasty(name):
    """A motion whose motors have hardly any limit but that of their drivers."""
    spec, _ = nonlinear(name)
    for row in spec["steppers"]:
        row |= {"max_rate_hz": 4000.0, "speed": inf, "accel": 1e6}
    for axis in spec["axes"]:
        axis |= {"speed": 1e4, "accel": 1e5}
    spec["limits"] |= {"print_accel": 1e5, "travel_accel": 1e5}
    motion = Motion(spec | {"budgets": []}, True)
    motion.set_position([*map(float, REACH[name][0]), 0.0])
    return motion


def assert_intervals_are_as_long_as_the_driver_takes(motion):
    motion.flush()
    messages = motion.take_messages()
    for motor in range(3):
        steps = oracle.executed_ticks(messages, motor)
        gaps = [b - a for (a, forth), (b, then) in pairwise(steps) if forth == then]
        assert min(gaps, default=4000) >= 4000 - 1  # 16 MHz; either step is rounded


def test_no_tower_beyond_its_limits_on_an_arc():
    """Near the edge a tower goes faster than the nozzle, towards the arc's centre, too."""
    motion, spec, geometry = in_the_middle("delta", with_steps=False)
    x, y, radius = -47.0, 35.0, 8.0

    def at(turn):
        return [x - radius * cos(turn), y + radius * sin(turn), 20.0, 0.0]

    motion.push(at(0), 100.0)
    motion.flush()
    motion.take_moves()
    for i in range(1, 97):
        motion.push(at(2 * pi * i / 96), 500.0, radius_mm=radius, inner=i > 1)
    motion.flush()
    chords = motion.take_moves()
    h = 6e-3  # s: some chords, the turns between which are what the tower feels
    ends = [move.end_ticks for move in chords]

    def towers(seconds):
        tick = chords[0].start_ticks + seconds * oracle.HZ
        return geometry.inverse(nozzle(chords[bisect_left(ends, tick)], tick))

    hardest = 0.0
    for t in np.arange(h, (ends[-1] - chords[0].start_ticks) / oracle.HZ - h, h / 4):
        for low, here, high in zip(towers(t - h), towers(t), towers(t + h), strict=True):
            hardest = max(hardest, abs(high - 2 * here + low) / h**2)
    assert 0.9 < hardest / spec["steppers"][0]["accel"] < 1.01


WAYS = {  # down a little and sidewards, so that motors turn, too
    "delta": ((10, -20, 60), (15, -20.5, 40.3)),
    "rotary-delta": ((-40, -40, 31.4676), (-40, -40, 21.0084)),
    "scara": ((90, 100, 50), (110.3, 101.7, 50)),
    "dual-scara": ((-9, 80, 25), (11.3, 81.7, 25)),
    "polar": ((-20, 3, 50), (-20.5, -9, 51)),
    "winch": ((10, -20, 60), (15, -20.5, 40.3)),
}


def steps_beside_the_target(messages, geometry, spec, begin, end):
    """Steps made less those to where the inverse is, for each motor of the nozzle."""
    found = []
    per_unit = [row["steps_per_unit"] for row in spec["steppers"][: len(geometry.actuators)]]
    made = [
        begin[i] + sum(dir for _, dir in oracle.executed_ticks(messages, i))
        for i in range(len(per_unit))
    ]
    wanted = joints(geometry, end, [n / by for n, by in zip(made, per_unit, strict=True)])
    for n, by, q in zip(made, per_unit, wanted, strict=True):
        found.append(n - floor(q * by + 0.5))
    return found


@pytest.mark.parametrize("name", REACH)
def test_cut_next_to_a_step_neither_loses_nor_doubles_steps(name):
    """A step may be done before or after its ideal time; a cut may come between the two."""
    start, end = (tuple(map(float, point)) for point in WAYS[name])

    def on_the_way():
        motion, spec, geometry = in_the_middle(name)
        motion.set_position([*start, 0.0])
        begin = motion.counts()
        motion.push([*end, 0.0], 10.0)
        motion.flush()
        return motion, spec, geometry, begin

    motion, _, geometry, _ = on_the_way()
    messages = motion.take_messages()
    for motor in range(len(geometry.actuators)):
        ticks = [tick for tick, _ in oracle.executed_ticks(messages, motor)]
        for tick in ticks[:: max(1, len(ticks) // 15)]:
            for by in (-20, -8, -3, -1, 0, 1, 3, 8, 20):
                motion, spec, geometry, begin = on_the_way()
                motion.replan_from(float(tick + by))
                motion.flush()
                after = motion.take_messages()
                lost = steps_beside_the_target(after, geometry, spec, begin, end)
                assert lost == [0] * len(lost), (motor, tick, by)


@pytest.mark.parametrize("name", REACH)
@given(
    path=paths,
    cuts=st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1), st.booleans()), min_size=1),
)
@settings(max_examples=25, deadline=None)
def test_cuts_at_random_clocks_lose_nothing(name, path, cuts):
    motion, spec, geometry = in_the_middle(name)
    begin = motion.counts()
    push_shares(motion, name, path)
    motion.flush()
    messages = []
    for where, sent, hold in cuts[:6]:
        from_ = motion.clock * where
        messages += motion.take_messages(before=from_ * sent)
        if hold:
            motion.hold_from(from_)
            motion.wait_until(motion.clock + 1e5)
            motion.release()
        else:
            motion.replan_from(from_)
        motion.flush()
    messages += motion.take_messages()
    end = tuple(c + h * s for c, h, s in zip(*REACH[name], path[-1][0], strict=True))
    lost = steps_beside_the_target(messages, geometry, spec, begin, end)
    assert lost == [0] * len(lost)


# The shoulder in the bed: arms that can be folded turn faster there than anywhere else.
NEAR = ({}, [5.0, 1.0, 0.3, 0.02]), ({"arm2": 149.8}, [5.0, 1.0, 0.3, 0.22])


def near_a_shoulder(changes, away, with_steps):
    """A motion with the nozzle to the left of the shoulder, which stands `away` mm in front of the
    line that follows."""
    spec, geometry = nonlinear("scara")
    geometry = geometry.model_copy(update={"x_offset": 100.3, "y_offset": 50.0 - away, **changes})
    spec["geometry"] = geometry.spec()
    for row in spec["steppers"][:2]:
        row |= {"min": -inf, "max": inf}
    motion = Motion(spec, with_steps)
    motion.set_position([61.0, 50.0, 0.0, 0.0])
    return motion, spec, geometry


@pytest.mark.parametrize(("changes", "away"), [(c, mm) for c, ways in NEAR for mm in ways])
@pytest.mark.parametrize("feed", [150.0, 2.0])
def test_no_motor_beyond_its_limits_next_to_a_shoulder(changes, away, feed):
    motion, spec, geometry = near_a_shoulder(changes, away, with_steps=False)
    motion.push([139.0, 50.0, 0.0, 0.0], feed)
    motion.push([99.7, 50.0 + away, 0.0, 0.0], feed)
    motion.push([160.0, 140.0, 0.0, 0.0], feed)
    assert_no_motor_beyond_its_limits(motion, spec, geometry)


@pytest.mark.parametrize("away", NEAR[0][1])
def test_steps_next_to_a_shoulder_match_inverse_kinematics(away):
    motion, spec, geometry = near_a_shoulder({}, away, with_steps=True)
    begin = motion.counts()
    motion.push([139.0, 50.0, 0.0, 0.0], 150.0)
    assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin)


@pytest.mark.parametrize("name", REACH)
def test_owed_step_comes_at_once_and_surplus_is_dropped(name):
    """A cut may leave a motor a step beside where its way goes on."""
    motion, spec, geometry = in_the_middle(name)
    push_shares(motion, name, [((0.4, 0.3, 0.2), 50)])
    motion.flush()
    (move, *_) = motion.take_moves()
    starts = geometry.inverse(tuple(move.start_mm[:3]))
    for i, (row, at) in enumerate(zip(spec["steppers"], starts, strict=False)):
        count = floor(at * row["steps_per_unit"] + 0.5)
        ticks, end = motion.ideal_ticks(move, i, count)
        way = 1 if end > count else -1
        assert len(ticks) == abs(end - count) > 3
        for done, wanted in ((-way, [move.start_ticks, *ticks]), (way, ticks[1:])):
            then, same_end = motion.ideal_ticks(move, i, count + done)
            assert then == pytest.approx(wanted)
            assert same_end == end


@pytest.mark.parametrize(
    "per_degree", [40.0, 16 * 200 * 17 / 80 / 360]
)  # whole steps a turn, or not
def test_a_bed_that_turns_without_end_keeps_its_turns(per_degree):
    motion, spec, geometry = in_the_middle("polar")
    spec["steppers"][0]["steps_per_unit"] = per_degree
    motion = Motion(spec, True)
    motion.set_position([30.0, 0.0, 0.0, 0.0])
    begin = motion.counts()
    for i in range(1, 1 + 8 * 50):  # five turns to the left, then three to the right
        turned = i if i <= 250 else 500 - i
        angle = turned * 2 * pi / 50
        motion.push([30 * cos(angle), 30 * sin(angle), 0.0, 0.0], 200.0)
    motion.flush()
    turns = (motion.counts()[0] - begin[0]) / (360 * per_degree)
    assert turns == pytest.approx(2.0, abs=0.6 / (360 * per_degree))
    assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin)


@pytest.mark.parametrize("away", [10.0, 1.0, 0.2, 0.03])
@pytest.mark.parametrize("feed", [150.0, 2.0])
def test_a_bed_turns_within_its_limits_next_to_the_middle(away, feed):
    motion, spec, geometry = in_the_middle("polar")
    motion.set_position([-40.0, away, 0.0, 0.0])
    begin = motion.counts()
    motion.push([40.0, away, 0.0, 0.0], feed)
    motion.push([40.0, -away, 0.0, 0.0], feed)
    motion.push([-40.0, -away, 0.0, 0.0], feed)
    planned, *_ = in_the_middle("polar", with_steps=False)
    planned.set_position([-40.0, away, 0.0, 0.0])
    planned.push([40.0, away, 0.0, 0.0], feed)
    planned.push([40.0, -away, 0.0, 0.0], feed)
    assert_no_motor_beyond_its_limits(planned, spec, geometry)
    assert_steps_stand_where_the_inverse_says(motion, spec, geometry, begin)
    left_deg = 360 - 2 * degrees(atan2(away, 40.0))
    assert motion.counts()[0] - begin[0] == pytest.approx(-left_deg * 40, abs=1)


def test_a_bed_without_limits_keeps_to_its_driver_near_the_middle():
    motion = hasty("polar")
    for x, away in ((-40.0, 0.03), (40.0, 0.03), (40.0, -0.03), (-40.0, -0.05)):
        motion.push([x, away, 50.0, 0.0], 200.0)
    assert_intervals_are_as_long_as_the_driver_takes(motion)
