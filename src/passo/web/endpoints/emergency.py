"""Emergency stop, and the restart after it."""

from __future__ import annotations

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


@operation("emergency.stop", "POST", "/stop", Role.OPERATOR)
async def stop(call: Call) -> None:
    """Switches heaters, motors and fans off at once (M112). The print is lost, and axes are not
    homed any more."""
    call.bridge.emergency_stop()


@operation("emergency.restart", "POST", "/restart", Role.OPERATOR, errors=("command.failed",))
async def restart(call: Call) -> None:
    """Restarts a halted printer (M999); answers when it runs."""
    await call.bridge.restart()
