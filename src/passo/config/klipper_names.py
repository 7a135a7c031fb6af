"""Klipper's names for the parts of a machine."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from passo.config.heater_numbers import heater_of
from passo.config.i2c_sensors import FAMILIES, I2cSensor

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def extruder_object(number: int) -> str:
    """Klipper's name for the extruder of a tool."""
    return f"extruder{number or ''}"


def number_of(extruder: str) -> int | None:
    """The number of the tool whose extruder has this name; None if it is not the name of an
    extruder."""
    number = extruder.removeprefix("extruder")
    return int(number or 0) if number.isdigit() or not number else None


def heater_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a heater: hotends are named by their tools; the first bed is
    heater_bed."""
    if machine.heaters[name].kind == "hotend":
        for number in range(max(len(machine.tools), len(machine.heaters))):
            if heater_of(machine, "hotend", number) == name:
                return extruder_object(number)
    if heater_of(machine, "bed", 0) == name:
        return "heater_bed"
    return f"heater_generic {name}"


def fan_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a fan. The kind is that of a fan for P0 of M106, of one that follows a
    heater, of one that follows motors, or of any other."""
    part = machine.fans[name]
    if part.warmed_by:
        return f"heater_fan {name}"
    if part.thermostat is not None:
        return f"temperature_fan {name}"
    if part.follows_motors or part.follows_targets:
        return f"controller_fan {name}"
    first = next((n for n, fan in machine.fans.items() if fan.commanded and fan.number == 0), None)
    return "fan" if name == first else f"fan_generic {name}"


def light_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a light."""
    return f"{machine.lights[name].kind} {name}"


def sensor_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a filament sensor."""
    if (width := machine.filament_sensors[name].width) is not None:
        kind = "tsl1401cl" if width.second_pin is None else "hall"
        return f"{kind}_filament_width_sensor"
    return f"filament_{machine.filament_sensors[name].kind}_sensor {name}"


def temperature_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a temperature sensor without a heater: that of a fan, if the fan has its
    name and keeps its temperature. In Klipper, such a fan has the sensor."""
    fan = machine.fans.get(name)
    own = fan is not None and fan.thermostat is not None and fan.thermostat.sensor == name
    return f"temperature_fan {name}" if own else f"temperature_sensor {name}"


def chip_object(machine: MachineConfig, name: str) -> str | None:
    """Klipper's name for the chip of a sensor on I2C, which has its humidity and pressure; None for
    other sensors."""
    sensor = machine.sensors[name].sensor
    return f"{FAMILIES[sensor.kind].name} {name}" if isinstance(sensor, I2cSensor) else None


def temperature_objects(machine: MachineConfig) -> dict[str, str]:
    """The sensors of all temperatures without a heater, by Klipper's names: those of sensors, then
    those of fans with a sensor of another name."""
    sensors = {temperature_object(machine, name): name for name in machine.sensors}
    fans = {
        fan_object(machine, name): fan.thermostat.sensor
        for name, fan in machine.fans.items()
        if fan.thermostat
    }
    return sensors | fans


def driver_object(chip: str, stepper: str) -> str:
    """Klipper's name for the driver of a motor with Klipper's name `stepper`; chips that differ in
    their package alone share a kind."""
    kind = {"TMC2225": "TMC2208", "TMC2226": "TMC2209"}.get(chip, chip)
    return f"{kind.lower()} {stepper}"


def board_object(name: str) -> str:
    """Klipper's name for a board; `main` is the main one."""
    return "mcu" if name == "main" else f"mcu {name}"


_OWN_NAMES = {"polar": ("bed", "arm", "z"), "winch": "abcdefgh"}  # of the actuators


def stepper_object(machine: MachineConfig, name: str) -> str:
    """Klipper's name for a motor: extruders by their tools, motors of crossed belts by the axis
    with their number, those of a polar machine and of cables by Klipper's names for them, others by
    the name in the machine file."""
    if name[:1] == "e" and (number := name[1:] or "0").isdigit():
        return extruder_object(int(number))
    stem, actuators = name.rstrip("0123456789"), machine.geometry.actuators
    if own := _OWN_NAMES.get(machine.geometry.kind):
        return f"stepper_{own[actuators.index(name)]}" if name in actuators else f"stepper_{name}"
    if not machine.geometry.arms and stem in actuators:
        return f"stepper_{'xyz'[actuators.index(stem)]}{name.removeprefix(stem)}"
    return f"stepper_{name}"


def motors_by_name(machine: MachineConfig, motors: Iterable[str]) -> dict[str, str]:
    """These motors by all their names: Klipper's, and those of the machine file."""
    motors = list(motors)
    named = {f"stepper_{name}": name for name in motors} | {name: name for name in motors}
    return named | {stepper_object(machine, name): name for name in motors}
