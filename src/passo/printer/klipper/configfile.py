"""The machine file as the sections of a printer.cfg, for the keys that clients and macros read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.motor_roles import axis_order
from passo.geometry.delta import Delta
from passo.printer.cold_extrusion import COLD_C
from passo.printer.klipper.names import fan_object, heater_object
from passo.probes.base import SensingProbe
from passo.probes.bltouch import BLTouch

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.heat import Heater
    from passo.config.machine import MachineConfig

Object = dict[str, Any]

# The geometries that clients can draw; they draw all others as cartesian machines.
_KINEMATICS = {"delta", "rotary_delta", "corexy", "corexz", "cartesian"}
# Clients warn if these sections are missing, although Passo needs no configuration for them.
_NEEDED: dict[str, Object] = {"pause_resume": {}, "display_status": {}, "respond": {}}
_BUILT_IN = ("PAUSE", "RESUME", "CANCEL_PRINT")


def configfile(
    machine: MachineConfig, folder: str, unsaved: Mapping[str, Mapping[str, str]]
) -> Object:
    """The object configfile. Its `settings` are typed values in lower-case sections, and its
    `config` has them as texts. `folder` is the folder of the card, or empty; `unsaved` are the
    settings that SAVE_CONFIG would store."""
    named: dict[str, Object] = {
        "printer": _printer(machine),
        **_axes(machine),
        **{heater_object(machine, n): _heater(h, machine) for n, h in machine.heaters.items()},
        **{
            fan_object(machine, n): {"max_power": f.max_power, "off_below": f.off_below}
            for n, f in machine.fans.items()
        },
        **_bed(machine),
        **_macros(machine),
        **_NEEDED,
        "exclude_object": {},
        "force_move": {"enable_force_move": True},
        **({"virtual_sdcard": {"path": folder}} if folder else {}),
    }
    return {
        "settings": {section.lower(): values for section, values in named.items()},
        "config": {
            section: {key: str(value) for key, value in values.items()}
            for section, values in named.items()
        },
        "warnings": [],
        "save_config_pending": bool(unsaved),
        "save_config_pending_items": {name: dict(values) for name, values in unsaved.items()},
    }


def _printer(machine: MachineConfig) -> Object:
    x, y, z = (machine.axes[name] for name in "xyz")
    kind = machine.geometry.kind
    radius = {}
    if isinstance(machine.geometry, Delta) and machine.bed is not None:
        radius = {"print_radius": machine.bed.size_mm[0] / 2}
    return {
        "kinematics": kind if kind in _KINEMATICS else "cartesian",
        "max_velocity": max(axis.speed_mm_s for axis in (x, y, z)),
        "max_accel": machine.limits.print_accel_mm_s2 or min(x.accel_mm_s2, y.accel_mm_s2),
        "max_z_velocity": z.speed_mm_s,
        "max_z_accel": z.accel_mm_s2,
        "minimum_cruise_ratio": machine.limits.minimum_cruise_ratio,
        **radius,
    }


def _axes(machine: MachineConfig) -> dict[str, Object]:
    """The sections of the motors; the carriages of a delta have the limits of Z."""
    letters = dict(zip("xyz", "abc", strict=True))
    is_delta = isinstance(machine.geometry, Delta)
    sections: dict[str, Object] = {}
    for name in axis_order(machine.axes)[:3]:
        axis = machine.axes["z" if is_delta else name]
        homing = machine.homing.get(name)
        sections[f"stepper_{letters[name] if is_delta else name}"] = {
            "position_min": axis.min_mm,
            "position_max": axis.max_mm,
            "position_endstop": machine.home_mm["z" if is_delta else name],
            **({"endstop_pin": homing.pin} if homing is not None and homing.pin else {}),
        }
    return sections


def _bed(machine: MachineConfig) -> dict[str, Object]:
    """The sections of the bed. Clients show the height map only if there is a section bed_mesh."""
    probe, levelling = machine.probe, machine.levelling
    if probe is None:
        return {}
    x0, y0, x1, y1 = levelling.area or machine.bed_area_mm
    mesh = {
        "speed": probe.travel_mm_s,
        "horizontal_move_z": probe.start_mm,
        "mesh_min": [x0, y0],
        "mesh_max": [x1, y1],
        "probe_count": list(levelling.count),
        "mesh_pps": [3, 3],
        "algorithm": "bicubic" if levelling.interpolation == "bicubic" else "direct",
    }
    if not isinstance(probe, SensingProbe):
        return {"bed_mesh": mesh}
    dx, dy = probe.offset_mm
    sensor = {
        "x_offset": dx,
        "y_offset": dy,
        "z_offset": probe.trigger_height_mm,
        "speed": probe.slow_mm_s,
        "samples": probe.samples,
    }
    return {"bed_mesh": mesh, "bltouch" if isinstance(probe, BLTouch) else "probe": sensor}


def _heater(part: Heater, machine: MachineConfig) -> Object:
    settings: Object = {
        "min_temp": part.min_c,
        "max_temp": part.max_c,
        "max_power": part.max_power,
        "control": "watermark" if part.control.kind == "bang-bang" else part.control.kind,
    }
    if part.kind == "hotend":
        settings |= {
            "min_extrude_temp": COLD_C,
            "nozzle_diameter": 0.4,
            "filament_diameter": 1.75,
            "max_extrude_only_distance": 50.0,
        }
    return settings


def _macros(machine: MachineConfig) -> dict[str, Object]:
    sections: dict[str, Object] = {f"gcode_macro {name}": {"gcode": name} for name in _BUILT_IN}
    for name, macro in machine.macros.items():
        sections[f"gcode_macro {name}"] = {
            "gcode": macro.gcode,
            "description": macro.description,
            **{f"variable_{key}": value for key, value in macro.variables.items()},
            **({"rename_existing": macro.rename_existing} if macro.rename_existing else {}),
        }
    return sections
