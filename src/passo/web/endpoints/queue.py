"""The files that are to be printed next."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import CommandError
from passo.job.live.print_queue import QueuedPrint
from passo.web.bridge import Queue
from passo.web.call import Call
from passo.web.files.names import confined
from passo.web.operation import operation
from passo.web.roles import Role


class QueueFile(Struct, forbid_unknown_fields=True):
    """A file of the card."""

    path: str


class QueueMode(Struct, forbid_unknown_fields=True):
    """Whether the next print starts by itself after one that is done: for printers that clear their
    bed."""

    automatic: bool


class ClearBed(Struct, forbid_unknown_fields=True):
    """The user confirms that the bed is clear."""

    bed_clear: Annotated[bool, Meta(description="true, or nothing starts")]


_NUMBER = ("queue.unknown", "queue.unwritable")
_CARD = ("card.absent", "card.not-found", "card.directory", "card.name")


@operation("queue.get", "GET", "/queue", Role.VIEWER)
async def get(call: Call) -> Queue:
    """The prints that wait, the next one first. It lasts over a restart if the printer has a folder
    for it (`--state`)."""
    return await call.bridge.queue()


@operation(
    "queue.add",
    "POST",
    "/queue",
    Role.OPERATOR,
    errors=("queue.full", "queue.unwritable", *_CARD),
)
async def add(call: Call, body: QueueFile) -> QueuedPrint:
    """Puts a file of the card at the end."""
    return await call.bridge.queue_print(confined(body.path))


@operation("queue.remove", "DELETE", "/queue/prints/{number}", Role.OPERATOR, errors=_NUMBER)
async def remove(call: Call, number: int) -> None:
    """Takes a print out."""
    await call.bridge.unqueue_print(number)


@operation(
    "queue.move", "PUT", "/queue/prints/{number}/place/{place}", Role.OPERATOR, errors=_NUMBER
)
async def move(call: Call, number: int, place: int) -> None:
    """Moves a print: to place 0 to be the next one, to a place beyond the end to be the last."""
    await call.bridge.move_queued_print(number, place)


@operation("queue.mode", "PUT", "/queue/mode", Role.OPERATOR, errors=("queue.unwritable",))
async def mode(call: Call, body: QueueMode) -> None:
    """Whether the next print waits for `queue.start`, as it does by default."""
    await call.bridge.set_queue_mode(automatic=body.automatic)


@operation(
    "queue.start",
    "POST",
    "/queue/start",
    Role.OPERATOR,
    errors=(
        "queue.empty",
        "queue.bed",
        "queue.unwritable",
        "job.printing",
        "command.halted",
        *_CARD,
    ),
)
async def start(call: Call, body: ClearBed) -> None:
    """Starts the next print, and takes it out of the queue."""
    if not body.bed_clear:
        raise CommandError.of("queue.bed")
    await call.bridge.start_queued_print()
