"""Estimates time and filament of a file: plans it without steps, and simulates the heating."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any, BinaryIO

from passo import _core
from passo.errors import InputError, Problem
from passo.job.batch.board_load import BudgetUse, budget_use
from passo.job.batch.heating import Heating
from passo.job.batch.program import refuse_stop, run_open_program, with_option
from passo.job.batch.rehearsal import RehearsedCommands
from passo.job.batch.source import open_source
from passo.job.batch.toolpath import encoded_toolpath
from passo.printer.commands.program import Commands
from passo.printer.macros import Macros
from passo.printer.saved_variables import SavedVariables
from passo.printer.unfit_commands import NOTHING, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.wait_requests import Wait

_LOOK_S = 0.5  # interval of the checks of filament that may be cold


@dataclass(frozen=True, slots=True)
class Estimate:
    """Figures of a plan. `total_s` is the sum of `moving_s`, `dwell_s` and `heating_s`.

    `heating_s` is the time for which the file waits for temperatures on the simulated printer of
    the machine file, starting at 25 °C; a real printer differs. `layers_s` has the time of moves
    and dwells of each of the `layers`; `before_layers_s` is the time before the first one. An
    estimate that failed has `errors`, and its figures are 0.
    """

    file: str
    machine: str
    total_s: float = 0.0
    moving_s: float = 0.0
    heating_s: float = 0.0
    dwell_s: float = 0.0
    moves: int = 0
    layers: int = 0
    filament_mm: dict[str, float] = field(default_factory=dict[str, float])
    layers_s: list[float] = field(default_factory=list[float], repr=False)
    before_layers_s: float = 0.0
    features_s: dict[str, float] = field(default_factory=dict[str, float])
    limits_s: dict[str, float] = field(default_factory=dict[str, float])
    budget: BudgetUse = field(default_factory=BudgetUse)
    warnings: list[str] = field(default_factory=list[str])
    errors: list[str] = field(default_factory=list[str])

    def as_dict(self) -> dict[str, Any]:
        """All fields, for JSON."""
        return asdict(self)


class _FilamentCheck:
    """Ends an estimate at filament that moves before its hotend is warm, as a print ends there."""

    def __init__(self, commands: RehearsedCommands, heating: Heating, job: _core.Job) -> None:
        self._commands, self._heating, self._job = commands, heating, job
        self._hz = commands.machine.board.clock_hz
        self._filament_mm: list[float] | None = None  # None while the hotend is warm enough

    def guard(self) -> None:
        """Allows later lines to move filament only if its hotend is warm, or may become warm."""
        self._commands.guard(self._job.clock)

    def horizon(self) -> float:
        """The clock of the plan at which `look` is due."""
        if not self._commands.unsure:
            return inf
        return self._job.clock + self._job.plan.queued_ticks + _LOOK_S * self._hz

    def look(self, name: str) -> None:
        """Raises InputError, with `name` as the file."""
        commands = self._commands
        if not commands.unsure:
            self._filament_mm = None
            return
        self._heating.catch_up()
        moved = self._job.results.statistics()["filament_mm"]
        cold = not commands.cold.warm(self._heating.heaters, self._job.tool)
        if cold and self._filament_mm not in (None, moved):
            raise InputError([with_option(Problem("input.cold", name, self._job.line or None))])
        self._filament_mm = moved
        self.guard()


def estimate(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    *,
    skips: Skips = NOTHING,
    checked: bool = True,
) -> Estimate:
    """Plans the file on the machine, without steps, by the rule of its print. See `estimate_open`.
    Raises InputError and MachineError."""
    with open_source(path) as source:
        size = os.fstat(source.fileno()).st_size
        return estimate_open(machine, source, size, str(path), skips=skips, checked=checked)


def estimate_open(
    machine: MachineConfig,
    source: BinaryIO,
    size: int,
    name: str,
    *,
    skips: Skips = NOTHING,
    checked: bool = True,
    take_path: Callable[[bytes], None] | None = None,
    saved: Mapping[str, Any] | None = None,
) -> Estimate:
    """Like `estimate`, for an open file of `size` bytes, which is at its beginning. `skips` is what
    it may do in place of a failure; without `checked` the machine counts as homed and warm, and
    refused commands are warnings. `take_path` is called with the planned path, see toolpath.py.
    `saved` are the variables of SAVE_VARIABLE. Also raises the errors of reading."""
    spec = machine.core_spec()
    job = _core.Job(spec, False, skips.clamp, skips.ignore_tools)
    if take_path:
        job.results.keep_toolpath()
    heating = Heating(machine, job)
    full = [1] * len(machine.timed_outputs)
    macros = Macros(machine, SavedVariables(saved))
    if checked:
        commands = RehearsedCommands(
            machine, job, heating, full, heating.heaters, heating.catch_up, macros=macros
        )
        check = _FilamentCheck(commands, heating, job)
        check.guard()
    else:
        commands, check = Commands(machine, job, heating, full, macros=macros), None

    def settle(wait: Wait) -> None:
        if check:
            refuse_stop(wait, name)
        heating.settle(wait, commands)
        if check:
            check.guard()

    horizon = check.horizon if check else lambda: inf
    allowed = skips.on(machine)
    for _ in run_open_program(job, commands, source, size, name, settle, allowed, horizon=horizon):
        if check:
            check.look(name)
    if take_path:
        heating.catch_up()
        take_path(encoded_toolpath(job, heating.targets))
    plan = job.results.statistics()
    layers, layers_s = plan["layers"], plan["layer_s"]
    # If a file has layer marks, moves before the first mark belong to no layer.
    counted_s = layers_s[1 : layers + 1]
    return Estimate(
        file=name,
        machine=machine.name,
        total_s=plan["move_s"] + plan["dwell_s"] + heating.seconds,
        moving_s=plan["move_s"],
        heating_s=heating.seconds,
        dwell_s=plan["dwell_s"],
        moves=plan["moves"],
        layers=layers,
        filament_mm=dict(
            zip((row["name"] for row in spec["extruders"]), plan["filament_mm"], strict=True)
        ),
        layers_s=counted_s + [0.0] * (layers - len(counted_s)),
        before_layers_s=sum(layers_s) - sum(counted_s),
        features_s=plan["feature_s"],
        limits_s=plan["limit_s"],
        budget=budget_use(plan, machine),
        warnings=commands.warnings(name) + heating.warnings(name),
    )
