"""Commands that the machine file defines: macros, and G-code that runs after a time."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from passo.config.types import CommandName, Model, VariableName


class Macro(Model):
    """A command of your own: a template of G-code in the language of Klipper's macros. See
    [how to write a macro](../how-to/write-a-macro.md)."""

    gcode: str
    """The template. `{...}` writes a value, `{% ... %}` is a statement of Jinja2."""
    description: str = ""
    """One line about the macro, as lists of commands show it."""
    rename_existing: CommandName | None = None
    """The command by which the macro reaches the built-in command that it replaces. Required if the
    name of the macro is that of a built-in command."""
    variables: dict[VariableName, Any] = {}
    """Values that the template knows by these names and in `variables`, and that
    SET_GCODE_VARIABLE changes until the program ends."""


class DelayedGcode(Model):
    """A template of G-code that a served printer carries out after a time. UPDATE_DELAYED_GCODE
    sets the time again."""

    gcode: str
    """The template, as that of a macro."""
    initial_duration_s: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    """The time from the start of the printer; 0: only when UPDATE_DELAYED_GCODE sets one."""
