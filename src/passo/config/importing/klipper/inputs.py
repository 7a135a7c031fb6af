"""Filament sensors and buttons: what a runout does, and the extruder of a motion sensor. Rows of
the table have the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_names import number_of
from passo.config.part_names import part_name

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_MOTION = "filament_motion_sensor"
_PAUSES = ("PAUSE", "M600")  # what Passo does at a pause


def put_filament_sensors(job: Import) -> None:
    """Imports all filament sensors. One without a pin of its own is left out."""
    for kind in ("filament_switch_sensor", _MOTION):
        for section in job.config.of(kind):
            job.part(section, _put_sensor, "the sensor")


def put_buttons(job: Import) -> None:
    """Imports all buttons. One without a pin of its own is left out."""
    for section in job.config.of("gcode_button"):
        job.part(section, _put_button, "the button")


def _put_button(job: Import, section: Section) -> None:
    job.put("gcode_button", section, name=part_name(section.rest or section.kind))


def _put_sensor(job: Import, section: Section) -> None:
    name, put = part_name(section.rest or section.kind), job.draft.put
    if ("filament_sensors", name, "pin") in job.draft.keys:
        name += "_motion"  # Klipper allows a switch and a motion sensor of one name
    path = ("filament_sensors", name)
    moves = section.kind == _MOTION
    put((*path, "kind"), "motion" if moves else "switch", section.place)
    job.put("filament_sensor", section, name=name)
    if moves:
        job.put(_MOTION, section, name=name)
        number = number_of(section.text("extruder"))
        known = {path[1] for path in job.draft.keys if path[0] == "extruders"}
        if number is None or f"e{number or ''}" not in known:
            raise section.wrong("extruder", "an extruder, such as extruder or extruder1")
        put((*path, "extruder"), f"e{number or ''}", section.at("extruder"))
    gcode, pauses = section.commented("runout_gcode"), section.flag("pause_on_runout", True)
    alone = gcode.strip().upper()
    macros = {macro.rest.upper() for macro in job.config.of("gcode_macro")}
    if alone == "PAUSE" or (alone == "M600" and alone not in macros):
        gcode, pauses = "", True
        text = (
            "the pause of a runout is that of M600" if alone in _PAUSES[1:] else "it is the pause"
        )
        job.draft.changed(section.at("runout_gcode"), f"[{section.name}] runout_gcode", text)
    put((*path, "on_runout"), "pause" if pauses else "none", section.at("pause_on_runout"))
    put((*path, "runout_gcode"), gcode or None, section.at("runout_gcode"))
