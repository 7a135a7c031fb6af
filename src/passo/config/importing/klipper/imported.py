"""Converts a printer.cfg to a draft of a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import Draft
from passo.config.importing.klipper.accelerometer import put_accelerometer
from passo.config.importing.klipper.bed import put_mesh, put_probe, put_twist
from passo.config.importing.klipper.cfg import Config
from passo.config.importing.klipper.conversion import TABLE, Import
from passo.config.importing.klipper.heat import put_heat
from passo.config.importing.klipper.inputs import put_buttons, put_filament_sensors
from passo.config.importing.klipper.kept import put_kept
from passo.config.importing.klipper.levelling import put_levelling
from passo.config.importing.klipper.light_effects import put_light_effects
from passo.config.importing.klipper.light_templates import put_light_templates
from passo.config.importing.klipper.lights import put_lights
from passo.config.importing.klipper.macros import put_macros, put_undefined_calls
from passo.config.importing.klipper.mcus import finish_boards, put_boards
from passo.config.importing.klipper.motion import put_motion
from passo.config.importing.klipper.outputs import put_outputs
from passo.config.importing.klipper.pins import MAIN, Pins
from passo.config.importing.klipper.settings import put_settings
from passo.config.importing.table import Row, report
from passo.config.klipper_options.left_out import stand_in
from passo.config.part_names import part_name
from passo.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

    from passo.config.importing.klipper.cfg import Missing, Section

# Options with values that Passo determines itself, or that have no meaning in Passo.
_SILENT = {MAIN: ("restart_method", "max_stepper_error")}
_MISSING = Row(
    option="",
    fate="decide",
    note="the file is missing, and everything in it: copy it beside printer.cfg, and import again",
)
_NO_PART = Row(option="", fate="dropped", note="Passo does not have this part")
_NO_OPTION = Row(option="", fate="dropped", note="Passo has no such setting")


def imported(path: Path, *, board: str | None = None) -> Draft:
    """The machine file for a printer.cfg, with remarks. `board` is the name of the main board's
    file. Raises ConfigError for a file that cannot be read, for an unsupported kind of machine, and
    for values without which the machine cannot move; then also for missing included files, which
    may have them."""
    config, draft = Config(path), Draft()
    draft.put_head(path, path.stem)
    try:
        _put_all(Import(config, draft, Pins(config, draft)), board)
    except ConfigError as error:
        missing = [one.problem for one in config.missing if _include(one).fate == "decide"]
        raise ConfigError([*error.problems, *missing]) from None
    return draft


def _put_all(job: Import, board: str | None) -> None:
    draft = job.draft
    put_probe(job)
    put_twist(job)
    put_motion(job)
    put_heat(job)
    put_outputs(job)
    put_light_effects(job, put_lights(job))
    put_light_templates(job)
    probe = [key for key in draft.keys if key[0] == "probe"]
    for key in probe:  # after motion and heat, as in other machine files
        draft.keys[key] = draft.keys.pop(key)
    put_mesh(job)
    put_levelling(job)
    job.parts("input_shaper", convert=_put_shapers)
    put_filament_sensors(job)
    put_buttons(job)
    _put_alone(job)
    put_boards(job, board)
    put_accelerometer(job)
    finish_boards(job)
    put_settings(job)
    put_macros(job)
    put_kept(job)
    put_undefined_calls(job)
    _remark_on_the_rest(job)


def _include(include: Missing) -> Row:
    """What a missing file means: some are known by their names."""
    name = include.file.rpartition("/")[2].lower()
    known = TABLE.notes("includes")
    folder = include.file.partition("/")[0].lower()
    return known.get(name) or known.get(f"{folder}/") or _MISSING


def _put_shapers(job: Import, section: Section) -> None:
    """Converts the shaper of each axis that has a frequency."""
    for axis in "xyz":
        if section.number(f"shaper_freq_{axis}"):
            job.put("input_shaper", section, axis=axis)
        else:
            section.used |= {f"shaper_type_{axis}", f"damping_ratio_{axis}", "shaper_type"}


def _put_alone(job: Import) -> None:
    """Converts the sections that need no code."""
    for name, group in TABLE.groups.items():
        for section in [s for kind in group.of.split(", ") for s in job.config.of(kind)]:
            if group.alone:
                part = part_name(section.rest or section.kind)
                job.part(section, lambda job, one, n=name, part=part: job.put(n, one, name=part))


def _remark_on_the_rest(job: Import) -> None:
    """Reports the sections and the options that no module has read, and missing files."""
    options, others = TABLE.notes("options"), TABLE.notes("sections")
    for include in job.config.missing:
        report(job.draft, _include(include), include.place, f"[include {include.file}]")
    for name, section in job.config.sections.items():
        if section.kind == "board_pins":
            continue
        if name not in job.used:
            row = others.get(section.kind, _NO_PART)
            if name in job.kept and (part := stand_in(name)):
                row = row.model_copy(update={"note": f"{row.note}; macros read {part.says}"})
            report(job.draft, row, section.place, f"[{name}]")
            continue
        for option, found in section.options.items():
            if option not in section.used and option not in _SILENT.get(section.kind, ()):
                row = options.get(option, _NO_OPTION)
                report(job.draft, row, found.place, f"[{name}] {option}")
