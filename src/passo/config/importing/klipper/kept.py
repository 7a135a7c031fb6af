"""Options that have no key in a machine file, and sections of parts that Passo does not have, which
macros may read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.klipper_options import OPTIONS, kind_of, option_of
from passo.config.klipper_options.left_out import stand_in

if TYPE_CHECKING:
    from passo.config.importing.klipper.conversion import Import

# Sections without a key, and options that are read for other keys.
_SECTIONS = ("pause_resume", "respond", "gcode_arcs", "save_variables", "virtual_sdcard")
_READ = {
    "extruder": ("nozzle_diameter", "filament_diameter"),
    "idle_timeout": ("gcode",),
}
_OWN = ("enable_force_move",)  # Passo has another value
_NO_PARTS = ("include", "board_pins", "gcode_macro", "delayed_gcode")


def put_kept(job: Import) -> None:
    """Keeps the options that no module has read, and the left-out sections that macros name. Call
    it after all other modules."""
    put = job.draft.put
    texts = (str(value) for path, (value, _) in job.draft.keys.items() if path[-1] == "gcode")
    words = {word for text in texts for word in re.findall(r"\w+", text)}
    for name, section in job.config.sections.items():
        whole = name not in job.used or name in job.left_out
        named = section.kind not in _NO_PARTS and (section.kind in words or section.rest in words)
        if whole and not named and section.kind not in _SECTIONS:
            continue
        read = () if whole else section.used - set(_READ.get(kind_of(name), ()))
        options = {
            option: found
            for option, found in section.options.items()
            if option not in read and option not in _OWN and _may_keep(name, option, found.text)
        }
        for option, found in options.items():
            put(("klipper", name, option), found.text, found.place)
        if whole and stand_in(name):
            job.kept.add(name)
            if not options:
                put(("klipper", name), {}, section.place)


def _may_keep(section: str, option: str, value: str) -> bool:
    """Whether a machine file may have this option. Those of plug-ins are texts."""
    row = option_of(section, option)
    return kind_of(section) not in OPTIONS if row is None else row.can_read(value)
