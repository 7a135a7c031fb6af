"""Cuts at random clocks: nothing lost, nothing doubled, no limit broken."""

from __future__ import annotations

import itertools
from math import floor, hypot

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import motion as oracle

from passo._core import Job, JobStatus, Motion
from passo.config import load

from .machines import cartesian
from .test_steps import STEPS_PER_MM, paths, step


def push_all(motion, path):
    at = [0.0, 0.0, 0.0, 0.0]
    for dx, dy, dz, de, feed in path:
        at = [a + d for a, d in zip(at, (dx, dy, dz, de / 20), strict=True)]
        motion.push(at, float(feed), "print" if dx or dy or dz else "extrude")
    return at


def assert_arrived(motion, messages, end):
    clocks = [m[2] for m in messages]
    assert clocks == sorted(clocks)
    for kind, _, clock, last, interval, count, add, _ in messages:
        if kind == "queue_step":
            # A board that gets it by its clock is in time for its first step; right after a cut
            # that may lie half a window before its ideal time.
            first = last - (count - 1) * interval - add * (count * (count - 1) // 2)
            assert clock <= first + 33
    for axis, per_mm in STEPS_PER_MM.items():
        steps = oracle.executed_ticks(messages, axis)
        assert sum(d for _, d in steps) == floor(end[axis] * per_mm + 0.5)
        times = [t for t, _ in steps]
        assert times == sorted(times)
        assert len(set(times)) == len(times)


@given(paths, st.floats(0, 1), st.floats(0, 1), st.floats(0.2, 3), st.floats(500, 6000))
@settings(max_examples=60, deadline=None)
def test_a_new_feed_rate_from_any_clock(path, sent, where, factor, accel):
    motion = Motion(cartesian(), True)
    end = push_all(motion, path)
    motion.flush()
    total = motion.clock
    motion.take_moves()
    messages = motion.take_messages(before=total * sent)
    motion.set_speed_factor(factor)
    motion.set_accel(accel)
    cut = motion.replan_from(total * where)
    assert cut >= min(total * where, total) - 1
    motion.flush()
    after = motion.take_moves()
    for m in after:
        assert m.start_ticks >= cut - 1e-3
    for before, following in itertools.pairwise(after):
        assert abs(before.end_speed - following.start_speed) < 1e-6
    assert_arrived(motion, messages + motion.take_messages(), end)


@given(paths, st.floats(0, 1), st.floats(0, 1))
@settings(max_examples=60, deadline=None)
def test_hold_stops_and_release_continues_the_plan(path, sent, where):
    motion = Motion(cartesian(), True)
    end = push_all(motion, path)
    motion.flush()
    total = motion.clock
    moves = motion.take_moves()
    messages = motion.take_messages(before=total * sent)
    cut = motion.hold_from(total * where)
    stopped = motion.clock
    longest = max([m.cruise_speed / m.deceleration for m in moves], default=0) * oracle.HZ
    assert stopped <= max(cut + longest * len(moves), total) + 1
    messages += motion.take_messages()
    braking = motion.take_moves()
    if braking:
        assert braking[-1].end_speed < 1e-6
    held_at = {axis: sum(d for _, d in oracle.executed_ticks(messages, axis)) for axis in range(4)}
    motion.wait_until(stopped + oracle.HZ)
    motion.release()
    motion.flush()
    rest = motion.take_messages()
    assert all(m[2] >= stopped - 0.021 * oracle.HZ for m in rest)
    assert_arrived(motion, messages + rest, end)
    for axis, per_mm in STEPS_PER_MM.items():
        moved = sum(d for _, d in oracle.executed_ticks(messages + rest, axis)) - held_at[axis]
        assert moved == floor(end[axis] * per_mm + 0.5) - held_at[axis]


@given(st.lists(st.tuples(step, st.floats(0, 1)), min_size=2, max_size=12))
@settings(max_examples=80, deadline=None)
def test_commands_precede_their_steps_after_cuts(path):
    motion = Motion(cartesian(), True)
    at = [0.0, 0.0, 0.0, 0.0]
    for (dx, dy, dz, de, feed), where in path:
        at = [a + d for a, d in zip(at, (dx, dy, dz, de / 20), strict=True)]
        motion.push(at, float(feed), "print" if dx or dy or dz else "extrude")
        motion.replan_from(motion.clock * where)
    motion.flush()
    assert_arrived(motion, motion.take_messages(), at)


@given(st.lists(st.floats(0.01, 1), min_size=1, max_size=5), st.floats(0.3, 2))
@settings(max_examples=20, deadline=None)
def test_plan_statistics_are_counted_once(cuts, factor):
    job = Job(load("i3").core_spec())
    job.feed(b"M83\nG1 X50 Y20 F6000\nG1 X90 E2\nG4 P500\nG1 E-1 F1800\nG1 X40 F9000\nG1 X30 E1\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    for where in cuts:
        job.limits.set_speed_factor(factor, live=True)
        job.plan.replan_from(job.clock * where)
        job.flush()
    sums = job.results.statistics()
    assert sums["moves"] == 5
    assert sums["travel_mm"] == pytest.approx(hypot(50, 20) + 50)
    assert sums["print_mm"] == pytest.approx(40 + 10)
    assert sums["filament_mm"] == pytest.approx([2])
    assert sums["dwell_s"] == pytest.approx(0.5)
    for seconds in (
        sums["move_s"] + sums["dwell_s"],
        sum(sums["limit_s"].values()) + sums["dwell_s"],
        sum(sums["layer_s"]),
        sum(sums["feature_s"].values()),
    ):
        assert seconds == pytest.approx(job.clock / oracle.HZ)
    for motor in job.motors.statistics():
        assert motor["net"] == motor["expected_net"] == motor["count"]
    assert job.motors.statistics()[0]["steps"] == 150 * 80


def test_the_new_limit_holds_after_braking():
    motion = Motion(cartesian(), True)
    motion.push([200, 0, 0, 0], 100.0)
    motion.flush()
    motion.take_moves()
    motion.set_speed_factor(0.25)
    motion.replan_from(1.0 * oracle.HZ)
    motion.flush()
    (move,) = motion.take_moves()
    assert move.start_speed == 100.0
    assert move.cruise_speed == 25.0
    assert move.acceleration == -3000.0
    assert move.accelerate_ticks / oracle.HZ == 75.0 / 3000.0
    assert move.end_speed == 0.0


def test_revoked_record_is_sent_again():
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 0], 50.0)
    motion.record(2, 7)
    motion.push([150, 0, 0, 0], 50.0)
    motion.flush()
    motion.take_moves()
    motion.set_speed_factor(0.5)
    motion.replan_from(0.5 * oracle.HZ)
    motion.flush()
    moves = motion.take_moves()
    pins = oracle.pins(motion.take_messages())
    assert pins == [(round(moves[1].start_ticks), 7)]


