"""Straight moves beside the program: they are refused where they would leave the machine's limits,
or are too long, and then nothing has changed."""

from __future__ import annotations

from math import nan

import pytest
from tests.scenarios.test_extruder_axes import text

from passo import config
from passo._core import Fault, Job, JobStatus, Within

from .driver import spec

X, Y, Z, E, U = range(5)


def places(**mm: float) -> list[float]:
    return [mm.get(letter, nan) for letter in "XYZEUVWA"]


def started(machine: str = "i3") -> Job:
    """At X 10, with a move that is planned and not settled."""
    job = Job(spec(machine), True)
    job.feed(b"G1 X10 F3000\n")
    assert job.advance() == JobStatus.NEED_INPUT
    return job


def net(job: Job) -> dict[str, int]:
    return {s["name"]: s["net"] for s in job.motors.statistics()}


@pytest.mark.parametrize(
    ("target", "within", "error"),
    [
        ({"X": 250.1}, Within.LIMITS, (Fault.OUT_OF_RANGE, "x", 250.1, 250)),
        ({"X": 20, "Z": -0.1}, Within.LIMITS, (Fault.OUT_OF_RANGE, "z", -0.1, 0)),
        ({"E": -1e8}, Within.LIMITS, (Fault.TOO_LONG, "e", -1e8, 10_000)),
        ({"E": 10_001}, Within.REACH, (Fault.TOO_LONG, "e", 10_001, 10_000)),
        ({"E": 10_001}, Within.ANYTHING, (Fault.TOO_LONG, "e", 10_001, 10_000)),
    ],
)
def test_a_move_that_is_refused_changes_nothing(target, within, error):
    job = started()
    assert not job.plan.move_to(places(**target), 20.0, within)
    assert job.error[1:5] == error
    assert job.machine_position[:4] == [10, 0, 0, 0]
    assert job.plan.move_to(places(X=20), 20.0)
    job.flush()
    assert job.machine_position[:4] == [20, 0, 0, 0]
    assert net(job) == {"x": 1600, "y": 0, "z": 0, "e": 0}


def test_move_from_outside_the_limits_is_allowed():
    job = started()
    assert job.plan.move_to(places(X=-0.5), 20.0, Within.REACH)
    assert job.plan.move_to(places(Z=1), 20.0)  # an axis that stays may be beyond
    job.flush()
    assert net(job) == {"x": -40, "y": 0, "z": 400, "e": 0}


def test_arms_move_to_every_reachable_point():
    job = Job(spec("delta"), True)
    z = job.machine_position[Z]
    assert not job.plan.move_to(places(X=1e4), 20.0, Within.REACH)
    assert job.error[1] in (Fault.ACTUATOR, Fault.UNREACHABLE)
    assert job.machine_position[:3] == [0, 0, z]


@pytest.mark.parametrize("way", [20_000, -20_000])
def test_filament_of_an_axis_without_tools_is_bounded_too(way):
    job = Job(config.load_text(text()).core_spec(), True)
    assert not job.plan.move_to(places(U=way), 20.0)
    assert job.error[1:5] == (Fault.TOO_LONG, "u", way, 10_000)
    job.feed(f"G1 U{way}\n".encode())
    assert job.advance() == JobStatus.ERROR
    assert job.error[1:5] == (Fault.TOO_LONG, "u", way, 10_000)
    job.abandon()
    job.feed(b"G1 U-1\n")
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()
    assert job.machine_position[U] == -1
