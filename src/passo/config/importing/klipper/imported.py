"""Converts a printer.cfg to a draft of a machine file."""

from __future__ import annotations

from pathlib import Path

from passo.config.importing.draft import Draft, lost
from passo.config.importing.klipper.accelerometer import put_accelerometer
from passo.config.importing.klipper.bed import put_mesh, put_probe
from passo.config.importing.klipper.cfg import Config
from passo.config.importing.klipper.conversion import Import
from passo.config.importing.klipper.filters import put_shapers
from passo.config.importing.klipper.heat import put_heat
from passo.config.importing.klipper.kept import put_kept
from passo.config.importing.klipper.levelling import put_levelling
from passo.config.importing.klipper.macros import put_macros
from passo.config.importing.klipper.mcus import finish_boards, put_boards
from passo.config.importing.klipper.motion import put_motion
from passo.config.importing.klipper.others import OPTIONS, OTHERS
from passo.config.importing.klipper.pins import MAIN, Pins
from passo.config.importing.klipper.settings import put_settings
from passo.config.klipper_options.left_out import sentences

# Options with values that Passo determines itself, or that have no meaning in Passo.
_SILENT = {
    MAIN: {"restart_method", "max_stepper_error"},
}


def imported(path: Path, *, board: str | None = None, skip_missing: bool = False) -> Draft:
    """The machine file for a printer.cfg, with remarks. `board` is the name of the main board's
    file; with `skip_missing`, includes of missing files are left out. Raises ConfigError for a file
    that cannot be read, for an unsupported kind of machine, and for values without which the
    machine cannot move."""
    config, draft = Config(path, skip_missing=skip_missing), Draft()
    job = Import(config, draft, Pins(config, draft))
    draft.put_head(path, path.stem)
    put_probe(job)
    put_motion(job)
    put_heat(job)
    probe = [key for key in draft.keys if key[0] == "probe"]
    for key in probe:  # after motion and heat, as in other machine files
        draft.keys[key] = draft.keys.pop(key)
    put_mesh(job)
    put_levelling(job)
    put_shapers(job)
    put_boards(job, board)
    put_accelerometer(job)
    finish_boards(job)
    put_settings(job)
    put_macros(job)
    put_kept(job)
    _remark_on_the_rest(job)
    return draft


def _remark_on_the_rest(job: Import) -> None:
    """Reports the sections and the options that no module has read, and missing files."""
    for include in job.config.missing:
        text = "the file is missing, and everything in it"
        job.draft.dropped(include.place, f"[include {include.file}]", text)
    for name, section in job.config.sections.items():
        if name in job.used or section.kind == "board_pins":
            for option, found in section.options.items():
                known = _SILENT.get(section.kind, set[str]())
                if (
                    option not in section.used
                    and option not in known
                    and section.kind != "board_pins"
                ):
                    text = OPTIONS.get(option, "Passo has no such setting")
                    job.draft.dropped(found.place, f"[{name}] {option}", text)
            continue
        other = OTHERS.get(section.kind, lost("Passo does not have this part"))
        if name in job.kept:
            [says] = sentences([name])
            other = other._replace(text=f"{other.text}; {says}")
        job.draft.other(section.place, f"[{name}]", other)
