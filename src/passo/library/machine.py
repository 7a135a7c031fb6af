"""Machines as a library: load one, plan a file on it, read its moves and steps."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo import _core, config
from passo.job.batch.program import run_program
from passo.motion.axis_slots import slot_of_axis
from passo.printer.commands.program import Commands

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.estimate import Estimate
    from passo.job.batch.result import PrintResult
    from passo.job.batch.step_trace import StepTrace


@dataclass(frozen=True, slots=True)
class PlannedMove:
    """A planned move and the limits that bound it. Times are in s from the start of the file,
    lengths in mm. `core` has all figures, and `steps` solves the step times."""

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

        Raises InputError if the file cannot be read or demands what the machine cannot do.
        """
        job = _core.Job(self._spec, False)
        job.results.keep_moves(True)
        commands = Commands.of_plan(self.config, job)
        limits = job.limits.names
        for _ in run_program(job, commands, path):
            yield from self._moves(job, limits)

    def step_times_s(self, moves: Iterator[PlannedMove], stepper: str) -> Iterator[float]:
        """Ideal time of every step of a motor along these moves, in s.

        Raises ValueError for a motor that the machine does not have.
        """
        rows = self._spec["steppers"]
        names = [row["name"] for row in rows]
        if stepper not in names:
            raise ValueError(f"there is no motor {stepper!r}, but {', '.join(names)}")
        i = names.index(stepper)
        solver, hz = _core.Motion(self._spec, True), self.config.board.clock_hz
        slots = [slot_of_axis(axis) for axis in range(len(self._spec["axes"]))]
        count, place = 0, None
        for move in moves:
            start, end = ([at[s] for s in slots] for at in (move.core.start_mm, move.core.end_mm))
            # This is the first move, or homing has set the axes; filament continues from its
            # position.
            if start != place and rows[i]["drive"] != "extruder":
                solver.set_position([*start, 0.0])
                count = solver.counts()[i]
            ticks, count = solver.ideal_ticks(move.core, i, count)
            place = end
            yield from (tick / hz for tick in ticks)

    def estimate(
        self,
        path: str | os.PathLike[str],
        *,
        clamp: bool = False,
        ignore_tools: bool = False,
        assume_ready: bool = False,
        skip_unknown: bool = False,
        skip_levelling: bool = False,
    ) -> Estimate:
        """Time and filament of a file, without a board and without steps: see `Estimate`.

        It fails at the errors that stop the print of the file, see `print`. `clamp` moves targets
        beyond the machine's limits to the limit. `ignore_tools` continues with the current tool if
        the machine lacks one. The others are those of `print`. Raises InputError, MachineError.
        """
        from passo.job.batch.estimate import estimate
        from passo.printer.unfit_commands import Skips

        skips = Skips(skip_unknown, skip_levelling, clamp=clamp, ignore_tools=ignore_tools)
        return estimate(self.config, path, skips=skips, checked=not assume_ready)

    def trace(
        self,
        path: str | os.PathLike[str],
        *,
        from_s: float = 0.0,
        to_s: float | None = None,
        ideal: bool = False,
        clamp: bool = False,
        ignore_tools: bool = False,
    ) -> StepTrace:
        """Prints a file as `print` does and returns every step that each motor made from `from_s`
        to `to_s` of print time: see `StepTrace`. With `ideal` the trace holds the ideal times, too;
        `clamp` and `ignore_tools` are those of `estimate`. Raises InputError, MachineError.
        """
        from passo.job.batch.policy import Policy
        from passo.job.batch.step_trace import trace_steps

        policy = Policy(clamp=clamp, ignore_tools=ignore_tools)
        return trace_steps(self.config, path, policy, from_s=from_s, to_s=to_s, ideal=ideal)

    def print(
        self,
        path: str | os.PathLike[str],
        *,
        assume_ready: bool = False,
        skip_unknown: bool = False,
        skip_levelling: bool = False,
    ) -> PrintResult:
        """Prints a file on a simulated board of this machine, in virtual time.

        The print fails at the same errors that stop a print from the SD card of a served printer.
        `assume_ready` treats the machine as homed and its hotends as warm, for a piece of G-code;
        `skip_unknown` leaves out unknown commands that may move the machine, and `skip_levelling`
        the levelling of the bed without a probe. Raises InputError, MachineError.
        """
        from passo.job.batch.policy import Policy
        from passo.job.batch.simulated_print import Print
        from passo.printer.unfit_commands import Skips

        skips = Skips(unknown=skip_unknown, levelling=skip_levelling)
        policy = Policy(checked=not assume_ready, skips=skips)
        return Print(self.config, policy).run(path)

    def _moves(self, job: _core.Job, limits: list[str]) -> Iterator[PlannedMove]:
        features, hz = job.program.feature_names, self.config.board.clock_hz
        for move in job.results.take_moves():
            yield PlannedMove(
                move,
                move.start_ticks / hz,
                move.end_ticks / hz,
                limits[move.speed_limit],
                limits[move.accel_limit],
                features[move.feature],
            )
