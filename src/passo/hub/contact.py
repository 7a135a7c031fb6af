"""What the hub knows of a printer at this moment."""

from __future__ import annotations

from passo.hub.records import NEVER_PRINTED, PrinterRow
from passo.hub.views import Condition
from passo.web.summary import Summary

# Seconds after the loss of a connection until the printer counts as unreachable: a minute after
# its last word, as a link notices the loss at most 30 s after that.
LOST_S = 30.0


def last_number(seen: Summary) -> int:
    """The number of the last print of a printer."""
    return NEVER_PRINTED if seen.last_print is None else seen.last_print.number


def bed_is_clear(row: PrinterRow, seen: Summary) -> bool:
    """Whether the bed is empty: a user has cleared it, and nothing has been printed since, at the
    printer itself as little as by the hub."""
    prints = seen.job is not None or seen.state in ("printing", "paused")
    return row.bed_clear and not prints and last_number(seen) == row.cleared_number


class Contact:
    """The connection to one printer. `seen` is its last summary, also after the connection is
    lost; None before the first one."""

    def __init__(self) -> None:
        self.seen: Summary | None = None
        self.connected = False
        self.received = 0  # summaries
        self._lost_s: float | None = None
        self._lost_wall_s: float | None = None

    @property
    def now(self) -> Summary | None:
        """The summary, if it is certain to be of this moment."""
        return self.seen if self.connected else None

    def receive(self, seen: Summary) -> None:
        """The printer has sent its summary."""
        self.seen, self.connected, self._lost_s = seen, True, None
        self.received += 1

    def lose(self, now_s: float, wall_s: float) -> None:
        """The connection is lost, or could not be made."""
        self.connected = False
        if self._lost_s is None:
            self._lost_s = now_s
            self._lost_wall_s = wall_s if self.seen is not None else None

    def last_word_s(self, now_s: float) -> float | None:
        """When an unreachable printer was last connected, since 1970; None if it is reachable, or
        was not seen by this program."""
        return self._lost_wall_s if self.condition(now_s) == "unreachable" else None

    def condition(self, now_s: float) -> Condition:
        """What the farm shows. An unreachable printer is never idle."""
        if self._lost_s is not None and now_s - self._lost_s >= LOST_S:
            return "unreachable"
        return "connecting" if self.seen is None else self.seen.state
