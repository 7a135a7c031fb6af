"""The status of the printer in the formats of RepRapFirmware and of APrinter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec

from passo.printer.status import HeaterStatus, PrinterState
from passo.web.slicers.printing import heaters

if TYPE_CHECKING:
    from passo.web.bridge import Bridge

_OFF = msgspec.Raw(b"-1e1024")  # APrinter's value for no target


def rrf_status(bridge: Bridge, kind: int) -> dict[str, Any]:
    """The status in RepRapFirmware's format. `kind` 1 is the usual report, 2 adds data of the
    machine, 3 data of the print."""
    status = bridge.latest().status
    axes = [name for name in bridge.machine.axes if name in status.axes]
    hotends, beds = (heaters(bridge, status, kind) for kind in ("hotend", "bed"))
    all_heaters = [*beds[:1], *hotends]
    found: dict[str, Any] = {
        "status": status.state.value,
        "coords": {
            "axesHomed": [int(name in status.homed) for name in axes],
            "xyz": [status.position_mm[name] for name in axes],
            "machine": [status.axes[name].machine_mm for name in axes],
            "extr": [status.position_mm.get("e", 0.0)],
        },
        "speeds": {"requested": status.motion.feedrate_mm_s, "top": status.motion.speed_mm_s},
        "currentTool": status.tool,
        "params": {
            "atxPower": int(status.power_supply),
            "fanPercent": [100 * speed for speed in status.fans.values()],
            "speedFactor": 100 * status.speed_factor,
            "extrFactors": [100 * factor for factor in status.flow_factors],
            "babystep": status.axes["z"].babystep_mm if "z" in status.axes else 0.0,
        },
        "seq": bridge.latest().version,
        "temps": {
            "current": [_celsius(heater) for heater in all_heaters],
            "state": [_heater_state(heater) for heater in all_heaters],
            "tools": {
                "active": [[heater.target_c] for heater in hotends],
                "standby": [[0.0] for _ in hotends],
            },
        },
        "time": status.time_s,
    }
    if beds:
        found["temps"]["bed"] = {
            "current": _celsius(beds[0]),
            "active": beds[0].target_c,
            "state": _heater_state(beds[0]),
            "heater": 0,
        }
    if kind == 2:
        found |= {"name": bridge.machine.name, "firmwareName": "Passo", "axisNames": "".join(axes)}
        found |= {
            "axes": len(axes),
            "totalAxes": len(axes),
            "geometry": bridge.machine.geometry.kind,
        }
    if kind == 3:
        job = status.job
        found |= {
            "currentLayer": job.layer if job else 0,
            "extrRaw": [job.filament_mm if job else 0.0],
            "fractionPrinted": 100 * job.fraction if job else 0.0,
            "filePosition": job.offset if job else 0,
            "printDuration": job.printed_s if job else 0.0,
            "timesLeft": {"file": job.left_s if job and job.left_s is not None else 0.0},
        }
    return found


def aprinter_status(bridge: Bridge) -> dict[str, Any]:
    """The status in the format for APrinter's web page."""
    status = bridge.latest().status
    found_heaters: dict[str, Any] = {}
    for letter, kind in (("T", "hotend"), ("B", "bed"), ("C", "chamber")):
        for number, heater in enumerate(heaters(bridge, status, kind)):
            name = f"{letter}{number}" if letter == "T" or number else letter
            found_heaters[name] = {
                "current": _celsius(heater),
                "target": heater.target_c or _OFF,
                "error": bool(heater.fault),
            }
    mounted = status.files.mounted
    return {
        "active": status.state is not PrinterState.IDLE,
        "speedRatio": status.speed_factor,
        "configDirty": False,
        "axes": {name.upper(): {"pos": mm} for name, mm in status.position_mm.items()},
        "heaters": found_heaters,
        "fans": {f"F{i}": {"target": speed} for i, speed in enumerate(status.fans.values())},
        "sdcard": {
            "mntState": "Mounted" if mounted else "NotMounted",
            "rwState": "ReadWrite" if mounted else "NotMounted",
        },
    }


def _celsius(heater: HeaterStatus) -> float:
    """The temperature, °C; as in RepRapFirmware, 2000 for a sensor that reports nothing."""
    return 2000.0 if heater.current_c is None else heater.current_c


def _heater_state(heater: HeaterStatus) -> int:
    return 3 if heater.fault else 2 if heater.target_c else 0
