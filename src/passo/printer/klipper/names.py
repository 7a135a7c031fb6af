"""Klipper's names for the parts of a machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.heater_numbers import heater_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def extruder_object(number: int) -> str:
    """The extruder of a tool."""
    return f"extruder{number or ''}"


def number_of(extruder: str) -> int | None:
    """The tool of the name of an extruder; None for another name."""
    number = extruder.removeprefix("extruder")
    return int(number or 0) if number.isdigit() or not number else None


def heater_object(machine: MachineConfig, name: str) -> str:
    """A heater: hotends by their tools, the first bed, others by name."""
    if machine.heaters[name].kind == "hotend":
        for number in range(max(len(machine.tools), len(machine.heaters))):
            if heater_of(machine, "hotend", number) == name:
                return extruder_object(number)
    if heater_of(machine, "bed", 0) == name:
        return "heater_bed"
    return f"heater_generic {name}"


def fan_object(machine: MachineConfig, name: str) -> str:
    """A fan: P0 of M106, those that follow a heater or motors, others by name."""
    part = machine.fans[name]
    if part.follows is not None:
        return f"heater_fan {name}"
    if part.follows_motors:
        return f"controller_fan {name}"
    first = next((n for n, fan in machine.fans.items() if fan.commanded and fan.number == 0), None)
    return "fan" if name == first else f"fan_generic {name}"


def board_object(name: str) -> str:
    """A board; `main` is the main one."""
    return "mcu" if name == "main" else f"mcu {name}"


def stepper_object(name: str) -> str:
    """A motor: those of X, Y and Z by their axis, others by name."""
    if name[:1] == "e" and (number := name[1:] or "0").isdigit():
        return extruder_object(int(number))
    return f"stepper_{name}"