@given(st.floats(0, 1), st.floats(0, 1), st.booleans())
@settings(max_examples=60, deadline=None)
def test_a_cut_takes_back_clocks_that_were_set_again(sent, where, hold):
    # Z rests for 40 s between its moves, longer than 2**28 ticks, and turns each time.
    motion = Motion(cartesian(), True)
    for i in range(8):
        motion.push([200.0 * (i % 2), 0, 0.5 * (i % 2), 0.1 * i], 5.0)
        motion.push([200.0 * (1 - i % 2), 0, 0.5 * (i % 2), 0.1 * i], 5.0)
    motion.flush()
    total = motion.clock
    messages = motion.take_messages(before=total * sent)
    if hold:
        motion.hold_from(total * where)
        messages += motion.take_messages()
        motion.release()
    else:
        motion.replan_from(total * where)
    motion.flush()
    assert_arrived(motion, messages + motion.take_messages(), [0.0, 0.0, 0.5, 0.7])


def test_a_step_at_the_end_of_a_stop_may_be_taken_back_at_once():
    # The last step of the first move falls on its very end, and the next move reverses there.
    motion = Motion(cartesian(), True)
    motion.push([10.00625, 0, 0, 0], 50.0)
    motion.flush()
    motion.push([9, 0, 0, 0], 50.0)
    motion.flush()
    messages = motion.take_messages()
    assert_arrived(motion, messages, [9.0, 0, 0, 0])
    # Neither is farther from there than the driver needs to turn: two pulses of 1 µs, and 2 ticks.
    stop = motion.take_moves()[0].end_ticks
    last, back = oracle.executed_ticks(messages, 0)[800:802]
    assert (last[1], back[1]) == (1, -1)
    assert abs(last[0] - stop) <= 2.5
    assert 32 <= back[0] - last[0] <= 36


