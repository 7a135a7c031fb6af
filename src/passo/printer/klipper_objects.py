"""The printer's state as Klipper's status objects, for templates of macros and for clients of
Klipper's socket. Pure functions, one for each object; lengths in mm, speeds in mm/s, times in s."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from passo.config.heater_numbers import heater_of
from passo.config.motor_roles import axis_order
from passo.motion.axis_slots import E, X, Y, Z
from passo.printer.status import PrinterState, Status

if TYPE_CHECKING:
    from passo import _core
    from passo.config.heat import Heater
    from passo.config.machine import MachineConfig

Object = dict[str, Any]
Objects = dict[str, Callable[[], Object]]
Variables = Mapping[str, Mapping[str, object]]

_ROOM_C = 25.0  # shown of a heater whose sensor has not reported
_MELTS_C = 170.0  # filament moves from here on, unless M302 says otherwise
_PRINT_STATES = {PrinterState.PRINTING: "printing", PrinterState.PAUSED: "paused"}
_ENDS = {"done": "complete", "cancelled": "cancelled", "failed": "error"}


class Coord(NamedTuple):
    """A position, as `.x` and as `[0]`."""

    x: float
    y: float
    z: float
    e: float


@dataclass(frozen=True, slots=True)
class ProgramState:
    """Where the end of the plan is and how lines are read there: what Klipper shows of motion.
    Positions are those of the machine and of the program; the feedrate is infinite until one was
    given."""

    machine_mm: Coord
    program_mm: Coord
    absolute: bool
    absolute_e: bool
    feed_mm_s: float
    speed_factor: float
    flow_factor: float
    tool: int
    homed: frozenset[str]
    max_speed_mm_s: float
    accel_mm_s2: float
    minimum_cruise_ratio: float
    junction_deviation_mm: float

    @classmethod
    def of(cls, job: _core.Job, homed: frozenset[str]) -> ProgramState:
        """That of a job now."""
        machine, program = job.machine_position, job.program_position
        absolute, absolute_e, feed = job.modal
        flows = job.flows
        return cls(
            Coord(machine[X], machine[Y], machine[Z], machine[E]),
            Coord(program[X], program[Y], program[Z], program[-1]),
            absolute,
            absolute_e,
            feed,
            job.speed_factor,
            flows[min(job.tool, len(flows) - 1)] if flows else 1.0,
            job.tool,
            homed,
            job.limit("speed"),
            job.limit("print_accel"),
            job.limit("minimum_cruise_ratio"),
            job.limit("junction_deviation"),
        )


def toolhead(machine: MachineConfig, status: Status, program: ProgramState) -> Object:
    """The machine's position, limits and homing."""
    x, y, z = (machine.axes[name] for name in "xyz")
    fastest = min(program.max_speed_mm_s, max(axis.speed_mm_s for axis in (x, y, z)))
    accel = program.accel_mm_s2
    return {
        "position": program.machine_mm,
        "homed_axes": "".join(name for name in "xyz" if name in program.homed),
        "axis_minimum": Coord(x.min_mm, y.min_mm, z.min_mm, 0.0),
        "axis_maximum": Coord(x.max_mm, y.max_mm, z.max_mm, 0.0),
        "extruder": _extruder_name(program.tool) if machine.all_tools else "",
        "max_velocity": fastest,
        "max_accel": accel,
        "minimum_cruise_ratio": program.minimum_cruise_ratio,
        # A right angle: v² = a δ s/(1 - s) with s = √½.
        "square_corner_velocity": sqrt(program.junction_deviation_mm * accel / (sqrt(2) - 1)),
        "print_time": status.time_s,
        "estimated_print_time": status.time_s,
        "stalls": 0,
    }


def gcode_move(program: ProgramState) -> Object:
    """How lines are read: modes, offsets, factors and the program's position."""
    at, zero = program.machine_mm, program.program_mm
    return {
        "speed_factor": program.speed_factor,
        "extrude_factor": program.flow_factor,
        "speed": program.feed_mm_s if program.feed_mm_s < inf else 0.0,
        "absolute_coordinates": program.absolute,
        "absolute_extrude": program.absolute_e,
        "homing_origin": Coord(at.x - zero.x, at.y - zero.y, at.z - zero.z, 0.0),
        "position": at,
        "gcode_position": zero,
    }


def heater(status: Status, name: str) -> Object:
    """A heater; its temperature in °C is that of a room until its sensor reports."""
    seen = status.heaters[name]
    celsius = _ROOM_C if seen.celsius is None else seen.celsius
    return {"temperature": celsius, "target": seen.target_c, "power": seen.power}


def extruder(status: Status, name: str) -> Object:
    """A hotend with its filament."""
    seen = heater(status, name)
    return seen | {"can_extrude": seen["temperature"] >= _MELTS_C}


def fan(status: Status, name: str) -> Object:
    """A fan; its speed is a fraction of full speed."""
    return {"speed": status.fans.get(name, 0.0), "rpm": None}


