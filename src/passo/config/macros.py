"""Commands that the machine file defines: macros, and delayed G-code."""

from __future__ import annotations

import ast
import json
from copy import deepcopy
from typing import Annotated, Any

from pydantic import Field

from passo.config.types import CommandName, Model, VariableName

MAX_LITERAL = 65_536  # characters


def literal(text: str) -> Any:
    """The value of a text in Python's notation: None, a number, a truth value, a text in quotes, or
    a list, tuple or table of them. Raises ValueError for any other text."""
    try:
        if len(text) > MAX_LITERAL:
            raise ValueError
        value = ast.literal_eval(text)
        json.dumps(value, allow_nan=False)
    except (MemoryError, RecursionError, SyntaxError, TypeError):
        raise ValueError from None
    return value


class Macro(Model):
    """Your own command: a template of G-code in the language of Klipper's macros. See [how to write
    a macro](../how-to/write-a-macro.md)."""

    gcode: str
    """The template. `{...}` writes a value, `{% ... %}` is a statement of Jinja2."""
    description: str = ""
    """One line about the macro, for lists of commands."""
    rename_existing: CommandName | None = None
    """The name by which the macro can call the built-in command that it replaces. Required if the
    macro has the name of a built-in command. While the macro runs, also in macros that it calls,
    its own name is the command too."""
    variables: dict[VariableName, Any] = {}
    """Variables of the template, available by their names and in `variables`. SET_GCODE_VARIABLE
    changes them until the program ends."""
    literals: dict[VariableName, str] = {}
    """Variables with values that TOML does not have, as texts in Python's notation, such as
    `"None"`, `"(10, 20)"` or `"{0: 'PLA', 1: 'PETG'}"`."""

    def values(self) -> dict[str, Any]:
        """All variables with their values, which belong to the caller."""
        parsed = {name: literal(text) for name, text in self.literals.items()}
        return {**deepcopy(self.variables), **parsed}


class DelayedGcode(Model):
    """A template of G-code that a served printer executes after a delay. UPDATE_DELAYED_GCODE sets
    a new delay."""

    gcode: str
    """The template, in the same language as that of a macro."""
    initial_duration_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    """The delay from the start of the printer. With 0, it runs only after UPDATE_DELAYED_GCODE."""
    when_idle: bool = False
    """Whether it also runs once when the printer has been idle for `idle.heaters_off_s`."""
