"""Klipper's objects of motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from passo.config.heater_numbers import heater_of
from passo.config.klipper_names import heater_object, stepper_object
from passo.config.square_corner import corner_mm_s

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.status import RetractionStatus, Status

Object = dict[str, Any]


class Coord(NamedTuple):
    """A position in mm, as `.x` and as `[0]`."""

    x: float
    y: float
    z: float
    e: float


def toolhead(machine: MachineConfig, status: Status) -> Object:
    """The machine's position at the end of the plan, its limits and homing."""
    x, y, z = (machine.axes[name] for name in "xyz")
    motion = status.motion
    accel = motion.max_accel_mm_s2
    fastest = max(a.speed_mm_s for a in (x, y, z))
    corner = motion.square_corner_mm_s
    if machine.limits.junction != "square_corner":
        corner = corner_mm_s(motion.junction_deviation_mm, accel)
    return {
        "position": Coord(*motion.end_mm),
        "homed_axes": "".join(name for name in "xyz" if name in status.homed),
        "axis_minimum": Coord(x.min_mm, y.min_mm, z.min_mm, 0.0),
        "axis_maximum": Coord(x.max_mm, y.max_mm, z.max_mm, 0.0),
        "extruder": _active_extruder(machine, status.tool),
        "max_velocity": min(fastest, motion.max_speed_mm_s or fastest),
        "max_accel": accel,
        "minimum_cruise_ratio": motion.minimum_cruise_ratio,
        "square_corner_velocity": corner,
        "print_time": status.time_s + motion.queued_s,
        "estimated_print_time": status.time_s,
        "stalls": 0,
    }


def _active_extruder(machine: MachineConfig, tool: int) -> str:
    """The hotend of the active tool; tools that share a hotend share its object."""
    hotend = heater_of(machine, "hotend", tool)
    return "" if hotend is None else heater_object(machine, hotend)


def driver(status: Status, name: str) -> Object:
    """The driver of a motor: its currents, and the flags of its status that are set."""
    found = status.drivers[name]
    return {
        "run_current": found.run_a,
        "hold_current": found.hold_a,
        "drv_status": found.flags,
        "temperature": found.temperature_c,
        "mcu_phase_offset": None,
        "phase_offset_position": None,
    }


def firmware_retraction(retraction: RetractionStatus) -> Object:
    """The retraction of G10 and G11."""
    return {
        "retract_length": retraction.length_mm,
        "retract_speed": retraction.speed_mm_s,
        "unretract_extra_length": retraction.extra_mm,
        "unretract_speed": retraction.return_mm_s,
    }


def gcode_move(status: Status) -> Object:
    """The state of the interpreter: modes, offsets, factors and the program's position."""
    motion, tool = status.motion, status.tool
    at, zero = Coord(*motion.end_mm), Coord(*motion.program_end_mm)
    flows = status.flow_factors
    return {
        "speed_factor": status.speed_factor,
        "extrude_factor": flows[min(tool, len(flows) - 1)] if flows else 1.0,
        "speed": motion.feedrate_mm_s,
        "absolute_coordinates": motion.absolute,
        "absolute_extrude": motion.absolute_e,
        "homing_origin": Coord(
            _babystep(status, "x"), _babystep(status, "y"), _babystep(status, "z"), 0.0
        ),
        "position": at,
        "gcode_position": zero,
    }


def _babystep(status: Status, name: str) -> float:
    return status.axes[name].babystep_mm if name in status.axes else 0.0


def motion_report(machine: MachineConfig, status: Status) -> Object:
    """The position and speed of the machine now."""
    x, y, z = (status.axes[n].machine_mm if n in status.axes else 0.0 for n in "xyz")
    return {
        "live_position": Coord(x, y, z, status.position_mm.get("e", 0.0)),
        "live_velocity": status.motion.speed_mm_s,
        "live_extruder_velocity": status.motion.filament_mm_s,
        "steppers": [stepper_object(machine, name) for name in machine.steppers],
        "trapq": [],
    }


def stepper_enable(machine: MachineConfig, status: Status) -> Object:
    """Whether the motors are on."""
    on = status.motion.motors_on
    return {"steppers": {stepper_object(machine, name): on for name in machine.steppers}}


def input_shaper(status: Status) -> Object:
    """The shapers of the axes, with the parameters of SET_INPUT_SHAPER."""
    found: Object = {}
    for axis, shaper in status.shapers.items():
        found[f"shaper_type_{axis}"] = shaper.type
        found[f"shaper_freq_{axis}"] = shaper.frequency_hz
        found[f"damping_ratio_{axis}"] = shaper.damping
    return found
