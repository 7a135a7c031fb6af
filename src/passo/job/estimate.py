"""Time and filament of a file: the plan without steps."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from passo import _core
from passo.errors import InputError
from passo.job.source import chunks, open_source, problem_of
from passo.printer.commands import Commands
from passo.printer.words import Command

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


@dataclass(frozen=True, slots=True)
class Estimate:
    """Figures of a plan. Heating takes no time here: it depends on the room."""

    file: str
    machine: str
    total_s: float
    move_s: float
    dwell_s: float
    moves: int
    layers: int
    filament_mm: dict[str, float]
    layers_s: list[float] = field(repr=False)
    features_s: dict[str, float]
    limits_s: dict[str, float]
    warnings: list[str]

    def as_dict(self) -> dict[str, Any]:
        """All fields, for JSON."""
        return asdict(self)


class NoHeat:
    """Temperatures are taken as reached."""

    def set_target(self, heater: str, celsius: float) -> None:
        """Nothing heats in an estimate."""

    def wait_for(self, heaters: list[str]) -> None:
        """Nothing waits in an estimate."""


def plan_file(
    machine: MachineConfig, path: str | os.PathLike[str], job: _core.Job
) -> tuple[Commands, list[str]]:
    """Runs a file through a job that makes no steps. Raises InputError."""
    name = str(path)
    outputs = len(machine.heaters) + len(machine.fans) + 1
    commands = Commands(machine, job, NoHeat(), [1] * outputs)
    status = _core.JobStatus
    with open_source(path) as source:
        pieces = chunks(source, name)
        while not commands.ended:
            found = job.advance()
            if found == status.EVENT:
                commands.run(Command(*job.event))
            elif found == status.NEED_INPUT:
                data = next(pieces, b"")
                if data:
                    job.feed(data)
                else:
                    job.finish()
            elif found == status.ERROR:
                raise InputError([problem_of(job, name)])
            else:
                break
    job.flush()
    return commands, commands.warnings(name, job.statistics()["clamped"])


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
    _, warnings = plan_file(machine, path, job)
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
        warnings=warnings,
    )
