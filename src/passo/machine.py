"""Machines as a library: load one, plan a file on it, look at its moves and steps."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo import _core, config
from passo.job.program import run_program
from passo.printer.commands import Commands

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.result import PrintResult


@dataclass(frozen=True, slots=True)
class PlannedMove:
    """A planned move and what bound it. Times in s from the start of the file, lengths in mm;
    `core` has all figures, and `steps` solves its step times."""

    core: _core.Move
    start_s: float
    end_s: float
    speed_limit: str
    accel_limit: str
    feature: str

    @property
    def line(self) -> int:
        """Line of the file."""
        return self.core.line


class Machine:
    """A machine from its file. Immutable; every call may run in its own thread."""

    def __init__(self, machine: MachineConfig) -> None:
        self.config = machine
        self._spec = machine.core_spec()

    @classmethod
    def load(cls, name_or_path: str | os.PathLike[str]) -> Machine:
        """The shipped machine of that name, or the one in that TOML file. Raises ConfigError."""
        return cls(config.load(name_or_path))

    def plan(self, path: str | os.PathLike[str]) -> Iterator[PlannedMove]:
        """The moves of a file as planned, in order; memory does not grow with the file.

        Raises InputError when the file cannot be read or asks for what the machine cannot do.
        """
        job = _core.Job(self._spec, False)
        job.keep_moves(True)
        commands = Commands.of_plan(self.config, job)
        limits = job.limit_names
        for _ in run_program(job, commands, path):
            yield from self._moves(job, limits)

    def step_times_s(self, moves: Iterator[PlannedMove], stepper: str) -> Iterator[float]:
        """Ideal time of every step of a motor along these moves, in s."""
        names = [row["name"] for row in self._spec["steppers"]]
        solver = _core.Motion(self._spec, True)
        hz, count = self.config.board.clock_hz, 0
        for move in moves:
            ticks, count = solver.ideal_ticks(move.core, names.index(stepper), count)
            yield from (tick / hz for tick in ticks)

    def print(self, path: str | os.PathLike[str]) -> PrintResult:
        """Prints a file on the machine's board, in virtual time if that is simulated."""
        from passo.job.printing import Print

        return Print(self.config).run(path)

    def _moves(self, job: _core.Job, limits: list[str]) -> Iterator[PlannedMove]:
        features, hz = job.feature_names, self.config.board.clock_hz
        for move in job.take_moves():
            yield PlannedMove(
                move,
                move.start_ticks / hz,
                move.end_ticks / hz,
                limits[move.speed_limit],
                limits[move.accel_limit],
                features[move.feature],
            )
