"""Sections whose values are stored settings of Passo: [firmware_retraction], and the fade and the
stored heights of [bed_mesh]."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_PER_MIN = 60
# Letters of M207 and M208 by Klipper's options, with its values without them and the factor.
_RETRACTION = {
    "M207": (
        ("S", "retract_length", 0.0, 1.0),
        ("F", "retract_speed", 20.0, _PER_MIN),
    ),
    "M208": (
        ("S", "unretract_extra_length", 0.0, 1.0),
        ("F", "unretract_speed", 10.0, _PER_MIN),
    ),
}


def put_settings(job: Import) -> None:
    """Imports all of them."""
    job.parts("firmware_retraction", convert=_put_retraction)
    for section in job.config.of("bed_mesh"):
        if section.rest:
            _remark_on_heights(job, section)


def put_fade(job: Import, section: Section) -> None:
    """Reports the fade of a mesh as the command that sets it."""
    end = section.number("fade_end", 0.0) or 0.0
    section.used |= {"fade_start", "fade_target"}
    if end > 0:
        text = f"the fade is not in the machine file: M420 Z{end:g} sets it, and M500 stores it"
        job.draft.decide(section.at("fade_end"), f"[{section.name}] fade_end", text)


def _put_retraction(job: Import, section: Section) -> None:
    commands = [
        " ".join(
            [code, *(f"{letter}{(section.number(o) or u) * k:g}" for letter, o, u, k in words)]
        )
        for code, words in _RETRACTION.items()
    ]
    text = f"G10 and G11 have stored settings: {' and '.join(commands)} set them, M500 stores them"
    job.draft.decide(section.place, f"[{section.name}]", text)


def _remark_on_heights(job: Import, section: Section) -> None:
    job.used.add(section.name)
    section.used.update(section.options)
    text = "the stored heights are not taken over: measure them with G29, and store them with M500"
    job.draft.decide(section.place, f"[{section.name}]", text)
