"""Checks of macros: allowed names, and valid templates."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, cast

from passo.config.findings import Finding, tables
from passo.config.macros import literal
from passo.gcode.registry import row_of

# Commands that a macro must not replace: moves, which are planned without Python; commands that act
# before their line is reached, or belong to the line protocol; commands that end a program or call
# its parts; labels of objects, which are read ahead. fmt: off
KEPT = frozenset(
    {
        "G0",
        "G1",
        "G2",
        "G3",
        "M2",
        "M30",
        "M98",
        "M99",
        "EOF",
        "M28",
        "M29",
        "M108",
        "M110",
        "M112",
        "M410",
        "M486",
        "M876",
        "M922",
        "M932",
        "M933",
        "M999",
        "RESTART",
        "FIRMWARE_RESTART",
        "SAVE_VARIABLE",
        "EXCLUDE_OBJECT",
        "EXCLUDE_OBJECT_DEFINE",
        "EXCLUDE_OBJECT_START",
        "EXCLUDE_OBJECT_END",
        "SET_GCODE_VARIABLE",
        "UPDATE_DELAYED_GCODE",
    }
)
# fmt: on
_INPUT_TEMPLATES = {
    "filament_sensors": ("runout_gcode", "insert_gcode"),
    "buttons": ("press_gcode", "release_gcode"),
}
_LONGEST = 65_536  # maximum characters of a template
LETTERED = re.compile(r"[GMT]\d", re.IGNORECASE)


def check_macros(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks the macros in the raw tables of a machine file."""
    macros = dict(tables(data, "macros"))
    codes = Counter(name.upper() for name in macros)
    taken = set(codes)
    for written, macro in macros.items():
        path, name = ("macros", written), written.upper()
        if codes[name] > 1:
            limit = "another name: a name in another case is the same command"
            yield Finding("config.conflict", path, written, limit)
        if name in KEPT:
            limit = "another name: moves, stops and the control of programs stay as they are"
            yield Finding("config.conflict", path, written, limit)
            continue
        yield from _check_template(path, macro)
        yield from _check_literals(path, macro)
        other = macro.get("rename_existing")
        built_in = is_built_in(name)
        if other is None:
            if built_in:
                limit = f"a name for the built-in {name}, by which the macro reaches it"
                yield Finding("config.missing-key", (*path, "rename_existing"), None, limit)
            continue
        path = (*path, "rename_existing")
        if not isinstance(other, str):
            continue
        other = other.upper()
        if not built_in:
            yield Finding("config.conflict", path, other, f"no such key: {name} is not built in")
        elif other in taken or is_built_in(other):
            yield Finding("config.conflict", path, other, "a name that no other command has")
        elif bool(LETTERED.match(other)) != bool(LETTERED.match(name)):
            shape = "a letter and a number" if LETTERED.match(name) else "a word"
            yield Finding("config.value", path, other, f"{shape}, as {name} is")
        taken.add(other)
    for name, delayed in tables(data, "delayed_gcode"):
        yield from _check_template(("delayed_gcode", name), delayed)
    for name, template in tables(data, "light_templates"):
        yield from _check_template(("light_templates", name), template, "color")
    if isinstance(probe := data.get("probe"), Mapping):
        for key in ("arm_gcode", "disarm_gcode"):
            yield from _check_template(("probe",), cast("Mapping[str, Any]", probe), key)
    for part, keys in _INPUT_TEMPLATES.items():
        for name, content in tables(data, part):
            for key in keys:
                if key in content:
                    yield from _check_template((part, name), content, key)


def _check_literals(path: tuple[str, ...], macro: Mapping[str, Any]) -> Iterator[Finding]:
    variables, literals = macro.get("variables"), macro.get("literals")
    if not isinstance(literals, Mapping):
        return
    for name, text in cast("Mapping[str, object]", literals).items():
        if isinstance(variables, Mapping) and name in variables:
            limit = "another name: variables has it too"
            yield Finding("config.conflict", (*path, "literals", name), name, limit)
        elif isinstance(text, str):
            try:
                literal(text)
            except ValueError:
                limit = "a value in Python's notation, such as None, (10, 20) or {0: 'PLA'}"
                yield Finding("config.value", (*path, "literals", name), text, limit)


def is_built_in(code: str) -> bool:
    """Whether the code is a command of Passo."""
    return row_of("T" if re.fullmatch(r"T\d+", code) else code) is not None


def _check_template(
    path: tuple[str, ...], content: Mapping[str, Any], key: str = "gcode"
) -> Iterator[Finding]:
    text = content.get(key)
    if not isinstance(text, str):
        return
    if len(text) > _LONGEST:
        limit = f"a template of at most {_LONGEST:,} characters"
        yield Finding("config.value", (*path, key), f"{len(text):,} characters", limit)
        return
    # takes 50 ms, so import it only for machines with macros
    from passo.gcode.template import Template, TemplateFault

    try:
        Template(text)
    except TemplateFault as fault:
        where = f"line {fault.line} of the template" if fault.line else "the template"
        lines = text.splitlines()
        value = lines[fault.line - 1] if fault.line and fault.line <= len(lines) else text[:40]
        limit = f"G-code with expressions of Jinja2; {where}: {fault.reason}"
        yield Finding("config.value", (*path, key), value.strip(), limit)
