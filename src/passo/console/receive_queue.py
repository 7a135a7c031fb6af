"""The queue of received lines that are not executed yet. It is long, because an emergency stop is
detected only in a line that was read, but it is bounded.
"""

from __future__ import annotations

from collections import deque

from passo.gcode.command import Command
from passo.gcode.line_protocol import Line, Refusal

BACKLOG = 256  # lines that a host may send ahead (`ok N P B`)
MAX_LINES = 1 << 15  # lines in the queue, after which reading stops
MAX_BYTES = 1 << 20  # text in the queue, after which reading stops

Received = tuple[Line, Command, bool] | Refusal
"""A line, its command, and whether `EmergencyParser.see` accepted it as a command; or a refusal."""


class ReceiveQueue:
    """A queue of lines with a limit, at which reading stops."""

    def __init__(self) -> None:
        self._lines: deque[Received] = deque()
        self._bytes = 0

    def __len__(self) -> int:
        """The number of waiting lines."""
        return len(self._lines)

    @property
    def room(self) -> int:
        """The number of lines that a host may send before it waits for an `ok`."""
        return max(0, BACKLOG - len(self._lines))

    @property
    def full(self) -> bool:
        """Whether reading must stop."""
        return len(self._lines) >= MAX_LINES or self._bytes >= MAX_BYTES

    @property
    def half_empty(self) -> bool:
        """Whether reading may continue."""
        return len(self._lines) <= MAX_LINES // 2 and self._bytes <= MAX_BYTES // 2

    def append(self, received: Received) -> None:
        """Adds a line at the end."""
        self._lines.append(received)
        self._bytes += _size(received)

    def popleft(self) -> Received:
        """Removes and returns the first line."""
        received = self._lines.popleft()
        self._bytes -= _size(received)
        return received

    def clear(self) -> None:
        """Discards all lines."""
        self._lines.clear()
        self._bytes = 0


def _size(received: Received) -> int:
    return 0 if isinstance(received, Refusal) else len(received[0].text)
