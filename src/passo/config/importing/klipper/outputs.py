"""Outputs, with the sensors that no heater uses."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.importing.klipper.cfg import Option, Section
from passo.config.importing.klipper.pins import JOINED
from passo.config.importing.klipper.sensors import free_name, leave_out, put_sensors
from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.draft import Value
    from passo.config.importing.klipper.conversion import Import

_PINS = ("output_pin", "pwm_tool", "pwm_cycle_time")
_USES = {
    "light": re.compile(r"light|lamp|^leds?$|case_?led", re.IGNORECASE),
    "camera": re.compile(r"camera|shutter", re.IGNORECASE),
}
_BEEPER, _BEEPER_PIN = re.compile(r"beep|buzz", re.IGNORECASE), ("beeper", "pin")


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
            name = free_name(part_name(section.rest), used)
            job.part(section, lambda job, section, name=name: _put_output(job, section, name, uses))
        elif section.kind == "static_digital_output":
            job.part(section, lambda job, section: _put_fixed(job, section, used))
    put_sensors(job)
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


def _put_output(job: Import, section: Section, name: str, uses: set[str]) -> None:
    path, put = ("outputs", name), job.put_value
    if job.pins.of(section, "pin") is None:
        leave_out(job, section)
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
            path = ("outputs", free_name(part_name(section.rest), used))
            for key, value in (("pin", pin), ("start", 1.0), ("at_halt", 1.0), ("fixed", True)):
                job.draft.put((*path, key), value, section.at("pins"))
