"""Klipper's objects of the print."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.card.local import is_local, local_name
from passo.printer.status import PrinterState

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.status import JobStatus, PrintObject, Status

Object = dict[str, Any]

_ENDS = {"done": "complete", "cancelled": "cancelled", "failed": "error"}


def print_stats(status: Status) -> Object:
    """The current print, or the last one as long as its file is selected. The printing time begins
    with the first extrusion, and excludes pauses. The total time is never less than the time
    without pauses, even if print time runs faster than real time."""
    job, ended = status.job, status.ended
    state, message = "standby", ""
    if job is None and ended is not None:
        job, state, message = ended.job, _ENDS[ended.outcome], ended.reason
    elif job is not None:
        state = "paused" if status.state is PrinterState.PAUSED else "printing"
    return {
        "state": state,
        "filename": _name(job) if job else "",
        "print_duration": job.extruding_s if job else 0.0,
        "total_duration": max(job.elapsed_s, job.printed_s) if job else 0.0,
        "filament_used": job.filament_mm if job else 0.0,
        "message": message,
        "info": _layers(job),
    }


def _layers(job: JobStatus | None) -> Object:
    """The layers that the slicer has announced, or else the counted ones."""
    if job is None:
        return {"total_layer": None, "current_layer": None}
    total, current = job.slicer_layers, job.slicer_layer
    return {
        "total_layer": job.layers if total is None else total,
        "current_layer": job.layer if current is None else current,
    }


def virtual_sdcard(status: Status) -> Object:
    """The file that is printed, or the last one as long as it is selected. Its progress is the
    fraction of its bytes."""
    job = status.job or (status.ended.job if status.ended else None)
    return {
        "is_active": status.job is not None and status.state is not PrinterState.PAUSED,
        "progress": job.offset / job.size if job and job.size else 0.0,
        "file_path": f"{status.files.folder}/{_name(job)}" if job else None,
        "file_position": job.offset if job else 0,
        "file_size": job.size if job else 0,
    }


def pause_resume(status: Status) -> Object:
    """Whether the print is paused."""
    return {"is_paused": status.job is not None and status.state is PrinterState.PAUSED}


def display_status(status: Status) -> Object:
    """The progress of the print, and the text of M117."""
    return {"progress": status.progress or 0.0, "message": status.message or None}


def idle_timeout(machine: MachineConfig, status: Status) -> Object:
    """Whether the printer is idle, ready or printing; any move counts as printing. A paused print
    whose hotend is off after a long pause is idle, too."""
    busy = status.state in (PrinterState.PRINTING, PrinterState.BUSY)
    rests = "Ready" if status.motion.motors_on and not status.cooled_c else "Idle"
    return {
        "state": "Printing" if busy else rests,
        "printing_time": status.moving_s,
        "idle_timeout": machine.idle.motors_off_s,
    }


def exclude_object(status: Status) -> Object:
    """The objects of the print, and which are cancelled."""
    known = status.job.objects if status.job else ()
    current = status.job.current_object if status.job else None
    return {
        "objects": [_object(one) for one in known],
        "excluded_objects": [_object_name(one) for one in known if one.cancelled],
        "current_object": None if current is None else _object_name(known[current]),
    }


def _object(one: PrintObject) -> Object:
    found: Object = {"name": _object_name(one)}
    if one.centre_mm is not None:
        found["center"] = list(one.centre_mm)
    if one.outline_mm:
        found["polygon"] = [list(point) for point in one.outline_mm]
    return found


def _object_name(one: PrintObject) -> str:
    return one.name.upper() or str(one.number)


def _name(job: JobStatus) -> str:
    """The path of a file on the card in the form of clients, or the name of a file of this
    computer."""
    return local_name(job.path) if is_local(job.path) else job.path.lstrip("/") or job.file
