"""Filament sensors and endstops."""

from __future__ import annotations

from msgspec import Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class FilamentSensorSwitch(Struct, forbid_unknown_fields=True):
    """Whether a filament sensor is enabled."""

    enabled: bool


@operation(
    "inputs.enable_filament_sensor",
    "PUT",
    "/inputs/filament-sensors/{name}",
    Role.OPERATOR,
    errors=("web.not-found", "command.halted", "command.failed"),
)
async def enable_filament_sensor(call: Call, name: str, body: FilamentSensorSwitch) -> None:
    """Enables or disables a filament sensor (SET_FILAMENT_SENSOR)."""
    if name not in call.bridge.machine.filament_sensors:
        raise WebError.of("web.not-found", value=f"filament sensor {name}")
    await call.command("SET_FILAMENT_SENSOR", SENSOR=name, ENABLE=float(body.enabled))


@operation("inputs.endstops", "GET", "/inputs/endstops", Role.VIEWER, errors=("command.halted",))
async def endstops(call: Call) -> dict[str, bool]:
    """Asks the boards whether each endstop is triggered."""
    return await call.bridge.endstops()
