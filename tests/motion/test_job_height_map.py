"""The heights of the bed under a program: what it says is Z stays above the bed."""

from __future__ import annotations

from math import floor

import pytest

from passo import config
from passo._core import Job, JobStatus

PLANE = ((0.0, 0.0), (100.0, 100.0), [[0.0, 1.0], [0.0, 1.0]])  # 0.01 mm for each mm of X


def run(job, text):
    job.feed(text.encode())
    assert job.advance() == JobStatus.NEED_INPUT
    job.flush()


def z_of_motor(job):
    (row,) = (r for r in job.motors.statistics() if r["name"] == "z")
    return row["count"], row["steps_per_unit"]


@pytest.fixture
def job():
    job = Job(config.load("i3").core_spec(), True, False, False)
    job.axes.set([(0, 0.0), (1, 0.0), (2, 5.0)], True)
    return job


def test_a_program_follows_the_bed(job):
    run(job, "G1 X50 Y50 Z5 F6000\n")
    count, per_mm = z_of_motor(job)
    assert count == floor(5 * per_mm + 0.5)
    job.bed.set_height_map(*PLANE)
    assert z_of_motor(job)[0] == count
    assert job.program_position[2] == pytest.approx(4.5)
    run(job, "G1 X80\n")  # Z stays at 4.5 above the bed
    assert z_of_motor(job)[0] == floor((4.5 + 0.8) * per_mm + 0.5)
    run(job, "G1 Z0.2\n")
    assert z_of_motor(job)[0] == floor((0.2 + 0.8) * per_mm + 0.5)
    job.bed.set_height_map(*PLANE[:2], [])
    assert job.program_position[2] == pytest.approx(1.0)


def test_offsets_of_a_program_outlast_a_new_map(job):
    run(job, "G1 X50 Y50 Z5 F6000\nG92 Z1\n")
    job.bed.set_height_map(*PLANE)
    assert job.program_position[2] == pytest.approx(0.5)
    run(job, "G1 Z1\n")
    _, per_mm = z_of_motor(job)
    assert z_of_motor(job)[0] == floor((5 + 0.5) * per_mm + 0.5)


def test_height_of_the_nozzle_and_z_of_the_plan_are_inverse(job):
    job.bed.set_height_map(*PLANE, (1.0, 3.0, 0.25))
    for z, height in ((0.5, 1.3), (1.0, 1.8), (2.0, 2.525), (3.0, 3.25), (9.0, 9.25)):
        assert job.bed.nozzle_height(80.0, 30.0, z) == pytest.approx(height, abs=1e-12)
        assert job.bed.plan_z(80.0, 30.0, height) == pytest.approx(z, abs=1e-12)


def test_bed_height_is_taken_below_the_active_nozzle():
    job = Job(config.load("dual-extruder").core_spec(), True, False, False)  # T1: 25 mm in X
    job.axes.set([(0, 0.0), (1, 0.0), (2, 5.0)], True)
    job.bed.set_height_map(*PLANE)
    run(job, "G1 X50 Y50 Z1 F6000\n")
    assert z_of_motor(job)[0] == 1.5 * z_of_motor(job)[1]
    for line, at in [("T1", None), ("G1 X50", 1.5), ("G1 Y20", 1.5), ("G1 X80 Z2", 2.8)]:
        job.feed(f"{line}\n".encode())
        before = z_of_motor(job)[0]
        while job.advance() == JobStatus.EVENT:
            job.flush()
            assert job.bed.is_apart
            job.bed.follow_tool()
            assert not job.bed.is_apart
        job.flush()
        if at is None:
            assert z_of_motor(job)[0] == before
        else:
            assert z_of_motor(job)[0] == pytest.approx(at * z_of_motor(job)[1], abs=0.5)
    assert job.program_position[2] == pytest.approx(2.0)
