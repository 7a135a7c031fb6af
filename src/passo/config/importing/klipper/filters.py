"""[input_shaper], and the pressure advance of [extruder]."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.cfg import Section
from passo.config.shapers import SHAPER_FORMS, shaper_form

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.conversion import Import


def put_shapers(job: Import) -> None:
    """Imports [input_shaper]."""
    section = job.config.get("input_shaper")
    if section is not None:
        job.part(section, _put_shapers)


def _put_shapers(job: Import, section: Section) -> None:
    """Imports the shaper of each axis that has a frequency. Raises ConfigError for an unknown
    type."""
    put, common = job.draft.put, section.text("shaper_type", "mzv")
    for axis in "xyz":
        frequency = section.number(f"shaper_freq_{axis}", 0.0)
        option = (
            f"shaper_type_{axis}" if f"shaper_type_{axis}" in section.options else "shaper_type"
        )
        kind = section.text(f"shaper_type_{axis}", common).lower()
        damping = section.number(f"damping_ratio_{axis}")
        if not frequency:
            continue
        try:
            form = shaper_form(kind)
        except ValueError:
            name = f"{option} in [{section.name}]"
            raise bad(section.at(option), name, kind, SHAPER_FORMS) from None
        path = ("shaping", axis)
        put((*path, "type"), form, section.at(option))
        put((*path, "frequency_hz"), frequency, section.at(f"shaper_freq_{axis}"))
        put((*path, "damping"), damping, section.at(f"damping_ratio_{axis}"))


def put_advance(job: Import, section: Section, path: KeyPath) -> None:
    """Imports the pressure advance of an extruder."""
    put, place = job.draft.put, section.at("pressure_advance")
    put((*path, "advance_s"), section.number("pressure_advance"), place)
    smooth = section.number("pressure_advance_smooth_time")
    put((*path, "advance_smooth_s"), smooth, section.at("pressure_advance_smooth_time"))
