"""Motion in commits: where they fall, every tail can be told."""

from __future__ import annotations

from array import array

import pytest
from tests.oracles.motion import HZ

from passo._core import Job, JobStatus
from passo.config import load

PERIOD = 0.075 * HZ


def job(period=None):
    spec = load("i3").core_spec()
    spec["extruders"][0]["jerk"] = 8.0
    job = Job(spec)
    job.keep_ideal(True)
    if period is not None:
        job.use_commits(period, 1_000_000)
    job.feed(b"G1 X240 F6000\nG1 X0\n" * 4 + b"G1 X100\nG1 X150 E4\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    return job


@pytest.mark.parametrize("ticks", range(0, 1000, 100))
def test_a_motor_that_has_rested_long_steps_right_behind_a_commit(ticks):
    # Within the 50 µs by which the steps of a tail may miss their times.
    first = array("d", job().take_ideal(3))[0]
    assert first > 2**28
    commits = int(first / PERIOD)
    told = job(int((first - ticks) / commits))
    assert told.steppers()[3]["net"] == 382
