"""Lines of G-code, as on a console."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class Script(Struct, forbid_unknown_fields=True):
    """Lines of G-code."""

    script: Annotated[str, Meta(min_length=1, max_length=65536)]


class Answer(Struct):
    """The answer of the printer, a string a line."""

    lines: list[str]


class Line(Struct):
    """A line of a console, which counts from 1, or is 0 for all consoles. `received`: from a host
    to the printer."""

    console: int
    received: bool
    text: str


class Command(Struct):
    """A command that the printer knows: its parameters, and what it does."""

    code: str
    parameters: str
    text: str


@operation(
    "console.run",
    "POST",
    "/console",
    Role.OPERATOR,
    errors=("command.halted", "command.failed", "input.not-homed", "input.cold"),
)
async def run(call: Call, body: Script) -> Answer:
    """Carries out lines of G-code, one after the other, and answers when the last one is done or
    planned. The first line that fails ends the script."""
    return Answer(list(await call.run(body.script)))


@operation("console.end_wait", "POST", "/console/end-wait", Role.OPERATOR)
async def end_wait(call: Call) -> None:
    """Ends what the printer waits for (M108): heating, a calibration, a measurement of the bed."""
    await call.run("M108")


@operation("console.history", "GET", "/console", Role.VIEWER)
async def history(call: Call) -> list[Line]:
    """The last lines of all consoles, oldest first, without secrets."""
    return [Line(line.console, line.received, line.text) for line in call.bridge.console_history()]


@operation("console.commands", "GET", "/console/commands", Role.VIEWER)
async def commands(call: Call) -> list[Command]:
    """Each command that the printer knows."""
    return [Command(row.code, row.parameters, row.text) for row in call.bridge.commands]
