"""The commands that the templates of a machine file call by their names."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING

from passo.config.macro_checks import is_built_in

if TYPE_CHECKING:
    from jinja2 import Environment

    from passo.config.machine import MachineConfig

# A name at the start of a line, alone or before its parameters. No expression writes a part of it.
_WORD = re.compile(r"\s*([A-Za-z_]\w*[A-Za-z_]\w*)(?=\s|$)")
_NUMBERED = re.compile(r"[A-Z]\d+", re.IGNORECASE)
_WRITTEN = "\0"  # what an expression writes, which only the template knows
_ENDS = ("variable_end", "block_end", "comment_end", "raw_end")


@cache
def _environment() -> Environment:
    from jinja2 import Environment  # takes 50 ms, so import it only for machines with macros

    return Environment(variable_start_string="{", variable_end_string="}")


def words_called(template: str) -> dict[str, int]:
    """The commands of words that a valid template may call by literal names, in capitals, with the
    line of the first call. Numbered commands are not among them."""
    text, written = "", ""
    for _, kind, value in _environment().lex(template):
        if kind == "data":
            text += value
        else:
            written += value
            if kind in _ENDS:
                mark = _WRITTEN if kind == "variable_end" else ""
                text += "\n" * written.count("\n") + mark
                written = ""
    found: dict[str, int] = {}
    for number, line in enumerate(text.split("\n"), 1):
        match = _WORD.match(line.partition(";")[0])
        if match and not _NUMBERED.fullmatch(match[1]):
            found.setdefault(match[1].upper(), number)
    return found


def undefined_calls(
    templates: Mapping[str, str], macros: Iterable[str]
) -> Iterator[tuple[str, str, int]]:
    """The words that templates call, and that are neither commands nor macros, each once: the word,
    the name of the first template, and its line. `macros` are all names of macros."""
    seen = {name.upper() for name in macros}
    for name, template in templates.items():
        for word, line in words_called(template).items():
            if word not in seen and not is_built_in(word):
                seen.add(word)
                yield word, name, line


def machine_calls(machine: MachineConfig) -> Iterator[tuple[str, str, int]]:
    """The undefined calls of a machine's macros and delayed G-code."""
    templates = {f"macros.{name}": one.gcode for name, one in machine.macros.items()}
    templates |= {f"delayed_gcode.{name}": one.gcode for name, one in machine.delayed_gcode.items()}
    renamed = (one.rename_existing or "" for one in machine.macros.values())
    return undefined_calls(templates, [*machine.macros, *renamed])
