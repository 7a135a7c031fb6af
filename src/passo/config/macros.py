"""Commands that the machine file defines: macros, and delayed G-code."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from passo.config.types import CommandName, Model, VariableName


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


class DelayedGcode(Model):
    """A template of G-code that a served printer executes after a delay. UPDATE_DELAYED_GCODE sets
    a new delay."""

    gcode: str
    """The template, in the same language as that of a macro."""
    initial_duration_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    """The delay from the start of the printer. With 0, it runs only after UPDATE_DELAYED_GCODE."""
