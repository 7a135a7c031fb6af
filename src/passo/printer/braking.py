"""Notices a board that has stopped by itself although the link works: a commit came too late."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.board.ports import LinkLostError

if TYPE_CHECKING:
    from passo import _core
    from passo.printer.printer import Printer

# With less than this left a commit may have come too late: the board decides 5 ms before it would
# brake, and it is not known to the millisecond when a frame arrives.
_DOUBT_S = 0.02


class BrakedError(LinkLostError):
    """The board has braked and drops all commands, but can be spoken to."""


class BrakeWatch:
    """Asks the board of one printer whether it still goes on, whenever that is in doubt."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._asked = False

    def look_at(self, slack: _core.Slack) -> None:
        """Asks, if a frame came so late."""
        connection = self._printer.connection
        late = slack.known and slack.slack < _DOUBT_S * connection.board.clock_hz
        if late and connection.survives:
            self._asked = True
            connection.command("survive_query")

    def time_passed(self) -> None:
        """Raises BrakedError if the board has stopped."""
        if not self._asked:
            return
        connection = self._printer.connection
        for _, state in connection.take_responses("survive_state"):
            self._asked = False
            states = connection.dictionary.enumerations["survive"]
            if state["state"] in (states["braking"], states["held"]):
                raise BrakedError.of("machine.braked")