@pytest.mark.parametrize("follows", [True, False])
def test_a_dwell_ends_early_and_what_was_due_after_it_is_done(follows):
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.push([10, 0, 0, 0], 50.0, "dwell", duration_s=60.0)
    motion.record(2, 7)
    if follows:
        motion.push([20, 0, 0, 0], 50.0)
    motion.flush()
    motion.take_moves()
    assert motion.skip_dwell_from(0.1 * oracle.HZ) is None  # X moves
    cut = 5.0 * oracle.HZ
    assert motion.skip_dwell_from(cut) == cut
    motion.flush()
    assert [m.start_ticks for m in motion.take_moves()] == [cut] * follows
    messages = motion.take_messages()
    assert oracle.pins(messages) == [(cut, 7)]
    assert_arrived(motion, messages, [20.0 if follows else 10.0, 0.0, 0.0, 0.0])


def test_skip_of_past_dwell_does_not_end_the_next():
    motion = Motion(cartesian(), True)
    for value in range(2):
        motion.push([0, 0, 0, 0], 50.0, "dwell", duration_s=1.0)
        motion.record(2, value)
    motion.flush()
    assert len(motion.take_messages(before=1.5 * oracle.HZ)) == 1
    assert motion.skip_dwell_from(0.5 * oracle.HZ) == oracle.HZ
    motion.flush()
    assert motion.clock == 2 * oracle.HZ


def test_a_record_at_the_very_clock_of_a_cut_is_done_once():
    motion = Motion(cartesian(), True)
    motion.push([0, 0, 0, 0], 50.0, "dwell", duration_s=1.0)
    motion.record(2, 7)
    motion.push([10, 0, 0, 0], 50.0)
    motion.record(2, 8)
    motion.push([20, 0, 0, 0], 50.0)
    motion.flush()
    assert motion.replan_from(oracle.HZ) == oracle.HZ
    motion.flush()
    motion.take_moves()
    assert [v for _, v in oracle.pins(motion.take_messages())] == [7, 8]


def test_event_after_stop_keeps_position_when_move_is_cut():
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.flush()
    motion.record(2, 7)
    motion.push([20, 0, 0, 0], 50.0)
    motion.record(2, 8)
    motion.push([30, 0, 0, 0], 50.0)
    motion.flush()
    motion.take_moves()
    motion.replan_from(0.1 * oracle.HZ)
    motion.flush()
    starts = [round(m.start_ticks) for m in motion.take_moves()]
    assert oracle.pins(motion.take_messages()) == [(starts[1], 7), (starts[2], 8)]


def test_event_at_stop_precedes_queued_moves_after_cut():
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.flush()
    motion.record(2, 7)
    motion.push([20, 0, 0, 0], 50.0)
    motion.replan_from(0.1 * oracle.HZ)
    motion.flush()
    start = round(motion.take_moves()[-1].start_ticks)
    assert oracle.pins(motion.take_messages()) == [(start, 7)]


def two_with_records(first_mm: float) -> Motion:
    """A move to `first_mm` and one on to 100 mm, at 50 mm/s, with a record behind each."""
    motion = Motion(cartesian(), True)
    motion.push([first_mm, 0, 0, 0], 50.0)
    motion.record(2, 7)
    motion.push([100, 0, 0, 0], 50.0)
    motion.record(2, 8)
    return motion


