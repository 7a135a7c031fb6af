"""A flow of filament that changes at random clocks: steps add up, the rest is left alone."""

from __future__ import annotations

import itertools
from math import floor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import flow as flow_oracle
from tests.oracles import motion as oracle

from passo._core import Motion

from .machines import aprinter, cartesian
from .test_replan import assert_arrived, push_all
from .test_steps import paths

CHANGES = st.lists(
    st.tuples(st.floats(0, 1), st.sampled_from([0.01, 0.5, 0.95, 1.0, 1.3, 10.0])),
    min_size=1,
    max_size=4,
)


def changed(motion, changes, sent):
    """Changes at shares of the plan's time; the messages taken, and the E lengths that the oracle
    finds behind the way to brake at the last change."""
    motion.flush()
    moves = motion.take_moves()
    messages, left = [], []
    for where, factor in sorted(changes):
        total = motion.clock
        messages += motion.take_messages(before=total * where * sent)
        cut = motion.change_flow_from(total * where, factor)
        motion.flush()
        after = motion.take_moves()
        assert all(m.start_ticks >= cut - 1e-3 for m in after)
        for before, following in itertools.pairwise(after):
            assert abs(before.end_speed - following.start_speed) < 1e-6
            for p, q in zip(before.end_mm, following.start_mm, strict=True):
                assert abs(p - q) < 1e-8
        left = flow_oracle.behind_the_way_to_brake(moves, cut)
        moves = [m for m in moves if m.end_ticks <= cut] + after
    return messages + motion.take_messages(), left


@given(paths, st.floats(0, 1), st.sampled_from([0.01, 0.5, 0.95, 1.3, 10.0]), st.floats(0, 1))
@settings(max_examples=80, deadline=None)
@pytest.mark.parametrize("spec", [cartesian(), cartesian(junction="jerk")])
def test_filament_ends_where_the_oracle_does(spec, path, where, factor, sent):
    motion = Motion(spec, True)
    end = push_all(motion, path)
    messages, left = changed(motion, [(where, factor)], sent)
    steps = sum(d for _, d in oracle.executed_ticks(messages, 3))
    assert abs(steps - (end[3] - sum(left) + flow_oracle.fed(left, factor)) * 95.5) <= 0.5 + 1e-3
    assert_arrived(motion, [m for m in messages if m[1] != 3], [*end[:3], 0.0])


@given(paths, CHANGES, st.floats(0, 1))
@settings(max_examples=60, deadline=None)
@pytest.mark.parametrize("spec", [cartesian(), aprinter()])
def test_flow_changes_do_not_alter_other_axes(spec, path, changes, sent):
    motion = Motion(spec, True)
    end = push_all(motion, path)
    messages, _ = changed(motion, changes, sent)
    for axis in range(3):
        per_mm = spec["steppers"][axis]["steps_per_unit"]
        steps = sum(d for _, d in oracle.executed_ticks(messages, axis))
        assert steps == floor(end[axis] * per_mm + 0.5)
    assert sum(d for _, d in oracle.executed_ticks(messages, 3)) == motion.counts()[3]


def test_flow_halved_within_a_line():
    # 10 mm/s: 1/600 mm to reach, and as much to brake, of which filament moves a twentieth.
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 5], 10.0, "print")
    motion.flush()
    motion.take_moves()
    cut = motion.change_flow_from(5.0 * oracle.HZ, 0.5)
    motion.flush()
    first, second = motion.take_moves()
    at = 50 - 100 / 6000  # mm, where the cut is
    assert cut == 5.0 * oracle.HZ
    assert first.start_mm[0] == pytest.approx(at)
    assert second.start_mm[0] == pytest.approx(at + 100 / 6000)
    assert second.start_speed == 10.0  # nothing slows down for it
    assert second.end_mm[0] == 100
    assert second.end_mm[3] == pytest.approx(2.5 + 1.25)


def test_flow_step_slows_the_line_down_first():
    # 0.05 mm of filament a mm: at 100 mm/s four times as much is a jump by 15 mm/s; 1 is allowed.
    motion = Motion(cartesian(), True)
    motion.push([200, 0, 0, 10], 100.0, "print")
    motion.flush()
    motion.take_moves()
    motion.change_flow_from(1.0 * oracle.HZ, 4.0)
    motion.flush()
    moves = motion.take_moves()
    jump = next(m for m in moves if (m.end_mm[3] - m.start_mm[3]) / m.length > 0.19)
    assert jump.start_speed == pytest.approx(1.0 / 0.15)


def test_moves_outside_programs_keep_their_length():
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 5], 10.0, "print")
    motion.push([100, 0, 0, 3], 10.0, "extrude", flow=0.0)
    motion.flush()
    motion.take_moves()
    motion.change_flow_from(0.0, 0.5)
    motion.flush()
    assert [m.end_mm[3] for m in motion.take_moves()] == [2.5, 0.5]


def test_flow_change_applies_to_held_moves():
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 5], 10.0, "print")
    motion.flush()
    motion.hold_from(5.0 * oracle.HZ)
    stop = motion.take_moves()[-1].end_mm[3]
    motion.change_flow_from(5.5 * oracle.HZ, 0.5)
    motion.release()
    motion.flush()
    assert motion.take_moves()[-1].end_mm[3] == pytest.approx(stop + 0.5 * (5 - stop))
