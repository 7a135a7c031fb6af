"""The current errors of the printer."""

from __future__ import annotations

from passo.printer.status import FaultStatus
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


@operation("faults.list", "GET", "/faults", Role.VIEWER)
async def faults(call: Call) -> list[FaultStatus]:
    """Why the printer is halted, as errors of the catalogue; empty while it runs.
    `emergency.restart` starts it again."""
    return list(call.bridge.latest().status.faults)
