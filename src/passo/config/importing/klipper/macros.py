"""[gcode_macro]: Passo uses the same language for templates."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, cast

from passo.config.importing.klipper.conversion import TABLE
from passo.config.importing.klipper.safe_home import put_homing_macro
from passo.config.klipper_options import OPTIONS, kind_of
from passo.config.macro_calls import undefined_calls
from passo.config.macro_checks import KEPT, LETTERED, is_built_in
from passo.config.macros import literal
from passo.config.types import COMMAND, VARIABLE

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_FREE = 9000  # code numbers from here on are not used by any firmware


def put_macros(job: Import) -> None:
    """Imports all macros. A [homing_override], or a [safe_z_home] that needs one, becomes a macro
    G28."""
    for section in job.config.of("gcode_macro"):
        _put_macro(job, section)
    put_homing_macro(job)


def put_undefined_calls(job: Import) -> None:
    """A call of a command that no file of the configuration defines. Klipper reports it and goes
    on, so an empty macro that reports it stands for the command; but not beside a plug-in that
    Passo does not have, whose command may be more than a light."""
    keys, draft = job.draft.keys, job.draft
    gcodes = {path: str(value) for path, (value, _) in keys.items() if path[-1] == "gcode"}
    templates = {".".join(path[:-1]): text for path, text in gcodes.items()}
    renamed = [str(value) for path, (value, _) in keys.items() if path[-1] == "rename_existing"]
    macros = [path[1] for path in keys if path[0] == "macros"]
    plug_ins = [name for name in job.config.sections if _of_plug_in(job, name)]
    for word, name, line in undefined_calls(templates, [*macros, *renamed]):
        path = next(path for path in gcodes if ".".join(path[:-1]) == name)
        place, what = keys[path][1], f"{word} in {path[1]}, line {line}"
        if place is None:
            continue  # a default of Klipper's, which calls what is built in
        if plug_ins:
            text = f"no file here defines it, unless [{plug_ins[0]}] has it: a print stops there"
            draft.decide(place, what, f"{text}. Remove the call, or write a macro {word}")
        elif re.fullmatch(COMMAND, word):
            draft.put(("macros", word, "gcode"), f"M118 {word}: no file defines it", place)
            text = f"no file here defines it: a macro {word} that only says so stands for it"
            draft.changed(place, what, text)


def _of_plug_in(job: Import, section: str) -> bool:
    """Whether the section is one of a plug-in that Passo does not have, and that may move."""
    kind = kind_of(section)
    known = kind in OPTIONS or kind == "board_pins"
    if known or (section in job.used and section not in job.left_out):
        return False
    row = TABLE.notes("sections").get(kind)
    return row is None or row.fate == "decide"


def _put_macro(job: Import, section: Section) -> None:
    job.used.add(section.name)
    written, put = section.rest, job.draft.put
    name = written.upper()
    if name == "M300" and ("beeper", "pin") in job.draft.keys:
        text = "the beeper of the machine file sounds at M300 without a macro"
        job.draft.changed(section.place, f"[{section.name}]", text)
        section.used.update(section.options)
        return
    if not re.fullmatch(COMMAND, written) or name in KEPT:
        text = f"a macro of Passo cannot have the name {written}"
        job.draft.dropped(section.place, f"[{section.name}]", text)
        section.used.update(section.options)
        return
    path = ("macros", written)
    job.put("macro", section, name=written)
    renamed = _renamed(job, section, name)
    job.put_value((*path, "rename_existing"), section, "rename_existing", renamed)
    for option, found in section.options.items():
        if not option.startswith("variable_"):
            continue
        section.used.add(option)
        variable = option.removeprefix("variable_")
        if not re.fullmatch(VARIABLE, variable):
            text = f"a variable of Passo cannot have the name {variable}"
            job.draft.dropped(found.place, f"[{section.name}] {option}", text)
            continue
        try:
            value = literal(found.text)
        except ValueError:
            text = f"{found.text} is not a value that a variable can have"
            job.draft.dropped(found.place, f"[{section.name}] {option}", text)
            continue
        if _in_toml(value):
            put((*path, "variables", variable), value, found.place)
        else:
            put((*path, "literals", variable), found.text, found.place)


def _renamed(job: Import, section: Section, name: str) -> str | None:
    """The name by which a macro can call the built-in command that it replaces; None for a macro
    that does not replace one."""
    written = section.text("rename_existing").upper()
    place, what = section.at("rename_existing"), f"[{section.name}] rename_existing {written}"
    if not is_built_in(name):
        if written:
            job.draft.changed(place, what, f"Passo has no {name} that could be renamed")
        return None
    lettered = LETTERED.match(name)
    fits = re.fullmatch(COMMAND, written) and bool(LETTERED.match(written)) == bool(lettered)
    if fits and not is_built_in(written):
        return written
    number = name[1:].partition(".")[0]
    letter = "M" if name[0] == "T" else name[0]  # T with a number would be a tool
    other = f"{letter}{_FREE + int(number)}" if lettered else f"BASE_{name}"
    if written:
        text = f"Passo cannot name a command so: it is {other}, also in the text of the macro"
        job.draft.changed(place, what, text)
        key = ("macros", section.rest, "gcode")
        gcode, origin = job.draft.keys[key]
        pattern = rf"\b{re.escape(written)}\b"
        gcode = re.sub(pattern, other, str(gcode), flags=re.IGNORECASE)
        job.draft.keys[key] = gcode, origin
    else:
        text = f"it replaces a command of Passo, which the macro can reach as {other}"
        job.draft.changed(section.place, f"[{section.name}]", text)
    return other


def _in_toml(value: object) -> bool:
    """Whether TOML has this value, with the same types."""
    if isinstance(value, list):
        return all(_in_toml(one) for one in cast("list[object]", value))
    if isinstance(value, dict):
        pairs = cast("dict[object, object]", value)
        return all(isinstance(key, str) and _in_toml(one) for key, one in pairs.items())
    if isinstance(value, int):
        return -(2**63) <= value < 2**63
    return isinstance(value, float | str)
