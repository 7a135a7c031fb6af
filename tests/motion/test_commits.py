"""Motion in commits: where they fall, every tail can be told."""

from __future__ import annotations

from array import array

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles.motion import HZ

from passo._core import Job, JobStatus, Motion
from passo.config import load

from . import machines

PERIOD = int(0.075 * HZ)


def job(period=None):
    spec = load("i3").core_spec()
    spec["extruders"][0]["jerk"] = 8.0
    job = Job(spec)
    job.results.keep_ideal(True)
    if period is not None:
        job.commits.use(period, 1_000_000)
    job.feed(b"G1 X240 F6000\nG1 X0\n" * 4 + b"G1 X100\nG1 X150 E4\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    return job


@pytest.mark.parametrize("ticks", range(0, 1000, 100))
def test_motor_after_long_rest_steps_right_after_commit(ticks):
    # Within the 50 µs by which the steps of a tail may miss their times.
    first = array("d", job().results.take_ideal(3))[0]
    assert first > 2**28
    commits = int(first / PERIOD)
    told = job(int((first - ticks) / commits))
    assert told.motors.statistics()[3]["net"] == 382


def test_a_commit_holds_no_more_messages_than_it_may():
    """It is a message itself, behind a tail for each motor that moves."""

    def dense(most):
        job = Job(load("i3").core_spec())
        job.commits.use(PERIOD, most)
        lines = (f"G1 X{100 + i % 7 * 0.31} Y{100 + i * 5 % 11 * 0.17} F6000\n" for i in range(300))
        job.feed("".join(lines).encode())
        assert job.advance() == JobStatus.NEED_INPUT
        job.flush()
        return job, len(job.messages)

    (told, messages), (few, more) = dense(1_000_000), dense(20)
    by_time = told.clock / PERIOD + 1
    by_number = sum(motor["commands"] for motor in few.motors.statistics()) / 20
    assert by_number > 2 * by_time
    assert more - messages >= by_number - by_time
    assert few.clock == told.clock


def test_stopped_motor_gets_clock_and_direction_once():
    def messages(renews):
        job = Job(load("i3").core_spec())
        for line in (b"G1 X10 F6000\n", b"G1 X20\nG1 X200 F600\n"):
            job.feed(line)
            assert job.advance() == JobStatus.NEED_INPUT
            job.flush()
            if renews:
                job.motors.renew([0])
        return len(job.messages)

    assert messages(True) == messages(False) + 2


halves = st.sampled_from((-3, -1, 1, 3))
starts = st.lists(st.tuples(halves, st.integers(1, 1000), st.booleans()), min_size=2, max_size=12)


@given(path=starts)
@settings(max_examples=200, deadline=None)
def test_no_step_is_done_before_the_commit_that_it_follows(path):
    """Also where one is due as soon as the machine moves, and could be a little early; nor is any
    of a tail."""
    motion = Motion(machines.cartesian() | {"tolerance_s": 25e-6})
    motion.use_commits(PERIOD // 8, 1_000_000)
    x = 0.0
    for half_steps, picometres, stands in path:
        for by in (half_steps / 160 - picometres * 1e-9, half_steps / 16 * 5):
            x += by
            motion.push([x, 0.0, 0.0, 0.0], 100.0)
        if stands:
            motion.flush()
    motion.flush()
    committed = done = 0
    tail = []  # of the commit to come
    for kind, _, clock, end, interval, count, add, _ in motion.take_messages():
        if kind == "reset_clock":
            done = clock
        elif kind == "queue_step":
            assert done + interval > committed
            done = end
        elif kind == "tail":
            tail.append((interval, count, add))
        elif kind == "commit":
            committed, at = clock, done
            assert done <= committed
            for interval, count, add in tail:
                assert at + interval > committed
                at += count * interval + count * (count - 1) // 2 * add
            tail.clear()
    assert committed >= done > 0
