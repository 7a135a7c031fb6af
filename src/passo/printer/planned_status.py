"""The status of a program without a printer, as its macros would see it on the printer."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING

from passo.motion.axis_slots import slot_of_axis
from passo.printer.print_objects import objects_of
from passo.printer.status import (
    AxisStatus,
    BedStatus,
    BoardStatus,
    HeaterStatus,
    JobStatus,
    MotionStatus,
    PrinterState,
    RetractionStatus,
    SensorStatus,
    Status,
)
from passo.probes.base import SensingProbe
from passo.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo import _core
    from passo.config.machine import MachineConfig


@dataclass(frozen=True, slots=True)
class PlannedFile:
    """The file of a program, and its size in bytes."""

    path: str
    size: int


def planned_status(
    machine: MachineConfig,
    job: _core.Job,
    file: PlannedFile | None,
    heaters: dict[str, HeaterStatus],
    fans: Mapping[str, float],
    outputs: Mapping[str, float],
    babysteps_mm: Mapping[str, float],
) -> Status:
    """The status at the end of the plan, which counts as done. `file` is None for a program that is
    not a file."""
    axes, locked, program = machine.moved_axes, job.locked_axes, job.program_position
    position_mm = {name: program[i] for i, name in axes.items()} | {"e": program[-1]}
    homed = frozenset(name for i, name in axes.items() if i not in locked)
    return Status(
        state=PrinterState.PRINTING,
        halted="",
        time_s=job.clock / machine.board.clock_hz,
        position_mm=position_mm,
        homed=homed,
        tool=job.tool,
        heaters=heaters,
        fans={name: fans.get(name, 0.0) for name in machine.fans},
        speed_factor=job.limits.speed_factor,
        motion=MotionStatus.of(job),
        axes={
            name: AxisStatus(
                position_mm=position_mm[name],
                machine_mm=job.machine_position[slot_of_axis(i)],
                homed=name in homed,
                min_mm=machine.axes[name].min_mm,
                max_mm=machine.axes[name].max_mm,
                babystep_mm=babysteps_mm.get(name, 0.0),
            )
            for i, name in axes.items()
        },
        boards={
            name or "main": BoardStatus(__version__, board.mcu, float(board.clock_hz), True, 0, 0)
            for name, board in machine.all_boards.items()
        },
        flow_factors=list(job.filament.flows),
        progress=_fraction(job, file),
        job=_job(machine, job, file) if file else None,
        bed=_unmeasured(machine),
        retraction=RetractionStatus.of(job) if machine.extruders else None,
        outputs=dict(outputs),
        sensors={
            name: SensorStatus(shown.ambient_c, shown.ambient_c, shown.ambient_c)
            for name, shown in machine.sensors.items()
        },
    )


def _fraction(job: _core.Job, file: PlannedFile | None) -> float | None:
    return min(job.program.offset / file.size, 1.0) if file and file.size else None


def _job(machine: MachineConfig, job: _core.Job, file: PlannedFile) -> JobStatus:
    plan = job.results.statistics()
    current = job.objects.of_line(job.line)
    done_s = job.clock / machine.board.clock_hz
    return JobStatus(
        file=PurePath(file.path).name,
        fraction=_fraction(job, file) or 0.0,
        line=job.line,
        layer=plan["layers"],
        layers=None,
        printed_s=done_s,
        left_s=None,
        objects=objects_of(job),
        current_object=current if current >= 0 else None,
        path=PurePath(file.path).name,
        size=file.size,
        offset=job.program.offset,
        elapsed_s=done_s,
        filament_mm=sum(plan["filament_mm"]),
        extruding_s=done_s,
    )


def _unmeasured(machine: MachineConfig) -> BedStatus | None:
    """The bed of a printer before its first measurement, without stored settings."""
    probe = machine.probe
    if probe is None:
        return None
    dx, dy = probe.offset_mm
    homing = machine.homing.get("z")
    return BedStatus(
        method=machine.levelling.method,
        on=False,
        profile="",
        points=(),
        rms_mm=None,
        left_rms_mm=None,
        surface=None,
        fade_mm=None,
        probe=probe.kind,
        probe_offset_mm=(dx, dy),
        trigger_height_mm=probe.trigger_height_mm if isinstance(probe, SensingProbe) else 0.0,
        measured=0,
        to_measure=0,
        manual=None,
        mesh=None,
        meshes={},
        triggered=False,
        holds_babysteps=homing is not None and homing.probe,
    )
