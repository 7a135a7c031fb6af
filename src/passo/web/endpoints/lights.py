"""Coloured lights."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

_Share = Annotated[float, Meta(ge=0, le=1)]


class LightColor(Struct, forbid_unknown_fields=True):
    """A colour, as fractions of full brightness, of one LED of a light, from 1; without `led`, of
    all."""

    red: _Share = 0.0
    green: _Share = 0.0
    blue: _Share = 0.0
    white: _Share = 0.0
    led: Annotated[float, Meta(ge=1, multiple_of=1)] | None = None


@operation(
    "lights.set",
    "PUT",
    "/lights/{name}/color",
    Role.OPERATOR,
    errors=("web.not-found", "command.value", "command.halted", "command.failed"),
)
async def set_color(call: Call, name: str, body: LightColor) -> None:
    """Sets the colour of a light after the planned moves (SET_LED). An effect or a template of the
    light stays visible."""
    if name not in call.bridge.machine.lights:
        raise WebError.of("web.not-found", value=f"light {name}")
    led = {} if body.led is None else {"INDEX": body.led}
    color = {"RED": body.red, "GREEN": body.green, "BLUE": body.blue, "WHITE": body.white}
    await call.command("SET_LED", LED=name, **color, **led)
