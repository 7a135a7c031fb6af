"""Fans that commands control."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class FanSpeed(Struct, forbid_unknown_fields=True):
    """The speed of a fan, as a fraction of full speed."""

    speed: Annotated[float, Meta(ge=0, le=1)]


class FanTarget(Struct, forbid_unknown_fields=True):
    """The temperature below which a fan keeps its sensor, °C; 0 switches the fan off."""

    celsius: Annotated[float, Meta(ge=0, le=1200)]


@operation("fans.list", "GET", "/fans", Role.VIEWER)
async def fans(call: Call) -> dict[str, float]:
    """The last commanded speed of each fan, a fraction of full speed."""
    return call.bridge.latest().status.fans


@operation(
    "fans.set",
    "PUT",
    "/fans/{name}/speed",
    Role.OPERATOR,
    errors=("web.not-found", "command.halted", "command.failed"),
)
async def set_speed(call: Call, name: str, body: FanSpeed) -> None:
    """Sets the speed of a fan at once. Fans that follow a heater or the boards cannot be set."""
    found = call.bridge.machine.fans.get(name)
    if found is None or not found.commanded:
        raise WebError.of("web.not-found", value=f"fan {name} that commands set")
    await call.command("M106", P=found.number, S=body.speed * 255, F=True)


@operation(
    "fans.set_target",
    "PUT",
    "/fans/{name}/target",
    Role.OPERATOR,
    errors=("web.not-found", "command.halted", "command.failed"),
)
async def set_target(call: Call, name: str, body: FanTarget) -> None:
    """Sets the target of a fan with a thermostat (SET_TEMPERATURE_FAN_TARGET)."""
    found = call.bridge.machine.fans.get(name)
    if found is None or found.thermostat is None:
        raise WebError.of("web.not-found", value=f"fan {name} with a thermostat")
    await call.command("SET_TEMPERATURE_FAN_TARGET", TEMPERATURE_FAN=name, TARGET=body.celsius)
