"""Lines that a console has sent and that are not executed yet.

The queue is long, since an emergency stop is seen only in a line that was read; but it is bounded.
"""

from __future__ import annotations

from collections import deque

from passo.gcode.command import Command
from passo.gcode.line_protocol import Line, Refusal

BACKLOG = 256  # lines that a host may send ahead (`ok N P B`)
MAX_LINES = 1 << 15  # lines in the queue before the sender is held up
MAX_BYTES = 1 << 20  # of text, likewise

Heard = tuple[Line, Command, bool] | Refusal
"""A line, its command, and whether `EmergencyParser.see` took it for one; or why it is refused."""


class ReceiveQueue:
    """A queue of lines with a limit, at which the sender is held up."""

    def __init__(self) -> None:
        self._lines: deque[Heard] = deque()
        self._bytes = 0

    def __len__(self) -> int:
        """Lines that wait."""
        return len(self._lines)

    @property
    def room(self) -> int:
        """The number of lines that a host may send before it waits for an `ok`."""
        return max(0, BACKLOG - len(self._lines))

    @property
    def full(self) -> bool:
        """Whether no more should be read."""
        return len(self._lines) >= MAX_LINES or self._bytes >= MAX_BYTES

    @property
    def half_empty(self) -> bool:
        """Whether more may be read again."""
        return len(self._lines) <= MAX_LINES // 2 and self._bytes <= MAX_BYTES // 2

    def append(self, heard: Heard) -> None:
        """Adds a line at the end."""
        self._lines.append(heard)
        self._bytes += _size(heard)

    def popleft(self) -> Heard:
        """Removes and returns the first line."""
        heard = self._lines.popleft()
        self._bytes -= _size(heard)
        return heard

    def clear(self) -> None:
        """Discards all lines."""
        self._lines.clear()
        self._bytes = 0


def _size(heard: Heard) -> int:
    return 0 if isinstance(heard, Refusal) else len(heard[0].text)
