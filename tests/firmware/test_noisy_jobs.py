"""Ten thousand short jobs over a cable that loses, spoils, doubles, swaps, delays, divides and
joins bytes and whole frames, both ways: the firmware makes every step once, at its clock."""

from __future__ import annotations

import random
from collections import Counter

import pytest
from tests.support.link_bench import HZ, MS, PLANT, START, Planner, description
from tests.support.link_bench import executed as steps_of

from passo import _core
from passo.board.connection import Connection
from passo.board.ports import InProcess
from passo.simulator import SimulatedBoard

JOBS = 2500
BYTES = (0.0, 0.001, 0.003, 0.01)  # shares of them that are spoilt
FRAMES = (0.0, 0.02, 0.05, 0.2)
KINDS = ("lost", "doubled", "swapped", "late")
LATE = ("Timer too close", "Stepper too far in past")


class Noisy:
    """The firmware at the end of a bad cable."""

    def __init__(self, seed: int) -> None:
        board = description()
        self.simulated = SimulatedBoard(board, PLANT, START, "passo")
        self.device = self.simulated.device
        self.cable = _core.Distant(self.device, 0, 0.0, MS // 4, MS // 4, seed)
        self.connection = Connection(board, InProcess(self.cable, START))
        self.connection.connect()
        for name in "xy":
            self.simulated.trace_steps(name, 0, 2**62)

    def run(
        self, plan: Planner, of_bytes: float, of_frames: float
    ) -> dict[str, tuple[list[int], list[int]]]:
        """What the motors did, by clocks since the job's first, if so many of all bytes and frames
        suffer on their way."""
        connection = self.connection
        connection.run(connection.now + HZ // 100)
        self.cable.spoil(of_bytes, of_frames)
        base = connection.start_job(plan.queue)
        end = base + max(clocks[-1] for clocks in plan.clocks.values()) + 10 * MS
        connection.pass_time(end)
        self.cable.spoil(0.0, 0.0)
        # What comes now is late, and the board says so. The link waits twice as long each time.
        connection.pass_time(end + 2 * HZ)
        connection.link.stop_job()
        return {name: steps_of(self, name, base) for name in "xy"}

    def spoilt(self) -> dict[str, int]:
        """How many whole frames suffered what."""
        return dict(zip(KINDS, self.cable.spoilt_frames, strict=True))


def short_job(generator: random.Random) -> Planner:
    plan = Planner()
    for target in (0, 1):
        plan.steps(target, generator.random() < 0.5, 20 * MS + generator.randrange(5 * MS), 1)
        for _ in range(generator.randrange(3, 9)):
            plan.steps(
                target,
                generator.random() < 0.5,
                generator.randrange(2000, 20_000),
                generator.randrange(1, 12),
                generator.randrange(-100, 100),
            )
    return plan


@pytest.mark.parametrize("part", range(4))
def test_every_step_is_made_once_and_in_time(part):
    generator = random.Random(part)
    noisy, late = Noisy(part), 0
    frames = Counter()
    for job in range(JOBS):
        plan = short_job(generator)
        done = noisy.run(plan, generator.choice(BYTES), generator.choice(FRAMES))
        fault = noisy.device.fault
        for target, name in enumerate("xy"):
            clocks, directions = done[name]
            n = len(clocks) if fault else len(plan.clocks[target])
            assert clocks == plan.clocks[target][:n], (job, fault)
            assert directions == plan.directions[target][:n]
        if fault:  # so much noise that a command came late: the board has said so
            assert fault in LATE
            late += 1
            frames.update(noisy.spoilt())
            noisy = Noisy(1000 * part + late)
    assert late < JOBS // 50  # half as many are
    frames.update(noisy.spoilt())
    assert all(frames[kind] > 500 for kind in KINDS), frames
