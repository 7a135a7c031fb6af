"""Repeats the emergency stop after a halt until all boards confirm it, including those that were
unreachable."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from passo.board.ports import LinkLostError
from passo.errors import MachineError
from passo.motion.motion_queue import either

if TYPE_CHECKING:
    from passo.board.connection import Connection
    from passo.motion.rig import Rig
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_AGAIN_S = 0.5  # between two attempts; a board answers the first before the second is sent


async def stop_boards(rig: Rig, state: State, given_up: asyncio.Event) -> None:
    """Sends every board the command to shut down until all have confirmed it, or `given_up` is set.
    Reopens the port of a silent board repeatedly."""
    left = [c for c in rig.connection.connections if not c.link.shut_down]
    warned = False
    while left and not given_up.is_set():
        for connection in left:
            with suppress(LinkLostError):
                if connection.lost:
                    await connection.open_again()
                connection.order_stop()
        await either(given_up, _AGAIN_S)
        rig.queue.live_on(_AGAIN_S)
        left = [c for c in left if not c.has_shut_down()]
        # Boards without `survive` switch all outputs off within three seconds.
        warm = [c for c in left if c.heaters] if rig.connection.survives else []
        if warm and not warned:
            warned = True
            danger = MachineError.of("machine.unstopped", value=_names(rig, warm))
            state.tell(f"Error:{danger}")
            _log.error("%s", danger, extra=danger.problems[0].log_fields)
    if warned and not left:
        confirmed = "Emergency stop confirmed by all boards; heaters are off"
        state.announce(_log, logging.INFO, confirmed)


def _names(rig: Rig, boards: Sequence[Connection]) -> str:
    """`the board`; among several `the main board and board tool`."""
    if len(rig.connection.connections) == 1:
        return "the board"
    return " and ".join(f"board {c.name}" if c.name else "the main board" for c in boards)
