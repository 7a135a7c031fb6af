"""Backlash compensation, from planned moves to executed steps, against the plain oracle."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import filters as oracle
from tests.oracles import motion as executed

from passo._core import Job, Motion
from passo.config import load
from passo.config.shapers import impulses

from . import machines
from .test_filters import BOX, EVERY, HZ, NONE, SCALES, delay_of, filtered, law_of, plan, print_path
from .test_replan import push_all
from .test_steps import paths

GAPS = [(0.2, 1.5), (0.05, 3.0), (0.1, 0.4)]  # mm, and mm over which they are taken up
STEPS = [16, 4, 40, 0]  # of the gaps


def geared(spec=None, **filters):
    return filtered(spec, **filters, gaps=GAPS)


def net(messages, target):
    return sum(d for _, d in executed.executed_ticks(messages, target))


SHAPER = impulses("mzv", 47.0, 0.1)


@pytest.mark.parametrize(
    ("shaper", "box", "seed"), [(NONE, 0, 2), (SHAPER, 0, 2), (SHAPER, BOX, 5)]
)
def test_steps_take_up_the_gap_as_those_of_the_oracle(shaper, box, seed):
    motion, moves = plan(geared(x=shaper, y=shaper, box=box), print_path(seed, 14))
    messages, end = motion.take_messages(), motion.clock
    delay = max(delay_of(shaper, box=box), 1)
    for slot, (gap, over) in enumerate(GAPS):
        planned = oracle.Planned(moves, slot)
        cuts = [tick + delay for tick in planned.cuts(0, end - delay)]
        law = law_of(planned, shaper if slot < 2 else NONE, delay, box)
        law = oracle.led(law, 0, end, gap, over, cuts)
        wanted = oracle.steps(law, 0, end, SCALES[slot], 600)
        executed.assert_within_bound(executed.executed_ticks(messages, slot), wanted)


@given(paths, st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1)), max_size=3), st.booleans())
@settings(max_examples=40, deadline=None)
def test_cut_path_ends_with_the_same_lead(path, cuts, holds):
    whole = Motion(geared())
    push_all(whole, path)
    whole.flush()
    motion = Motion(geared())
    push_all(motion, path)
    motion.flush()
    messages = []
    for sent, where in cuts:
        messages += motion.take_messages(before=motion.clock * sent)
        motion.set_speed_factor(0.4 + where)
        if holds:
            motion.hold_from(motion.clock * where)
            motion.wait_until(motion.clock + HZ / 10)
            motion.release()
        else:
            motion.replan_from(motion.clock * where)
        motion.flush()
    messages += motion.take_messages()
    assert motion.counts() == whole.counts()
    assert [net(messages, target) for target in range(4)] == motion.counts()


@pytest.mark.parametrize(("hold_s", "cut_s"), [(None, 0.02), (None, 0.3), (0.02, 0.8)])
def test_cut_at_a_rest_keeps_the_part_of_the_gap(hold_s, cut_s):
    """Before the first move, in a dwell, and where a hold has stopped the first move."""
    motion = Motion(geared(**EVERY))
    if hold_s is None:
        motion.push([0.0, 0.0, 0.0, 0.0], 1.0, "dwell", duration_s=0.2)
    motion.push([1.2, 0.0, 0.0, 0.0], 60.0)
    motion.push([1.2, 0.0, 0.0, 0.0], 1.0, "dwell", duration_s=0.2)
    motion.push([1.4, 0.0, 0.0, 0.0], 60.0)
    motion.flush()
    counts = motion.counts()
    if hold_s is not None:
        motion.hold_from(hold_s * HZ)
        motion.wait_until(motion.clock + HZ)
        motion.release()
        motion.flush()
    motion.replan_from(cut_s * HZ)
    motion.flush()
    assert motion.counts() == counts
    assert net(motion.take_messages(), 0) == counts[0] == 112 + 15  # 16 * 1.4 / 1.5


@pytest.mark.parametrize("seed", range(4))
def test_cut_shaped_path_ends_within_the_gap(seed):
    """Where it brakes, it may turn elsewhere than without the cut."""
    path = list(print_path(seed, 60))
    plain, _ = plan(machines.cartesian(), path)
    motion, _ = plan(geared(**EVERY, box=seed % 2 * BOX), path)
    rng = random.Random(seed)
    messages = motion.take_messages(before=motion.clock * rng.random())
    motion.hold_from(motion.clock * rng.random())
    motion.wait_until(motion.clock + HZ)
    motion.release()
    motion.push([path[-1][0][0] + 5.0, path[-1][0][1] - 5.0, *path[-1][0][2:]], 100.0)
    motion.flush()
    messages += motion.take_messages()
    ends = [motion.counts()[i] - plain.counts()[i] for i in range(4)]
    assert ends[:2] == [400 + STEPS[0], -400]
    assert 0 <= ends[2] <= STEPS[2]
    assert ends[3] == 0
    assert [net(messages, target) for target in range(4)] == motion.counts()


def test_motor_keeps_the_limits_of_its_axis_while_it_takes_up_a_gap():
    spec = machines.cartesian()
    motion = Motion(geared(spec), False)
    for i in range(1, 9):
        motion.push([i % 2 * 60.0, 0.0, 0.0, 0.0], 400.0)
    motion.flush()
    moves, share = motion.take_moves(), GAPS[0][0] / GAPS[0][1]
    speed, accel, jerk = (spec["axes"][0][what] for what in ("speed", "accel", "jerk"))
    names = Job(load("i3").core_spec()).limits.names
    for m in moves:
        assert m.cruise_speed * (1 + share) <= speed
        assert m.acceleration * (1 + share) <= accel * (1 + 1e-12)
        assert m.cruise_speed * share == pytest.approx(jerk)
    assert {names[m.speed_limit] for m in moves} == {"backlash"}


def test_positions_stay_where_the_gap_changes():
    job = Job(load("i3").core_spec() | {"filters": {"gaps": GAPS}})
    job.feed(b"G1 X10 Y4 F6000\n")
    job.advance()
    job.flush()
    before = job.motors.statistics()
    job.filters.set("gaps", 0, [0.4, 2.0])
    job.filters.set("gaps", 1, [0.0, 1.0])
    after = job.motors.statistics()
    for row, was in zip(after, before, strict=True):
        assert (row["count"], row["expected_net"]) == (was["count"], was["expected_net"])
    job.feed(b"G1 X0 Y0\n")
    job.advance()
    job.flush()
    x, y, *_ = job.motors.statistics()
    assert (x["count"], x["expected_net"]) == (0, STEPS[0] - 32)
    assert (y["count"], y["expected_net"]) == (0, STEPS[1])


def test_trigger_takes_up_the_gap_in_its_direction():
    job = Job(load("i3").core_spec() | {"filters": {"gaps": GAPS}})
    job.feed(b"G1 X10 F6000\nG1 X9.5\n")
    job.advance()
    job.flush()
    x = job.motors.statistics()[0]
    lead = x["expected_net"] - x["count"]
    assert (x["count"], lead) == (760, 11)  # 16 less 16 * 0.5 / 1.5, rounded
    assert x["taken_up"] == lead  # the nozzle is that much further than the plan
    job.axes.set([(0, 7.0)], triggered=True)
    job.feed(b"G1 X5\nG1 X7\n")
    job.advance()
    job.flush()
    after = job.motors.statistics()[0]
    assert (after["count"], after["taken_up"]) == (560, 0)
    assert after["expected_net"] == x["expected_net"] + STEPS[0]
