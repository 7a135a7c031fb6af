"""Estimates time and filament of a file: plans it without steps, and simulates the heating."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, BinaryIO

from passo import _core
from passo.job.batch.board_load import BudgetUse, budget_use
from passo.job.batch.heating import Heating
from passo.job.batch.program import run_open_program
from passo.job.batch.source import open_source
from passo.job.batch.toolpath import encoded_toolpath
from passo.printer.cold_extrusion import ColdExtrusion
from passo.printer.commands.program import Commands
from passo.printer.unfit_commands import ALL, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.gcode.command import Command
    from passo.printer.wait_requests import Reply, Wait


_COLD = (
    "filament moves, and no hotend is heated. Heat the hotend before the print (M109), or the print"
    " stops at its first extrusion."
)


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


class _Commands(Commands):
    """The commands of a plan; `cold` has the settings of M302."""

    def __init__(self, machine: MachineConfig, job: _core.Job, heating: Heating) -> None:
        super().__init__(machine, job, heating, [1] * len(machine.timed_outputs))
        self.cold = ColdExtrusion(machine)

    def run(self, command: Command, reply: Reply | None = None) -> Wait | None:
        """Like `Commands.run`."""
        if command.code == "M302":
            self.cold.set(command.words())
        return super().run(command, reply)

    def stays_cold(self, hottest_c: Mapping[str, float]) -> bool:
        """Whether there are hotends, and no filament may move with these highest targets, °C."""
        hotends = self.cold.hotends
        return bool(hotends) and all(
            hottest_c.get(name, 0.0) < self.cold.min_c_of(name) for name in hotends
        )


def estimate(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    *,
    clamp: bool = False,
    ignore_tools: bool = False,
) -> Estimate:
    """Plans the file on the machine, without steps. Raises InputError."""
    with open_source(path) as source:
        size = os.fstat(source.fileno()).st_size
        skips = ALL._replace(clamp=clamp, ignore_tools=ignore_tools)
        return estimate_open(machine, source, size, str(path), skips=skips)


def estimate_open(
    machine: MachineConfig,
    source: BinaryIO,
    size: int,
    name: str,
    *,
    skips: Skips = ALL,
    take_path: Callable[[bytes], None] | None = None,
) -> Estimate:
    """Like `estimate`, for an open file of `size` bytes, which is at its beginning. `skips` is what
    it may do in place of a failure. `take_path` is called with the planned path, see toolpath.py.
    Also raises the errors of reading."""
    spec = machine.core_spec()
    job = _core.Job(spec, False, skips.clamp, skips.ignore_tools)
    if take_path:
        job.keep_toolpath()
    heating = Heating(machine, job)
    commands = _Commands(machine, job, heating)
    commands.skips = skips.on(machine)
    for _ in run_open_program(
        job, commands, source, size, name, lambda wait: heating.settle(wait, commands)
    ):
        pass
    if take_path:
        heating.finish()
        take_path(encoded_toolpath(job, heating.targets))
    plan = job.statistics()
    moves_cold = any(plan["filament_mm"]) and commands.stays_cold(heating.hottest_c)
    cold = [f"{name}: {_COLD}"] if moves_cold else []
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
        warnings=commands.warnings(name) + heating.warnings(name) + cold,
    )
