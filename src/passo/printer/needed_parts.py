"""The parts that a machine needs for a command whose handler every printer has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from passo.config.klipper_names import fan_object
from passo.probes.base import SensingProbe
from passo.probes.bltouch import BLTouch

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_Needs = Callable[["MachineConfig"], bool]


def _has_heaters(machine: MachineConfig) -> bool:
    return bool(machine.heaters)


def _has_filament(machine: MachineConfig) -> bool:
    return bool(machine.extruders)


def _has_gantry(machine: MachineConfig) -> bool:
    """Whether four motors move a gantry, as Klipper's quad_gantry_level needs it."""
    motors = machine.levelling.motors
    return motors is not None and len(motors.pivots) == 4


def _has_named_fan(machine: MachineConfig) -> bool:
    return any(fan_object(machine, name).startswith("fan_generic ") for name in machine.fans)


def _has_output(machine: MachineConfig) -> bool:
    return any(not output.fixed for output in machine.outputs.values())


def _has_light(machine: MachineConfig) -> bool:
    return bool(machine.lights)


def _has_servo_number(machine: MachineConfig) -> bool:
    by_probe = machine.probe is not None and machine.probe.servo_pin is not None
    return by_probe or any(servo.number is not None for servo in machine.servos.values())


def _has_use(use: str) -> _Needs:
    return lambda machine: any(output.use == use for output in machine.outputs.values())


NEEDS: Mapping[str, _Needs] = {
    "QUAD_GANTRY_LEVEL": _has_gantry,
    "Z_TILT_ADJUST": lambda machine: not _has_gantry(machine),
    "BED_TILT_CALIBRATE": lambda machine: machine.levelling.method == "linear",
    **dict.fromkeys(
        ("INIT_TMC", "DUMP_TMC", "SET_TMC_CURRENT", "SET_TMC_FIELD"),
        lambda machine: any(stepper.tmc for stepper in machine.steppers.values()),
    ),
    "BLTOUCH_DEBUG": lambda machine: isinstance(machine.probe, BLTouch),
    "PROBE_CALIBRATE": lambda machine: isinstance(machine.probe, SensingProbe),
    "SET_FAN_SPEED": _has_named_fan,
    "SET_PIN": _has_output,
    "SET_TEMPERATURE_FAN_TARGET": lambda machine: any(
        fan.thermostat for fan in machine.fans.values()
    ),
    "SET_LED": _has_light,
    "SET_LED_TEMPLATE": _has_light,
    "SET_LED_EFFECT": lambda machine: bool(machine.light_effects),
    "STOP_LED_EFFECTS": lambda machine: bool(machine.light_effects),
    "M150": _has_light,
    "M42": _has_output,
    "SET_SERVO": lambda machine: bool(machine.servos),
    "M280": _has_servo_number,
    "M240": _has_use("camera"),
    "M355": _has_use("light"),
    "SET_HEATER_TEMPERATURE": _has_heaters,
    "TURN_OFF_HEATERS": _has_heaters,
    "TEMPERATURE_WAIT": _has_heaters,
    "PID_CALIBRATE": _has_heaters,
    "ACTIVATE_EXTRUDER": _has_filament,
    "SET_PRESSURE_ADVANCE": _has_filament,
    "SET_RETRACTION": _has_filament,
    "GET_RETRACTION": _has_filament,
}
"""Whether a machine has what the command needs, by its code."""
