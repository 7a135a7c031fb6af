"""Heaters: their temperatures and targets."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.config.heater_numbers import heater_of
from passo.errors import WebError
from passo.printer.status import HeaterStatus
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

_COMMANDS = {"hotend": ("M104", "T"), "bed": ("M140", "P"), "chamber": ("M141", "P")}


class HeaterTarget(Struct, forbid_unknown_fields=True):
    """The target of a heater, in °C; 0 switches it off."""

    celsius: Annotated[float, Meta(ge=0, le=1000)]


@operation("heaters.list", "GET", "/heaters", Role.VIEWER)
async def heaters(call: Call) -> dict[str, HeaterStatus]:
    """All heaters by name."""
    return call.bridge.latest().status.heaters


@operation(
    "heaters.set",
    "PUT",
    "/heaters/{name}/target",
    Role.OPERATOR,
    errors=("web.not-found", "command.value", "command.halted", "command.failed"),
)
async def set_target(call: Call, name: str, body: HeaterTarget) -> None:
    """Sets the target of a heater at once, and does not wait until it is reached."""
    machine = call.bridge.machine
    if name not in machine.heaters:
        raise WebError.of("web.not-found", value=f"heater {name}")
    kind = machine.heaters[name].kind
    numbers = range(len(machine.heaters) + len(machine.tools))
    number = next((i for i in numbers if heater_of(machine, kind, i) == name), None)
    if number is None:
        raise WebError.of("web.not-found", value=f"number of heater {name} in commands")
    code, letter = _COMMANDS[kind]
    await call.command(code, **{letter: number}, S=body.celsius, F=True)
