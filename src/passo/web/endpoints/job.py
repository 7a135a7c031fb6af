"""The print from a file of the card."""

from __future__ import annotations

from msgspec import Struct

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class FileToPrint(Struct, forbid_unknown_fields=True):
    """Where a file is on the card."""

    path: str


@operation(
    "job.start",
    "POST",
    "/job",
    Role.OPERATOR,
    errors=("card.absent", "card.not-found", "job.printing", "command.halted"),
)
async def start(call: Call, body: FileToPrint) -> None:
    """Prints a file of the card."""
    await call.bridge.start_print(body.path)


@operation("job.pause", "POST", "/job/pause", Role.OPERATOR, errors=("command.halted",))
async def pause(call: Call) -> None:
    """Pauses the print: the machine brakes and parks."""
    await call.bridge.pause_print()


@operation("job.resume", "POST", "/job/resume", Role.OPERATOR, errors=("command.halted",))
async def resume(call: Call) -> None:
    """Resumes a paused print."""
    await call.bridge.resume_print()


@operation("job.cancel", "POST", "/job/cancel", Role.OPERATOR, errors=("command.halted",))
async def cancel(call: Call) -> None:
    """Ends the print; heaters and fans go off."""
    await call.bridge.cancel_print()
