"""Outputs that commands switch."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class OutputValue(Struct, forbid_unknown_fields=True):
    """The value of an output, as a fraction of fully on. An output without PWM takes 0 or 1."""

    value: Annotated[float, Meta(ge=0, le=1)]


@operation(
    "outputs.set",
    "PUT",
    "/outputs/{name}/value",
    Role.OPERATOR,
    errors=("web.not-found", "command.value", "command.halted", "command.failed"),
)
async def set_value(call: Call, name: str, body: OutputValue) -> None:
    """Sets an output after the planned moves (SET_PIN)."""
    found = call.bridge.machine.outputs.get(name)
    if found is None or found.fixed:
        raise WebError.of("web.not-found", value=f"output {name} that commands set")
    await call.command("SET_PIN", PIN=name, VALUE=body.value * found.scale)
