"""The queue of the next prints."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import CommandError
from passo.printer.status import Queue, QueuedPrint
from passo.web.call import Call
from passo.web.files.names import confined
from passo.web.operation import operation
from passo.web.roles import Role


class QueueFile(Struct, forbid_unknown_fields=True):
    """A file of the card."""

    path: str


class QueueMode(Struct, forbid_unknown_fields=True):
    """Whether the next print starts without confirmation after a successful print. Only for a
    printer that clears its bed itself."""

    automatic: bool


class ClearBed(Struct, forbid_unknown_fields=True):
    """The user confirms that no print is left on the bed."""

    bed_clear: Annotated[bool, Meta(description="must be true, else no print starts")]


_NUMBER = ("queue.unknown", "queue.unwritable")
_CARD = ("card.absent", "card.not-found", "card.directory", "card.name")


@operation("queue.get", "GET", "/queue", Role.VIEWER)
async def get(call: Call) -> Queue:
    """The queued prints, the next one first. The queue survives a restart if the printer has a
    folder for it (`--state`)."""
    return await call.bridge.queue()


@operation(
    "queue.add",
    "POST",
    "/queue",
    Role.OPERATOR,
    errors=("queue.full", "queue.unwritable", *_CARD),
)
async def add(call: Call, body: QueueFile) -> QueuedPrint:
    """Adds a file of the card at the end of the queue."""
    return await call.bridge.queue_print(confined(body.path))


@operation("queue.remove", "DELETE", "/queue/prints/{number}", Role.OPERATOR, errors=_NUMBER)
async def remove(call: Call, number: int) -> None:
    """Removes a print from the queue."""
    await call.bridge.unqueue_print(number)


@operation(
    "queue.move", "PUT", "/queue/prints/{number}/place/{place}", Role.OPERATOR, errors=_NUMBER
)
async def move(call: Call, number: int, place: int) -> None:
    """Moves a print to another position: 0 is the next print; a position beyond the end is the
    last."""
    await call.bridge.move_queued_print(number, place)


@operation("queue.mode", "PUT", "/queue/mode", Role.OPERATOR, errors=("queue.unwritable",))
async def mode(call: Call, body: QueueMode) -> None:
    """Sets whether the next print starts without confirmation, or waits for `queue.start` (the
    default)."""
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
    """Starts the next print, and removes it from the queue."""
    if not body.bed_clear:
        raise CommandError.of("queue.bed")
    await call.bridge.start_queued_print()