def print_stats(status: Status) -> Object:
    """The print: its state as Klipper names it."""
    job = status.job
    ended = _ENDS.get(status.last_job, "standby")
    state = "error" if status.halted else _PRINT_STATES.get(status.state, ended)
    return {
        "state": state,
        "filename": (job.path or job.file) if job else "",
        "print_duration": job.printed_s if job else 0.0,
        "total_duration": job.elapsed_s if job else 0.0,
        "message": status.halted,
        "filament_used": job.filament_mm if job else 0.0,
        "info": {
            "total_layer": job.layers if job else None,
            "current_layer": job.layer if job else None,
        },
    }


def virtual_sdcard(status: Status) -> Object:
    """The file that is printed."""
    job = status.job
    return {
        "is_active": status.state is PrinterState.PRINTING,
        "progress": (job.fraction if job else status.progress) or 0.0,
        "file_path": (job.path or job.file) if job else None,
        "file_position": job.offset if job else 0,
        "file_size": job.size if job else 0,
    }


def pause_resume(status: Status) -> Object:
    """Whether the print is paused."""
    return {"is_paused": status.state is PrinterState.PAUSED}


def idle_timeout(status: Status) -> Object:
    """Whether the machine moves, also by hand."""
    busy = status.state in (PrinterState.PRINTING, PrinterState.BUSY)
    return {"state": "Printing" if busy else "Idle", "printing_time": 0.0}


def webhooks(status: Status) -> Object:
    """Whether the printer runs."""
    state = "shutdown" if status.halted else "ready"
    return {"state": state, "state_message": status.halted or "Printer is ready"}


def configfile(machine: MachineConfig) -> Object:
    """The machine file as Klipper's sections, as far as clients and macros read them."""
    x, y, z = (machine.axes[name] for name in "xyz")
    settings: dict[str, Object] = {
        "printer": {
            "kinematics": machine.geometry.kind,
            "max_velocity": max(axis.speed_mm_s for axis in (x, y, z)),
            "max_accel": machine.limits.print_accel_mm_s2 or min(x.accel_mm_s2, y.accel_mm_s2),
            "max_z_velocity": z.speed_mm_s,
            "max_z_accel": z.accel_mm_s2,
        }
    }
    for name in axis_order(machine.axes)[:3]:
        axis = machine.axes[name]
        settings[f"stepper_{name}"] = {
            "position_min": axis.min_mm,
            "position_max": axis.max_mm,
            "position_endstop": machine.home_mm[name],
        }
    for name, part in machine.heaters.items():
        settings[heater_object(machine, name)] = _heater_settings(part)
    for name, macro in machine.macros.items():
        settings[f"gcode_macro {name.lower()}"] = {
            "gcode": macro.gcode,
            "description": macro.description,
            **{f"variable_{key}": value for key, value in macro.variables.items()},
            **({"rename_existing": macro.rename_existing} if macro.rename_existing else {}),
        }
    return {"settings": settings, "config": {}, "warnings": [], "save_config_pending": False}


def _heater_settings(part: Heater) -> Object:
    settings: Object = {"min_temp": part.min_c, "max_temp": part.max_c}
    if part.kind == "hotend":
        settings |= {"min_extrude_temp": _MELTS_C}
    return settings


def _extruder_name(number: int) -> str:
    return f"extruder{number or ''}"


def heater_object(machine: MachineConfig, name: str) -> str:
    """What Klipper calls a heater: hotends by their tools, the first bed, others by name."""
    if machine.heaters[name].kind == "hotend":
        for number in range(max(len(machine.tools), len(machine.heaters))):
            if heater_of(machine, "hotend", number) == name:
                return _extruder_name(number)
    if heater_of(machine, "bed", 0) == name:
        return "heater_bed"
    return f"heater_generic {name}"


def fan_object(machine: MachineConfig, name: str) -> str:
    """What Klipper calls a fan: P0 of M106, those that follow a heater, others by name."""
    part = machine.fans[name]
    if part.follows is not None:
        return f"heater_fan {name}"
    if part.follows_motors:
        return f"controller_fan {name}"
    return "fan" if part.number == 0 else f"fan_generic {name}"


def objects(
    machine: MachineConfig, status: Status, program: ProgramState, variables: Variables
) -> Objects:
    """All objects of a printer by their names, each made when it is asked for. `variables` are
    those of the macros, by name."""
    found: Objects = {
        "toolhead": lambda: toolhead(machine, status, program),
        "gcode_move": lambda: gcode_move(program),
        "print_stats": lambda: print_stats(status),
        "virtual_sdcard": lambda: virtual_sdcard(status),
        "pause_resume": lambda: pause_resume(status),
        "idle_timeout": lambda: idle_timeout(status),
        "webhooks": lambda: webhooks(status),
        "configfile": lambda: configfile(machine),
    }
    for name, part in machine.heaters.items():
        make = extruder if part.kind == "hotend" else heater
        found[heater_object(machine, name)] = lambda name=name, make=make: make(status, name)
    for name in machine.fans:
        found[fan_object(machine, name)] = lambda name=name: fan(status, name)
    for name, values in variables.items():
        found[f"gcode_macro {name}"] = lambda values=values: dict(values)
    return found