def test_move_with_stop_inside_keeps_its_events_once():
    motion = two_with_records(10)
    motion.flush()
    motion.take_moves()
    motion.hold_from(0.204 * oracle.HZ)  # 0.217 mm before the end of the first
    motion.release()
    motion.flush()
    moves = motion.take_moves()
    assert [round(m.end_mm[0], 3) for m in moves[:3]] == [10.0, 10.2, 100.0]
    pins = oracle.pins(motion.take_messages())
    assert pins == [(round(moves[1].start_ticks), 7), (round(moves[2].end_ticks), 8)]


def test_a_move_that_is_held_counts_once():
    job = Job(load("i3").core_spec())
    job.feed(b"G1 X10 F3000\nG1 X100\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    job.stops.hold_from(0.202 * oracle.HZ)  # in the first, and stops in the second
    job.stops.release()
    job.flush()
    assert job.results.statistics()["moves"] == 2


def test_moves_after_held_ones_use_current_limits():
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 0], 10.0)
    motion.flush()
    motion.hold_from(oracle.HZ)
    motion.set_speed_factor(2.0, live=False)
    motion.release()
    motion.push([200, 0, 0, 0], 10.0)
    motion.flush()
    assert [m.cruise_speed for m in motion.take_moves()[-2:]] == pytest.approx([10.0, 20.0])


def test_current_line_follows_the_new_plan():
    job = Job(load("i3").core_spec())
    assert job.history.line_at(0) == 0
    job.feed(b"G1 X50 F600\n" + b"".join(b"G1 X%d\n" % x for x in range(60, 150, 10)))
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    for second, factor in ((1, 0.5), (2, 2.0)):
        job.limits.set_speed_factor(factor, live=True)
        job.plan.replan_from(second * oracle.HZ)
        job.flush()
    # At 15 mm after 2 s, and at 50 mm after another 1.75 s; then 20 mm/s.
    assert [job.history.line_at(t * oracle.HZ) for t in (1.0, 3.0)] == [1, 1]
    assert [job.history.line_at((4 + 0.5 * k) * oracle.HZ) for k in range(9)] == list(range(2, 11))


@pytest.mark.parametrize("dwells_first", [True, False])
def test_event_done_at_stop_keeps_position_after_cut(dwells_first):
    # It is due at the very clock of the stop, or a third of a tick before it.
    motion = Motion(cartesian(), True)
    ways = [([0, 0, 0, 0], 50.0, "dwell", 0, 1.0), ([1, 0, 0, 0], 50.0)]
    first, second = ways if dwells_first else ways[::-1]
    motion.push(*first)
    due = float(oracle.HZ) if dwells_first else 586667.0
    motion.record(2, 7)
    motion.push(*second)
    motion.flush()
    assert motion.hold_from(due - 0.5) == due
    motion.record(3, 8)
    motion.replan_from(0.5 * due)
    assert [(m[1], m[2], m[4]) for m in motion.take_messages() if m[0] == "pin"] == [
        (2, due, 7),
        (3, due, 8),
    ]


def test_a_cut_dwell_keeps_its_length_at_an_earlier_cut():
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.push([10, 0, 0, 0], 50.0, "dwell", duration_s=1.0)
    motion.flush()
    total = motion.clock
    motion.replan_from(total - 0.25 * oracle.HZ)
    motion.replan_from(0.1 * oracle.HZ)
    motion.flush()
    assert motion.clock == pytest.approx(total, abs=2)


def test_event_at_stop_does_not_replace_held_events():
    motion = two_with_records(50)
    motion.hold_from(0.5 * oracle.HZ)
    stopped = motion.clock
    motion.record(2, 9)
    motion.set_speed_factor(2.0)
    motion.replan_from(0.0)
    motion.take_moves()
    motion.release()
    motion.flush()
    moves = motion.take_moves()
    assert oracle.pins(motion.take_messages()) == [
        (round(stopped), 9),
        (round(moves[1].start_ticks), 7),
        (round(moves[1].end_ticks), 8),
    ]


