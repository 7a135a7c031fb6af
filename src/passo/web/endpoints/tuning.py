"""Values that may be changed while a print runs: speed, flow, babysteps."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

ToolNumber: TypeAlias = Annotated[int, Meta(ge=0, le=99)]


class SpeedFactor(Struct, forbid_unknown_fields=True):
    """The factor of all feedrates; 1 leaves them as in the file."""

    factor: Annotated[float, Meta(ge=0.01, le=10)]


class FlowFactor(Struct, forbid_unknown_fields=True):
    """The factor of a tool's extrusion; 1 leaves it as in the file."""

    factor: Annotated[float, Meta(ge=0.01, le=10)]


class Babystep(Struct, forbid_unknown_fields=True):
    """The distance, in mm, by which all remaining moves shift along an axis, in addition to earlier
    shifts."""

    axis: str
    distance_mm: Annotated[float, Meta(ge=-2, le=2)]


_ERRORS = ("command.value", "command.halted", "command.failed")


@operation("tuning.set_speed", "PUT", "/tuning/speed", Role.OPERATOR, errors=_ERRORS)
async def set_speed(call: Call, body: SpeedFactor) -> None:
    """Scales the speed; during a print, also that of planned moves (M220)."""
    await call.command("M220", S=body.factor * 100)


@operation("tuning.set_flow", "PUT", "/tuning/flow/{tool}", Role.OPERATOR, errors=_ERRORS)
async def set_flow(call: Call, tool: ToolNumber, body: FlowFactor) -> None:
    """Scales the extrusion of a tool; during a print, also that of planned moves (M221)."""
    await call.command("M221", T=tool, S=body.factor * 100)


@operation(
    "tuning.babystep",
    "POST",
    "/tuning/babystep",
    Role.OPERATOR,
    errors=("web.not-found", *_ERRORS),
)
async def babystep(call: Call, body: Babystep) -> None:
    """Shifts all remaining moves along an axis, at once (M290)."""
    if body.axis not in call.bridge.machine.axes:
        raise WebError.of("web.not-found", value=f"axis {body.axis}")
    await call.command("M290", **{body.axis.upper(): body.distance_mm})
