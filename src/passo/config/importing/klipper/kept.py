"""Options that have no key in a machine file, and that macros may read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.klipper_options import option_of

if TYPE_CHECKING:
    from passo.config.importing.klipper.conversion import Import

# Sections without a key, and options that are read for other keys.
_SECTIONS = ("pause_resume", "respond", "gcode_arcs")
_READ = ("nozzle_diameter", "filament_diameter")
_OWN = ("enable_force_move",)  # Passo has another value


def put_kept(job: Import) -> None:
    """Keeps the options that no module has read. Call it after all other modules."""
    for name, section in job.config.sections.items():
        if name not in job.used and section.kind not in _SECTIONS:
            continue
        for option, found in section.options.items():
            row = option_of(name, option)
            if row is None or option in _OWN or not row.can_read(found.text):
                continue
            if option not in section.used or option in _READ:
                job.draft.put(("klipper", name, option), found.text, found.place)
