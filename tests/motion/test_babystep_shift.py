"""Babysteps at random clocks: all that follows lies beside it, nothing lost, no limit broken."""

from __future__ import annotations

import itertools
from math import floor

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.oracles import motion as oracle

from passo._core import Motion
from passo.config import load

from .machines import aprinter, cartesian
from .test_replan import assert_arrived, push_all
from .test_steps import paths

SHIFTS = st.lists(
    st.tuples(st.floats(0, 1), st.integers(0, 2), st.integers(-200, 200)), min_size=1, max_size=4
)


def shifted(motion, shifts, sent):
    """Shifts at shares of the plan's time, in hundredths of a mm; the messages taken and the sum of
    the shifts."""
    motion.flush()
    motion.take_moves()
    messages, moves = [], []
    sums = [0.0, 0.0, 0.0]
    for where, axis, hundredths in sorted(shifts):
        total = motion.clock
        messages += motion.take_messages(before=total * where * sent)
        cut = motion.shift_from(total * where, axis, hundredths / 100)
        sums[axis] += hundredths / 100
        motion.flush()
        moves = motion.take_moves()
        assert all(m.start_ticks >= cut - 1e-3 for m in moves)
        for before, following in itertools.pairwise(moves):
            assert abs(before.end_speed - following.start_speed) < 1e-6
            for p, q in zip(before.end_mm[:3], following.start_mm[:3], strict=True):
                assert abs(p - q) < 1e-9
    return messages + motion.take_messages(), moves, sums


@given(paths, SHIFTS, st.floats(0, 1))
@settings(max_examples=60, deadline=None)
@pytest.mark.parametrize("spec", [cartesian(), cartesian(junction="jerk")])
def test_the_sum_of_all_shifts_is_made_in_steps(spec, path, shifts, sent):
    motion = Motion(spec, True)
    end = push_all(motion, path)
    messages, moves, sums = shifted(motion, shifts, sent)
    assert_arrived(motion, messages, [a + b for a, b in zip(end, [*sums, 0.0], strict=True)])
    # Only the way to brake, right behind the last cut, may be as fast as before it.
    for m in moves[1:]:
        for slot, row in enumerate(spec["axes"]):
            part = abs(m.end_mm[slot] - m.start_mm[slot]) / m.length
            assert part * m.cruise_speed <= row["speed"] * (1 + 1e-9)


@given(paths, SHIFTS, st.floats(0, 1))
@settings(max_examples=30, deadline=None)
def test_babysteps_under_cornering_distance(path, shifts, sent):
    motion = Motion(aprinter(), True)
    end = push_all(motion, path)
    messages, _, sums = shifted(motion, shifts, sent)
    for axis in range(3):
        steps = oracle.executed_ticks(messages, axis)
        assert sum(d for _, d in steps) == floor((end[axis] + sums[axis]) * 80 + 0.5)


point = st.tuples(st.integers(-40, 40), st.integers(-40, 40), st.integers(40, 80))


@given(st.lists(point, min_size=1, max_size=6), SHIFTS, st.floats(0, 1))
@settings(max_examples=30, deadline=None)
def test_on_a_delta_every_carriage_follows(path, shifts, sent):
    machine = load("delta")
    spec = machine.core_spec()
    motion = Motion(spec, True)
    motion.set_position([0.0, 0.0, 60.0, 0.0])
    begin = motion.counts()
    for x, y, z in path:
        motion.push([x, y, z, 0], 60.0)
    messages, _, sums = shifted(motion, shifts, sent)
    end = tuple(p + d for p, d in zip(path[-1], sums, strict=True))
    heights = machine.geometry.inverse(end)
    for i, row in enumerate(spec["steppers"][:3]):
        made = begin[i] + sum(d for _, d in oracle.executed_ticks(messages, i))
        assert abs(made - heights[i] * row["steps_per_unit"]) <= 0.5 + 1e-6


def test_babystep_is_spread_over_a_long_line():
    # Z may take 100 mm/s², a thirtieth of what X takes: the slope is 1/40, 0.1 mm need 4 mm.
    motion = Motion(cartesian(), True)
    motion.push([200, 0, 0, 0], 100.0)
    motion.flush()
    motion.take_moves()
    cut = motion.shift_from(1.0 * oracle.HZ, 2, 0.1)
    motion.flush()
    braking, leaning, behind = motion.take_moves()
    assert cut == oracle.HZ
    assert braking.end_mm[2] == 0
    assert braking.end_mm[0] - braking.start_mm[0] == pytest.approx(100**2 / 2 / 3000)
    assert leaning.start_speed == 100.0
    assert leaning.end_speed == pytest.approx(100.0, rel=1e-9)
    assert leaning.end_mm[0] - leaning.start_mm[0] == pytest.approx(4.0, rel=1e-6)
    assert leaning.end_mm[2] == behind.start_mm[2] == behind.end_mm[2] == 0.1
    assert behind.end_mm[0] == 200.0


def test_babystep_without_room_is_a_move_of_its_own():
    motion = Motion(cartesian(), True)
    motion.push([1, 0, 0, 0], 100.0)
    motion.flush()
    motion.take_moves()
    motion.shift_from(0.0, 2, 2.0)
    motion.flush()
    leaning, lift = motion.take_moves()
    assert leaning.end_mm[:3] == (1.0, 0.0, 0.025)
    assert lift.end_mm[:3] == (1.0, 0.0, 2.0)
    assert lift.cruise_speed == pytest.approx(12.0)


@pytest.mark.parametrize(("mm", "ends"), [(2.0, (50.95, 52.0)), (-2.0, (50.0, 48.0))])
def test_babystep_never_shortens_a_move(mm, ends):
    """Else the way to brake might not suffice."""
    motion = Motion(cartesian(), True)
    motion.push([0, 0, 50, 0], 10.0)
    motion.flush()
    motion.take_moves()
    motion.shift_from(3.0 * oracle.HZ, 2, mm)
    motion.flush()
    moves = motion.take_moves()
    assert tuple(m.end_mm[2] for m in moves[-2:]) == pytest.approx(ends, abs=0.05)


@example(0.5)
@given(st.floats(0.1, 0.9))
@settings(max_examples=20, deadline=None)
def test_a_move_of_a_given_time_keeps_it_when_it_is_cut(where):
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 0], 100.0, duration_s=10.0)
    motion.flush()
    motion.take_moves()
    total = motion.clock
    motion.replan_from(where * total)
    motion.flush()
    assert motion.clock == pytest.approx(total, rel=1e-3)


def test_a_motor_that_has_rested_long_may_step_at_the_very_cut():
    # Z stands half a step beside where it turns back; its clock is told anew after 17 s of rest.
    motion = Motion(cartesian(), True)
    motion.push([0, 0, 0.00125, 0], 10.0)
    motion.push([400, 0, 0.00125, 0], 10.0)
    motion.flush()
    messages = motion.take_messages(before=20.0 * oracle.HZ)
    motion.shift_from(20.0 * oracle.HZ, 2, -0.1)
    motion.flush()
    assert_arrived(motion, messages + motion.take_messages(), [400.0, 0.0, -0.09875, 0.0])
