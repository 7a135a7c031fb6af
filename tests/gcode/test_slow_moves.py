"""Moves that take very long: they do, up to what no move may take; beyond that they are errors."""

from __future__ import annotations

from math import inf

import pytest

from passo._core import Fault, Job

from .driver import run, spec


@pytest.mark.parametrize(
    ("lines", "seconds"),
    [
        ("G1 X0.01 T100", 100),
        ("G1 E1 T100000", 100_000),
        ("G1 X0.1 F0.0001", 60_000),
        ("G1 X40 Y30 T1000000", 1_000_000),
        ("G1 E0.0001 T1000000", 1_000_000),
        ("G1 X0.00001 F0.000001", 600),
        ("F60\nG1 X100 T20", 20),
        ("G1 X100 T20 F60", 20),
        ("G1 X100 T20 F60\nG1 X0", 120),
    ],
)
def test_a_slow_move_takes_its_time(lines, seconds):
    """With T, F bounds only what follows."""
    statistics = run(f"{lines}\n").statistics
    assert statistics["move_s"] == pytest.approx(seconds, rel=1e-3 if seconds < 200 else 1e-6)


@pytest.mark.parametrize(
    ("line", "limit", "seconds"),
    [
        ("G1 X10 F0.0001", "feedrate", 6e6),
        ("G1 X10 T1000001", "duration", 1_000_001),
        ("G1 E1 T100000000", "duration", 1e8),
        ("G1 X1 F0.00000000000000000001", "feedrate", 6e21),
    ],
)
def test_move_beyond_longest_time_names_its_limit(line, limit, seconds):
    out = run(f"G1 Y5 F6000\n{line}\n")
    assert out.errors == [(2, Fault.TOO_SLOW, limit, pytest.approx(seconds), 1e6)]
    assert len(out.moves) == 1


def test_refused_slow_move_names_axis_and_leaves_position():
    job = Job(spec("unbounded"), False)
    job.results.keep_moves(True)
    job.limits.set_of_axis("x", "speed", 0.001)
    job.feed(b"G1 X1001 Y0\nG1 X1 F60\n")
    job.finish()
    job.advance()
    assert job.error[1:3] == (Fault.TOO_SLOW, "x speed")
    assert job.error[3] == pytest.approx(1_001_000)
    job.abandon()
    assert job.machine_position[0] == 0


def test_a_move_outside_of_a_program_is_refused_too():
    job = Job(spec("i3"), False)
    target = [5.0, *[inf - inf] * 7]
    assert not job.plan.move_to(target, 1e-6)
    assert job.error[1:3] == (Fault.TOO_SLOW, "feedrate")
    assert job.machine_position[0] == 0
    assert job.plan.move_to(target, 1e-5)
    assert job.machine_position[0] == 5
