"""The states of the links to a printer's boards, and their transitions."""

from __future__ import annotations

from enum import Enum


class LinkState(Enum):
    """The state of the links, from the host's point of view."""

    CONNECTED = "the boards answer"
    RECONNECTING = "a link is lost; the boards brake by themselves and keep warm"
    PLACE_LOST = "the position is lost; heaters keep their targets"
    HALTED = "everything is off until M999"
    RESTARTING = "the boards start again"


_S = LinkState
TRANSITIONS: dict[LinkState, frozenset[LinkState]] = {
    # A link is lost and the boards survive it; a board was reset; M112 or another halt.
    _S.CONNECTED: frozenset({_S.RECONNECTING, _S.PLACE_LOST, _S.HALTED}),
    # All boards are back; a motor is not at its stop position; M112 or the shutdown of a board.
    _S.RECONNECTING: frozenset({_S.CONNECTED, _S.PLACE_LOST, _S.HALTED}),
    # Automatically, as soon as no command waits any more; M112 in the meantime.
    _S.PLACE_LOST: frozenset({_S.RESTARTING, _S.HALTED}),
    # M999.
    _S.HALTED: frozenset({_S.RESTARTING}),
    # Each board is configured; one cannot be reached.
    _S.RESTARTING: frozenset({_S.CONNECTED, _S.HALTED}),
}
