"""The print from a file of the card."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.web.bridge import PastPrint
from passo.web.call import Call
from passo.web.files.metadata import Allowance
from passo.web.operation import operation
from passo.web.roles import Role


class FileToPrint(Struct, forbid_unknown_fields=True):
    """The path of a file on the card. `allow` is what the print may do in place of a failure, see
    `Metadata`."""

    path: str
    allow: list[Allowance] = []


class ObjectState(Struct, forbid_unknown_fields=True):
    """Whether an object is cancelled."""

    cancelled: bool


class HowMany(Struct, forbid_unknown_fields=True):
    """The maximum number."""

    limit: Annotated[int, Meta(ge=1, le=1000)] = 50


@operation(
    "job.start",
    "POST",
    "/job",
    Role.OPERATOR,
    errors=(
        *("card.absent", "card.not-found", "card.directory", "card.removed"),
        *("job.printing", "command.halted"),
    ),
)
async def start(call: Call, body: FileToPrint) -> None:
    """Prints a file of the card."""
    await call.bridge.start_print(body.path, body.allow)


@operation("job.pause", "POST", "/job/pause", Role.OPERATOR, errors=("command.halted",))
async def pause(call: Call) -> None:
    """Pauses the print: the machine brakes and parks."""
    await call.bridge.pause_print()


@operation(
    "job.resume",
    "POST",
    "/job/resume",
    Role.OPERATOR,
    errors=("job.no-file", "job.at-end", "job.printing", "input.not-homed", "command.halted"),
)
async def resume(call: Call) -> None:
    """Resumes a paused print."""
    await call.bridge.resume_print()


@operation("job.cancel", "POST", "/job/cancel", Role.OPERATOR, errors=("command.halted",))
async def cancel(call: Call) -> None:
    """Ends the print; heaters and fans go off."""
    await call.bridge.cancel_print()


@operation(
    "job.cancel_object",
    "PUT",
    "/job/objects/{number}",
    Role.OPERATOR,
    errors=("job.no-objects", "job.no-object", "job.objects-and-laser"),
)
async def cancel_object(call: Call, number: int, body: ObjectState) -> None:
    """Cancels an object of the print, or prints it again. `number` is its number in the status."""
    await call.bridge.cancel_object(number, cancelled=body.cancelled)


@operation(
    "job.past", "GET", "/job/past", Role.VIEWER, errors=("settings.nowhere", "history.unusable")
)
async def past(call: Call, query: HowMany) -> list[PastPrint]:
    """The last finished prints, newest first."""
    return await call.bridge.past_prints(query.limit)
