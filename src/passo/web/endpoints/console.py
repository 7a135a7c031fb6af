"""Lines of G-code, as on a console."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta, Struct

from passo.gcode.parameters import shown
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.gcode.parameters import Parameter as Declared


class Script(Struct, forbid_unknown_fields=True):
    """Lines of G-code."""

    script: Annotated[str, Meta(min_length=1, max_length=65536)]


class Answer(Struct):
    """The lines of the printer's answer."""

    lines: list[str]


class Line(Struct):
    """A line of a console. Consoles are numbered from 1; 0 means all consoles. `received`: the line
    went from a host to the printer."""

    console: int
    received: bool
    text: str


class Parameter(Struct):
    """One or several parameters of a command: letters or keys. `kind` is number, whole
    number, flag (which needs no number), text, or rest (the rest of the line is a text). `usage` is
    the names with unit, range and default. `choices` are the valid texts; empty: each is valid."""

    names: list[str]
    kind: str
    usage: str
    text: str
    unit: str
    low: float | None
    high: float | None
    default: float | None
    choices: list[str]


class Command(Struct):
    """A command of the printer: its effect and its parameters."""

    code: str
    text: str
    parameters: list[Parameter]


@operation(
    "console.run",
    "POST",
    "/console",
    Role.OPERATOR,
    errors=("command.halted", "command.failed", "input.not-homed", "input.cold"),
)
async def run(call: Call, body: Script) -> Answer:
    """Executes lines of G-code, one after the other, and answers when the last line is done or
    planned. The first line that fails ends the script."""
    return Answer(list(await call.run(body.script)))


@operation("console.end_wait", "POST", "/console/end-wait", Role.OPERATOR)
async def end_wait(call: Call) -> None:
    """Ends the current wait (M108): for a temperature, a calibration, or a measurement of the
    bed."""
    await call.command("M108")


@operation("console.history", "GET", "/console", Role.VIEWER)
async def history(call: Call) -> list[Line]:
    """The last lines of all consoles, oldest first, without secrets."""
    return [Line(line.console, line.received, line.text) for line in call.bridge.console_history()]


@operation("console.commands", "GET", "/console/commands", Role.VIEWER)
async def commands(call: Call) -> list[Command]:
    """All commands of the printer."""
    return [
        Command(row.code, row.text, [_parameter(p) for p in shown(row.parameters)])
        for row in call.bridge.commands
    ]


def _parameter(declared: Declared) -> Parameter:
    low, high = (limit if isfinite(limit) else None for limit in (declared.low, declared.high))
    return Parameter(
        *(list(declared.names), declared.form.value, declared.usage, declared.text),
        *(declared.unit, low, high, declared.default, list(declared.choices)),
    )