def test_held_plan_is_shifted_on_return():
    motion = Motion(cartesian(), True)
    motion.push([100, 0, 0, 0], 50.0)
    cut = motion.hold_from(1.0 * oracle.HZ)
    assert motion.shift_from(cut, 2, 0.5) == motion.clock
    motion.shift_from(cut, 1, -0.25)
    motion.take_moves()
    motion.release()
    motion.flush()
    moves = motion.take_moves()
    stop = moves[0].start_mm[0]
    assert [m.end_mm[:3] for m in moves] == [
        (stop, -0.25, 0.0),
        (stop, -0.25, 0.5),
        (100.0, -0.25, 0.5),
    ]
    assert_arrived(motion, motion.take_messages(), [100.0, -0.25, 0.5, 0.0])


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_suspended_job_is_shifted_from_stop_to_end(axis):
    job = Job(load("i3").core_spec())
    job.feed(b"G1 X20 Y20 Z1 F6000\nG1 X100\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    job.stops.hold_from(job.clock - 0.3 * oracle.HZ)
    job.stops.suspend()
    stop = list(job.stops.position)
    job.plan.shift_from(job.clock, axis, 0.5)
    stop[axis] += 0.5
    assert list(job.stops.position) == stop
    assert job.plan.move_to(job.stops.position, 50.0)
    job.stops.resume()
    end = [100.0, 20.0, 1.0]
    end[axis] += 0.5
    assert job.machine_position[:3] == end
    job.flush()
    for motor, mm in zip(job.motors.statistics()[:3], end, strict=True):
        assert motor["net"] == mm * motor["steps_per_unit"]


def test_move_to_the_held_plan_keeps_its_acceleration():
    motion = Motion(cartesian(), True)
    motion.push([10, 0, 0, 0], 50.0)
    motion.flush()
    motion.set_accel(500.0, live=False)
    motion.push([100, 0, 0, 0], 50.0)
    motion.set_accel(2000.0, live=False)
    motion.shift_from(motion.hold_from(1.0 * oracle.HZ), 1, 3.0)
    motion.take_moves()
    motion.release()
    motion.flush()
    over, rest = motion.take_moves()
    assert over.acceleration == rest.acceleration == 500.0


def test_queued_time_is_nominal_speeds_and_dwells():
    job = Job(load("i3").core_spec())
    job.feed(b"G1 X30 F600\nG4 P5000\nG1 X0 F1200\n")
    assert job.advance() == JobStatus.NEED_INPUT
    assert job.plan.queued_ticks == pytest.approx((3.0 + 5.0 + 1.5) * oracle.HZ)


@pytest.mark.parametrize("line", ["G4 P10", "G1 X5.001\nG1 X5"])
def test_moves_without_steps_are_forgotten_too(line):
    """Else a file of it would fill the memory: nothing is handed out that could be taken."""
    job = Job(load("i3").core_spec())
    job.feed(f"G1 X5 F600\n{f'{line}{chr(10)}' * 2000}".encode())
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    early = job.clock - 3 * oracle.HZ
    assert job.history.position_at(early) is not None
    job.plan.passed(job.clock)
    job.feed(f"{line}\n".encode() * 300)
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    assert job.history.position_at(early) is None
    assert job.history.position_at(job.clock - 0.5 * oracle.HZ) is not None


def test_held_plan_waits_after_tiny_braking_distance():
    # Much filament on a hair of way: 0.0024 mm/s at the corner, from which 1 pm is enough to brake.
    motion = Motion(cartesian(), True)
    motion.push([0.032, 0, 0, -13.531], 100.0)
    motion.push([15.4, 0, 0, -13.531], 100.0)
    motion.flush()
    corner = motion.take_moves()[1]
    assert 0.002 < corner.start_speed < 0.003
    motion.hold_from(corner.start_ticks - 1000)
    stopped = motion.clock
    motion.shift_from(stopped, 2, 2.5)
    motion.hold_from(stopped + oracle.HZ)
    assert motion.clock == stopped
    motion.release()
    motion.flush()
    assert_arrived(motion, motion.take_messages(), [15.4, 0.0, 2.5, -13.531])
