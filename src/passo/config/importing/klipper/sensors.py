"""Temperature sensors that no heater uses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.config.i2c_sensors import FAMILIES, I2C_KINDS
from passo.config.importing.draft import UNKNOWN_SENSOR
from passo.config.importing.klipper.buses import i2c_bus_of
from passo.config.importing.klipper.heat import put_sensor
from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_COMBINED = "temperature_combined"
_HOST, _CHIP = "temperature_host", "temperature_mcu"
# A sensor with limits within these halts the printer, as in Klipper; wider limits are none.
_NO_LOW_C, _NO_HIGH_C, _NO_DEVIATION_C = -100.0, 200.0, 900.0
_CALIBRATION = ("sensor_temperature1", "sensor_temperature2", "sensor_adc1", "sensor_adc2")
_MIN_PERIOD_S = 0.5
_OTHER_NAMES = {"aht10": "aht1x"}
_OF_I2C = ("htu21d_hold_master", "htu21d_resolution")  # Passo reads as well as the chip can


def put_sensors(job: Import) -> None:
    """Imports the sensors of fans, then those that are only shown."""
    taken = {path[1] for path in job.draft.keys if path[0] == "heaters"}
    cooled = {
        str(value)
        for path, (value, _) in job.draft.keys.items()
        if path[0] == "fans" and path[2:] == ("thermostat", "sensor")
    }
    for section in job.config.of("temperature_fan"):
        name = part_name(section.rest)
        if name in cooled and not job.part(
            section, lambda job, section, name=name: _put_shown(job, section, name), "its sensor"
        ):
            _put_by_number(job, section, name)
    taken |= cooled
    for section in job.config.of("temperature_sensor"):
        name = free_name(part_name(section.rest), taken)
        job.part(section, lambda job, section, name=name: _put_shown(job, section, name))


def free_name(name: str, used: set[str]) -> str:
    """A name that no other part has."""
    while name in used:
        name += "_2"
    used.add(name)
    return name


def _put_by_number(job: Import, section: Section, name: str) -> None:
    """Leaves a fan, whose sensor Passo cannot read, to M106."""
    thermostat = ("fans", name, "thermostat")
    job.draft.keys = {k: v for k, v in job.draft.keys.items() if k[:3] != thermostat}
    job.fan_numbers += 1
    job.draft.put(("fans", name, "number"), job.fan_numbers, section.place)
    text = f"the fan is off until M106 P{job.fan_numbers} sets it: Passo cannot read its sensor"
    job.draft.decide(section.place, f"[{section.name}]", text)


def _put_shown(job: Import, section: Section, name: str) -> None:
    path: KeyPath = ("sensors", name)
    put, kind, place = job.draft.put, section.text("sensor_type"), section.at("sensor_type")
    keys: dict[str, Any] = {}
    if kind == _HOST:
        found = section.text("sensor_path")
        keys = {"kind": "host"} | ({"path": found} if found else {})
    elif kind == _CHIP:
        board = job.pins.further.get(section.text("sensor_mcu", "mcu"))
        keys = {"kind": "chip"} | ({"board": board} if board else {})
        section.used.update(_CALIBRATION)
    elif kind == _COMBINED:
        by = section.text("combination_method").lower()
        names = [name.strip() for name in section.text("sensor_list").split(",") if name.strip()]
        keys = {"kind": "combined", "of": [_named(job, section, one) for one in names]}
        keys |= {"by": by} if by in ("min", "max") else {}
        apart = section.number("maximum_deviation")
        keys |= {"max_deviation_c": apart} if apart and apart < _NO_DEVIATION_C else {}
    on_i2c = _OTHER_NAMES.get(kind.lower(), kind.lower())
    if on_i2c in I2C_KINDS:
        _put_chip(job, section, name, on_i2c)
    elif keys.keys() == {"kind"}:
        put((*path, "sensor"), keys["kind"], place)
    elif keys:
        for key, value in keys.items():
            put((*path, "sensor", key), value, place)
    else:
        if "sensor_pin" not in section.options:
            raise section.wrong("sensor_type", UNKNOWN_SENSOR)
        if job.pins.of(section, "sensor_pin") is None:
            leave_out(job, section)
            return
        put_sensor(job, section, path)
    job.put("temperature_sensor", section, name=name)
    low, high = section.number("min_temp"), section.number("max_temp")
    limited = (low is not None and low > _NO_LOW_C) or (high is not None and high < _NO_HIGH_C)
    if limited or "max_deviation_c" in keys:
        put((*path, "on_fault"), "machine", section.at("min_temp"))
    letter = section.text("gcode_id").upper()
    if len(letter) == 1 and letter.isalpha():
        put((*path, "letter"), letter, section.at("gcode_id"))
    elif letter:
        text = "M105 names a temperature by one letter, so it does not report this one"
        job.draft.changed(
            section.at("gcode_id") or section.place, f"[{section.name}] gcode_id", text
        )


def _put_chip(job: Import, section: Section, name: str, kind: str) -> None:
    """Sets the chip on I2C of a sensor. Raises ConfigError if its bus is not known."""
    path: KeyPath = ("sensors", name, "sensor")
    job.draft.put((*path, "kind"), kind, section.at("sensor_type"))
    for key, (value, place) in i2c_bus_of(job, section).items():
        job.draft.put((*path, key), value, place)
    job.put("i2c_sensor", section, name=name)
    option = FAMILIES[kind].report_option
    seconds = section.number(option) if option else None
    if seconds is not None:
        job.put_value((*path, "period_s"), section, option, max(seconds, _MIN_PERIOD_S))
    section.used.update((*_OF_I2C, *(o for o in section.options if o.startswith("bme280_"))))


def _named(job: Import, section: Section, written: str) -> str:
    """The heater or the sensor of Klipper's name for it. Raises ConfigError."""
    if written in job.heaters:
        return job.heaters[written]
    kind, _, name = written.rpartition(" ")
    if kind not in ("", "temperature_sensor", "temperature_fan"):
        raise section.wrong("sensor_list", "heaters and temperature sensors", written)
    return part_name(name)


def leave_out(job: Import, section: Section) -> None:
    """Reports a part without a pin that Passo drives."""
    job.draft.dropped(section.place, f"[{section.name}]", "it has no pin that Passo drives")
    job.leave_out(section)
