"""Servos."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class ServoAngle(Struct, forbid_unknown_fields=True):
    """The angle of a servo; null switches its signal off."""

    degrees: Annotated[float, Meta(ge=0, le=360)] | None


@operation(
    "servos.set",
    "PUT",
    "/servos/{name}/angle",
    Role.OPERATOR,
    errors=("web.not-found", "command.value", "command.halted", "command.failed"),
)
async def set_angle(call: Call, name: str, body: ServoAngle) -> None:
    """Turns a servo after the planned moves (SET_SERVO)."""
    if name not in call.bridge.machine.servos:
        raise WebError.of("web.not-found", value=f"servo {name}")
    to = {"WIDTH": 0.0} if body.degrees is None else {"ANGLE": body.degrees}
    await call.command("SET_SERVO", SERVO=name, **to)
