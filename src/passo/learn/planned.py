"""Plans a few lines of G-code for an experiment, with the planner that prints use."""

from __future__ import annotations

from functools import cache
from io import BytesIO
from typing import TYPE_CHECKING

from passo import _core, config
from passo.job.batch.program import run_open_program
from passo.printer.commands.program import Commands

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


@cache
def shipped(name: str) -> MachineConfig:
    """A machine that comes with Passo."""
    return config.load(name)


def planned(text: str, machine: MachineConfig) -> tuple[list[_core.Move], list[str]]:
    """The moves of the lines as the planner plans them, and the names of the limits to which
    `speed_limit` and `accel_limit` are indices. Raises InputError."""
    job = _core.Job(machine.core_spec(), False)
    job.results.keep_moves(True)
    source = text.encode()
    moves: list[_core.Move] = []
    commands = Commands.of_plan(machine, job)
    for _ in run_open_program(job, commands, BytesIO(source), len(source), "lesson.gcode"):
        moves += job.results.take_moves()
    return moves, job.limits.names
