"""Time and filament of a file: the plan without steps."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.job.budget_use import BudgetUse, budget_use
from passo.job.program import run_program
from passo.printer.commands import Commands

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


@dataclass(frozen=True, slots=True)
class Estimate:
    """Figures of a plan. Heating takes no time here: it depends on the room. `errors` are those of
    an estimate that failed, whose figures are 0."""

    file: str
    machine: str
    total_s: float = 0.0
    move_s: float = 0.0
    dwell_s: float = 0.0
    moves: int = 0
    layers: int = 0
    filament_mm: dict[str, float] = field(default_factory=dict[str, float])
    layers_s: list[float] = field(default_factory=list[float], repr=False)
    features_s: dict[str, float] = field(default_factory=dict[str, float])
    limits_s: dict[str, float] = field(default_factory=dict[str, float])
    budget: BudgetUse = field(default_factory=BudgetUse)
    warnings: list[str] = field(default_factory=list[str])
    errors: list[str] = field(default_factory=list[str])

    def as_dict(self) -> dict[str, Any]:
        """All fields, for JSON."""
        return asdict(self)


def estimate(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    *,
    clamp: bool = False,
    ignore_tools: bool = False,
) -> Estimate:
    """Plans the file on the machine. Raises InputError."""
    spec = machine.core_spec()
    job = _core.Job(spec, False, clamp, ignore_tools)
    commands = Commands.of_plan(machine, job)
    for _ in run_program(job, commands, path):
        pass
    plan = job.statistics()
    return Estimate(
        file=str(path),
        machine=machine.name,
        total_s=plan["move_s"] + plan["dwell_s"],
        move_s=plan["move_s"],
        dwell_s=plan["dwell_s"],
        moves=plan["moves"],
        layers=plan["layers"],
        filament_mm=dict(
            zip((row["name"] for row in spec["extruders"]), plan["filament_mm"], strict=True)
        ),
        layers_s=plan["layer_s"],
        features_s=plan["feature_s"],
        limits_s=plan["limit_s"],
        budget=budget_use(plan, machine),
        warnings=commands.warnings(str(path)),
    )
