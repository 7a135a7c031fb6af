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
    `Metadata`. `run` is a UUID that the client makes for this print: a request that is repeated
    with it, for example because the answer was lost, starts nothing."""

    path: str
    allow: list[Allowance] = []
    run: Annotated[str, Meta(max_length=64)] = ""


class Started(Struct):
    """`known`: the run id was used before, and nothing has started."""

    known: bool


class ObjectState(Struct, forbid_unknown_fields=True):
    """Whether an object is cancelled."""

    cancelled: bool


class HowMany(Struct, forbid_unknown_fields=True):
    """The maximum number."""

    limit: Annotated[int, Meta(ge=1, le=1000)] = 50


@operation(
    "job.start",
    "POST",
    "/job/start",
    Role.OPERATOR,
    errors=(
        *("card.absent", "card.not-found", "card.directory", "card.removed"),
        *("job.printing", "command.halted", "run.invalid", "run.unwritable", "run.damaged"),
    ),
)
async def start(call: Call, body: FileToPrint) -> Started:
    """Prints a file of the card. With a run id it is printed at most once: the printer stores the
    run id before the print starts, and knows the last 100, also after a restart if it has a folder
    for them (`--state`)."""
    return Started(await call.bridge.start_print(body.path, body.allow, body.run))


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
