"""The last lines of all consoles, in both directions, for the report of a halt."""

from __future__ import annotations

import logging
import re
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from passo.gcode.line_protocol import decoded

_log = logging.getLogger(__name__)

KEPT = 200  # lines of each direction
_LONGEST = 300  # maximum characters of a kept line
# Commands of other firmwares with a password or network credentials.
_SECRET = re.compile(
    r"(\s*(?:[Nn]\s*\d+\s*)?[Mm]\s*0*(?:551|58[6-9])(?:\.\d+)?)(?!\d).*", re.DOTALL
)


class ConsoleLine(NamedTuple):
    """A line and its host time in seconds. Consoles are numbered from 1; `console` 0 means all of
    them. `sender` is the sender of a received line, if it is known."""

    host_s: float
    console: int
    received: bool
    text: str
    sender: str = ""


class ConsoleLines:
    """The lines of one printer's consoles. At level DEBUG, each line is logged."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        """`now_s` returns host time in seconds."""
        self._now_s = now_s
        self._received: deque[ConsoleLine] = deque(maxlen=KEPT)
        self._sent: deque[ConsoleLine] = deque(maxlen=KEPT)
        self._consoles = 0
        # called with lines without secrets
        self.listeners: list[Callable[[ConsoleLine], None]] = []

    def join(self) -> int:
        """The number for a new console."""
        self._consoles += 1
        return self._consoles

    def received(self, console: int, text: str, sender: str = "") -> None:
        """Records a line that a host has sent; bytes beyond ASCII are escaped as in
        `gcode.line_protocol.Line`."""
        self._add(self._received, ConsoleLine(self._now_s(), console, True, text, sender))
        if _log.isEnabledFor(logging.DEBUG):
            _log.debug("> %s", without_secrets(decoded(text)), extra={"console": console})

    def sent(self, console: int, text: str) -> None:
        """Records a line that was sent to a console, or to all consoles (0)."""
        if text == "wait" or text.startswith("echo:busy: "):
            return  # keep-alive lines are not recorded
        self._add(self._sent, ConsoleLine(self._now_s(), console, False, text))
        if _log.isEnabledFor(logging.DEBUG):
            _log.debug("< %s", text, extra={"console": console})

    def _add(self, lines: deque[ConsoleLine], line: ConsoleLine) -> None:
        line = line._replace(text=line.text[:_LONGEST])
        lines.append(line)
        if self.listeners:
            shown = _shown(line)
            for listener in list(self.listeners):
                listener(shown)

    def last(self) -> list[ConsoleLine]:
        """The last lines in the order of their times, without secrets."""
        lines = sorted([*self._received, *self._sent], key=lambda line: line.host_s)
        return [_shown(line) for line in lines]


def _shown(line: ConsoleLine) -> ConsoleLine:
    return line._replace(text=without_secrets(decoded(line.text)))


def without_secrets(text: str) -> str:
    """The line, without its parameters if the command may contain a password."""
    return _SECRET.sub(r"\1 (not shown)", text)
