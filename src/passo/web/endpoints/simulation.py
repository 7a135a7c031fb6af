"""Faults of the simulated printer."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.web.bridge import SimulatedPart
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class PartFault(Struct, forbid_unknown_fields=True):
    """The new fault of a part; `none` ends a fault. `noise` may have an amount, as in
    `noise:0.05`."""

    fault: Annotated[str, Meta(max_length=40, pattern=r"^[a-z]+(:[0-9.]+)?$")]


PartName = Annotated[str, Meta(max_length=100, pattern=r"^[A-Za-z0-9_-]+$")]


@operation("simulation.parts", "GET", "/simulation/parts", Role.VIEWER)
async def parts(call: Call) -> list[SimulatedPart]:
    """The parts of the simulated printer that can have faults; empty if the boards are real."""
    return await call.bridge.simulated_parts()


@operation(
    "simulation.set_fault",
    "PUT",
    "/simulation/parts/{part}",
    Role.OPERATOR,
    errors=("command.real-board", "command.no-fault"),
)
async def set_fault(call: Call, part: PartName, body: PartFault) -> None:
    """Gives a part of the simulated printer a fault, or ends it, even while the printer is halted
    (SIMULATE_FAULT)."""
    await call.command("SIMULATE_FAULT", NAME=part, VALUE=body.fault)
