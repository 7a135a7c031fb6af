"""Outputs and sensors that no heater uses."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import UNKNOWN_SENSOR
from passo.config.importing.klipper.cfg import Option, Section
from passo.config.importing.klipper.heat import put_sensor
from passo.config.importing.klipper.pins import JOINED
from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath, Value
    from passo.config.importing.klipper.conversion import Import

_PINS = ("output_pin", "pwm_tool", "pwm_cycle_time")
_USES = {
    "light": re.compile(r"light|lamp|^leds?$|case_?led", re.IGNORECASE),
    "camera": re.compile(r"camera|shutter", re.IGNORECASE),
}
_BEEPER, _BEEPER_PIN = re.compile(r"beep|buzz", re.IGNORECASE), ("beeper", "pin")
_COMBINED = "temperature_combined"
_HOST, _CHIP = "temperature_host", "temperature_mcu"
# A sensor with limits within these halts the printer, as in Klipper; wider limits are none.
_NO_LOW_C, _NO_HIGH_C = -100.0, 200.0
_CALIBRATION = ("sensor_temperature1", "sensor_temperature2", "sensor_adc1", "sensor_adc2")


def put_outputs(job: Import) -> None:
    """Imports the outputs, then the sensors that no heater uses."""
    used: set[str] = set()
    uses: set[str] = set()
    for section in job.config.sections.values():
        if (
            section.kind == "output_pin"
            and _BEEPER.search(section.rest)
            and _put_beeper(job, section)
        ):
            continue
        if section.kind in _PINS:
            name = _free(part_name(section.rest), used)
            job.part(section, lambda job, section, name=name: _put_output(job, section, name, uses))
        elif section.kind == "static_digital_output":
            job.part(section, lambda job, section: _put_fixed(job, section, used))
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
        name = _free(part_name(section.rest), taken)
        job.part(section, lambda job, section, name=name: _put_shown(job, section, name))
    job.used.update(section.name for section in job.config.of(JOINED) if section.used)


def _put_beeper(job: Import, section: Section) -> bool:
    """Makes an output the beeper of M300, if the machine has none yet."""
    pin = job.pins.of(section, "pin")
    if pin is None or _BEEPER_PIN in job.draft.keys:
        return False
    job.draft.put(_BEEPER_PIN, pin, section.at("pin"))
    text = "it is the beeper, which M300 sounds; SET_PIN only keeps its value for macros"
    job.draft.changed(section.place, f"[{section.name}]", text)
    job.leave_out(section)
    return True


def _put_by_number(job: Import, section: Section, name: str) -> None:
    """Leaves a fan, whose sensor Passo cannot read, to M106."""
    thermostat = ("fans", name, "thermostat")
    job.draft.keys = {k: v for k, v in job.draft.keys.items() if k[:3] != thermostat}
    job.fan_numbers += 1
    job.draft.put(("fans", name, "number"), job.fan_numbers, section.place)
    text = f"the fan is off until M106 P{job.fan_numbers} sets it: Passo cannot read its sensor"
    job.draft.decide(section.place, f"[{section.name}]", text)


def _free(name: str, used: set[str]) -> str:
    """A name that no other part has."""
    while name in used:
        name += "_2"
    used.add(name)
    return name


def _put_output(job: Import, section: Section, name: str, uses: set[str]) -> None:
    path, put = ("outputs", name), job.put_value
    if job.pins.of(section, "pin") is None:
        _leave_out(job, section)
        return
    job.put("output_pin", section, name=name)
    further: list[Value] = [*job.pins.others_of(section, "pin")]
    put((*path, "further_pins"), section, "pin", further or None)
    hardware = section.flag("hardware_pwm", default=False)
    if section.kind != "output_pin" or section.flag("pwm", default=False):
        put((*path, "pwm"), section, "pwm", "hardware" if hardware else "software")
        job.put("output_pwm", section, name=name)
    else:
        section.used.add("cycle_time")
    scale, static = section.number("scale") or 1.0, section.number("static_value")
    for option, key in (("value", "start"), ("shutdown_value", "at_halt")):
        value = (section.number(option, 0.0) or 0.0) if static is None else static
        put((*path, key), section, option, value / scale or None)
    put((*path, "fixed"), section, "static_value", None if static is None else True)
    for use, names in _USES.items():
        if names.search(name) and use not in uses:
            uses.add(use)
            job.draft.put((*path, "use"), use, section.place)


def _put_fixed(job: Import, section: Section, used: set[str]) -> None:
    """Pins that are set once: on, or with ! off."""
    option = section.option("pins")
    for written in option.text.split(",") if option else ():
        if pin := job.pins.pin(section, "pins", Option(written, section.at("pins"))):
            path = ("outputs", _free(part_name(section.rest), used))
            for key, value in (("pin", pin), ("start", 1.0), ("at_halt", 1.0), ("fixed", True)):
                job.draft.put((*path, key), value, section.at("pins"))


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
    if keys.keys() == {"kind"}:
        put((*path, "sensor"), keys["kind"], place)
    elif keys:
        for key, value in keys.items():
            put((*path, "sensor", key), value, place)
    else:
        if "sensor_pin" not in section.options:
            raise section.wrong("sensor_type", UNKNOWN_SENSOR)
        if job.pins.of(section, "sensor_pin") is None:
            _leave_out(job, section)
            return
        put_sensor(job, section, path)
    job.put("temperature_sensor", section, name=name)
    low, high = section.number("min_temp"), section.number("max_temp")
    if (low is not None and low > _NO_LOW_C) or (high is not None and high < _NO_HIGH_C):
        put((*path, "on_fault"), "machine", section.at("min_temp"))
    letter = section.text("gcode_id").upper()
    if len(letter) == 1 and letter.isalpha():
        put((*path, "letter"), letter, section.at("gcode_id"))
    elif letter:
        text = "M105 names a temperature by one letter, so it does not report this one"
        job.draft.changed(
            section.at("gcode_id") or section.place, f"[{section.name}] gcode_id", text
        )


def _named(job: Import, section: Section, written: str) -> str:
    """The heater or the sensor of Klipper's name for it. Raises ConfigError."""
    if written in job.heaters:
        return job.heaters[written]
    kind, _, name = written.rpartition(" ")
    if kind not in ("", "temperature_sensor", "temperature_fan"):
        raise section.wrong("sensor_list", "heaters and temperature sensors", written)
    return part_name(name)


def _leave_out(job: Import, section: Section) -> None:
    """Reports a part without a pin that Passo drives."""
    job.draft.dropped(section.place, f"[{section.name}]", "it has no pin that Passo drives")
    job.leave_out(section)
