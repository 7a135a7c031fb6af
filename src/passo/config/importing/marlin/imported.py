"""Configuration.h as a draft of a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.geometry_kinds import KINDS
from passo.config.importing.draft import Draft
from passo.config.importing.marlin.bed import put_bed, put_levelling, put_probe
from passo.config.importing.marlin.boards import Pins, known_board
from passo.config.importing.marlin.conversion import TABLE, Job
from passo.config.importing.marlin.defines import read
from passo.config.importing.marlin.features import put_board, put_features
from passo.config.importing.marlin.heat import count_extruders, put_heat
from passo.config.importing.marlin.motion import put_motion
from passo.config.importing.marlin.others import is_silent
from passo.config.importing.marlin.stored import put_stored
from passo.config.importing.sources import Sources
from passo.config.importing.table import report

if TYPE_CHECKING:
    from pathlib import Path

_MK4DUO = ("Basic", "Overall", "Cartesian", "Core", "Delta", "Mechanics", "Motor_Driver")
_MK4DUO_FILES = (*_MK4DUO, "Temperature", "Feature", "Pins")
_OFF = ("0", "false", "-1")


def imported(path: Path, stored: Path | None = None, *, board: str | None = None) -> Draft:
    """Converts a Configuration.h and the files in its folder to a machine file with remarks.
    `stored` is a file with an answer to M503, whose values replace those of the configuration.
    `board` is the board file to use.
    Raises ConfigError for a file that cannot be read, for a kind of machine that Passo does not
    support, and for values that would be dangerous."""
    mk4duo = path.stem.endswith(tuple(f"Configuration_{name}" for name in _MK4DUO))
    if mk4duo:
        stem = path.stem.rpartition("Configuration_")[0]
        companions = [f"{stem}Configuration_{name}{path.suffix}" for name in _MK4DUO_FILES]
    else:
        companions = [f"{path.stem}_adv{path.suffix}"]
    defines, draft = read(path, companions), Draft()
    known = known_board(defines, board)
    job = Job(defines, draft, Pins(defines, known), mk4duo or "MECHANISM" in defines.found)
    draft.put_head(path, defines.text("CUSTOM_MACHINE_NAME") or path.stem)
    _put_all(job)
    put_board(job, known)
    _remark_on_the_rest(job)
    if stored is not None:
        motors = dict(zip("xyz", KINDS[job.kind].motors, strict=True))
        put_stored(draft, Sources().read(stored), stored.name, motors)
    return draft


def _put_all(job: Job) -> None:
    """Converts everything, in the order of other machine files. The probe is read before the axes,
    because it may home Z."""
    draft = job.draft
    count_extruders(job)
    if not job.part("NOZZLE_TO_PROBE_OFFSET", lambda: put_probe(job)):
        job.trigger_mm = None
    probe = [key for key in draft.keys if key[0] == "probe"]
    put_motion(job)
    job.part("X_BED_SIZE", lambda: put_bed(job))
    for key in probe:
        draft.keys[key] = draft.keys.pop(key)
    job.part("GRID_MAX_POINTS_X", lambda: put_levelling(job))
    put_heat(job)
    put_features(job)


def _remark_on_the_rest(job: Job) -> None:
    """Reports the options that nothing has read: those that are known by their names one by one,
    all others together."""
    defines, draft = job.defines, job.draft
    others = TABLE.notes("options")
    for name, row in others.items():
        text, place = defines.found.get(name, ("0", None))
        if place is not None and text not in _OFF and name not in defines.used:
            report(draft, row, place, name)
    rest = [
        name
        for name, (text, _) in defines.found.items()
        if name not in defines.used
        and name not in others
        and not is_silent(name)
        and text not in _OFF
    ]
    if rest:
        text = f"Passo has no such setting: {', '.join(rest)}"
        draft.dropped(defines.place(rest[0]), "Other defines", text)
    for name in sorted(defines.used & defines.undecided.keys() - defines.found.keys()):
        condition, place = defines.undecided[name]
        text = f"Passo cannot decide {condition!r}, so it does not read this define"
        draft.decide(place, name, text)
