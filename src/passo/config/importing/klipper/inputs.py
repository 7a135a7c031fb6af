"""Filament sensors and buttons: what a runout does, and the extruder of a motion sensor. Rows of
the table have the rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.filament_width import FULL_SCALE
from passo.config.klipper_names import number_of
from passo.config.part_names import part_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_MOTION = "filament_motion_sensor"
_HALL = "hall_filament_width_sensor"
_LINEAR = "tsl1401cl_filament_width_sensor"
_READINGS = {"raw_dia1": 9500.0, "raw_dia2": 10500.0}
_DIAMETERS = {"cal_dia1": 1.5, "cal_dia2": 2.0}
_PAUSES = ("PAUSE", "M600")  # what Passo does at a pause


def put_filament_sensors(job: Import) -> None:
    """Imports all filament sensors. One without a pin of its own is left out."""
    for kind in ("filament_switch_sensor", _MOTION):
        for section in job.config.of(kind):
            job.part(section, _put_sensor, "the sensor")
    job.parts(_HALL, convert=_put_hall)
    job.parts(_LINEAR, convert=_put_linear)


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
    _put_runout(job, section, name)


def _put_hall(job: Import, section: Section) -> None:
    """The width by two sensors of a magnetic field, with two diameters that were measured."""
    job.put(_HALL, section, name=_HALL)
    readings, diameters = (
        [default if (n := section.number(option)) is None else n for option, default in options]
        for options in (_READINGS.items(), _DIAMETERS.items())
    )
    _put_width(job, section, readings, diameters)
    _put_runout(job, section, _HALL)


def _put_linear(job: Import, section: Section) -> None:
    """The width by a line of light sensors: 5 mm at full scale."""
    job.put(_LINEAR, section, name=_LINEAR)
    _put_width(job, section, [0.0, FULL_SCALE], [0.0, 5.0])
    job.draft.put(("filament_sensors", _LINEAR, "on_runout"), "none", section.place)


def _put_width(
    job: Import, section: Section, readings: Sequence[float], diameters: Sequence[float]
) -> None:
    path, put = ("filament_sensors", section.kind), job.draft.put
    put((*path, "kind"), "width", section.place)
    job.put("filament_width", section, name=section.kind)
    put((*path, "width", "readings"), [*readings], section.at("raw_dia1"))
    put((*path, "width", "diameters_mm"), [*diameters], section.at("cal_dia1"))


def _put_runout(job: Import, section: Section, name: str) -> None:
    path, put = ("filament_sensors", name), job.draft.put
    job.put("filament_runout", section, name=name)
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
