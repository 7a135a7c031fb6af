"""The status of the printer in OctoPrint's format."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.printer.status import HeaterStatus, PrinterState, Status
from passo.web.slicers.printing import heaters, is_printing

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.web.bridge import Bridge

_KINDS = (("tool{}", "hotend"), ("bed", "bed"), ("chamber", "chamber"))


def state_text(status: Status) -> str:
    """The state as OctoPrint shows it."""
    if status.state is PrinterState.HALTED:
        return f"Error: {status.halted}"
    words = {PrinterState.PRINTING: "Printing", PrinterState.PAUSED: "Paused"}
    return words.get(status.state, "Operational")


def printer_state(bridge: Bridge) -> dict[str, Any]:
    """Temperatures in °C, and flags."""
    status = bridge.latest().status
    halted = status.state is PrinterState.HALTED
    temperatures: dict[str, Any] = {}
    for name, kind in _KINDS:
        for number, heater in enumerate(heaters(bridge, status, kind)):
            if number == 0 or "{}" in name:
                temperatures[name.format(number)] = _temperature(heater)
    flags = {
        "operational": not halted,
        "printing": status.state is PrinterState.PRINTING,
        "paused": status.state is PrinterState.PAUSED,
        "pausing": False,
        "resuming": False,
        "cancelling": False,
        "finishing": False,
        "ready": not halted and not is_printing(status),
        "sdReady": status.files.mounted,
        "error": halted,
        "closedOrError": halted,
    }
    state = {"text": state_text(status), "flags": flags, "error": status.halted}
    return {"temperature": temperatures, "sd": {"ready": status.files.mounted}, "state": state}


def job_state(bridge: Bridge) -> dict[str, Any]:
    """The current print, or the selected file; times in s, `completion` in percent."""
    status = bridge.latest().status
    job, path = status.job, status.files.selected
    name = path.rpartition("/")[2] or None
    file: dict[str, Any] = {"name": name, "display": name, "path": path.removeprefix("/") or None}
    file |= {"origin": "local" if path else None, "size": job.size if job else None, "date": None}
    progress: dict[str, Any] = dict.fromkeys(
        ("completion", "filepos", "printTime", "printTimeLeft", "printTimeLeftOrigin")
    )
    total = None
    if job is not None:
        progress |= {
            "completion": job.fraction * 100,
            "filepos": job.offset,
            "printTime": int(job.printed_s),
            "printTimeLeft": None if job.left_s is None else int(job.left_s),
            "printTimeLeftOrigin": None if job.left_s is None else "analysis",
        }
        total = None if job.left_s is None else job.printed_s + job.left_s
    about = {"file": file, "estimatedPrintTime": total, "filament": None, "user": None}
    return {"job": about, "progress": progress, "state": state_text(status)}


def printer_profile(machine: MachineConfig) -> dict[str, Any]:
    """The machine; lengths in mm, speeds in mm/min."""
    kinds = {heater.kind for heater in machine.heaters.values()}
    axes = machine.axes
    spans = {name: axis.max_mm - axis.min_mm for name, axis in axes.items()}
    volume = {"width": spans.get("x"), "depth": spans.get("y"), "height": spans.get("z")}
    return {
        "id": "_default",
        "name": machine.name,
        "model": machine.name,
        "current": True,
        "default": True,
        "heatedBed": "bed" in kinds,
        "heatedChamber": "chamber" in kinds,
        "extruder": {"count": max(len(machine.tools), 1), "sharedNozzle": False},
        "volume": {**volume, "formFactor": "rectangular", "origin": "lowerleft"},
    }


def _temperature(heater: HeaterStatus) -> dict[str, float | None]:
    return {"actual": heater.current_c, "target": heater.target_c, "offset": 0}
