"""Klipper's objects of heaters, fans, outputs and sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.klipper_names import heater_object, temperature_objects

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.status import Status

Object = dict[str, Any]

_ROOM_C = 25.0  # shown for a heater whose sensor has not reported


def heater(status: Status, name: str) -> Object:
    """A heater. Its temperature, °C, is the last reading, as in Klipper; room temperature before
    the first one."""
    seen = status.heaters[name]
    celsius = _ROOM_C if seen.celsius is None else seen.celsius
    return {"temperature": round(celsius, 2), "target": seen.target_c, "power": seen.power}


def extruder(status: Status, name: str, number: int | None) -> Object:
    """A hotend with its filament, if it is that of a tool."""
    seen = heater(status, name)
    found = seen | {
        "can_extrude": seen["temperature"] >= status.heaters[name].min_extrude_c,
        "motion_queue": None,
    }
    if number is not None and number < len(status.advances):
        advance = status.advances[number]
        found |= {"pressure_advance": advance.advance_s, "smooth_time": advance.smooth_s}
    return found


def fan(status: Status, name: str) -> Object:
    """A fan; its speed is a fraction of full speed, its rpm None without a tachometer."""
    rpm = status.fan_rpm.get(name)
    return {"speed": status.fans.get(name, 0.0), "rpm": None if rpm is None else round(rpm, 1)}


def temperature_fan(machine: MachineConfig, status: Status, name: str) -> Object:
    """A fan with a thermostat, with the temperature of its sensor and its target, °C."""
    kept = machine.fans[name].thermostat
    seen = temperature_sensor(status, kept.sensor) if kept else {"temperature": 0.0}
    found = {"temperature": seen["temperature"], "target": status.fan_targets_c[name]}
    return fan(status, name) | found


def output_pin(status: Status, name: str) -> Object:
    """An output; its value is a fraction of fully on."""
    return {"value": status.outputs[name]}


def light(status: Status, name: str) -> Object:
    """The colours of a light's LEDs: red, green, blue and white, 0 to 1."""
    return {"color_data": [list(color) for color in status.lights[name]]}


def temperature_sensor(status: Status, name: str) -> Object:
    """A sensor without a heater, °C. Before its first reading, and while it is broken, it shows 0
    °C."""
    seen = status.sensors[name]
    return {
        "temperature": round(seen.celsius or 0.0, 2),
        "measured_min_temp": round(seen.lowest_c or 0.0, 2),
        "measured_max_temp": round(seen.highest_c or 0.0, 2),
    }


def i2c_sensor(status: Status, name: str) -> Object:
    """A sensor chip on I2C: °C, and % of relative humidity and hPa, if it measures them. 0 while
    there is no reading, as in Klipper."""
    seen = status.sensors[name]
    found = {"temperature": round(seen.celsius or 0.0, 2)}
    if seen.humidity is not None:
        found["humidity"] = round(seen.humidity, 2)
    if seen.pressure_hpa is not None:
        found["pressure"] = round(seen.pressure_hpa, 2)
    return found


def heaters(machine: MachineConfig) -> Object:
    """The names of all heaters and sensors."""
    names = [heater_object(machine, name) for name in machine.heaters]
    return {
        "available_heaters": names,
        "available_sensors": [*names, *temperature_objects(machine)],
        "available_monitors": [],
    }
