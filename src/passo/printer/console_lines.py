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
_LONGEST = 300  # characters that are kept of a line
# Commands of other firmwares with a password or network credentials.
_SECRET = re.compile(
    r"(\s*(?:[Nn]\s*\d+\s*)?[Mm]\s*0*(?:551|58[6-9])(?:\.\d+)?)(?!\d).*", re.DOTALL
)


class ConsoleLine(NamedTuple):
    """A line at a host time in seconds; `console` counts from 1, and 0 stands for all. `sender` is
    the sender of a received line, if the console knows it."""

    host_s: float
    console: int
    received: bool
    text: str
    sender: str = ""


class ConsoleLines:
    """Lines of one printer's consoles. At level DEBUG each is a record of the log."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        """`now_s` is host time."""
        self._now_s = now_s
        self._received: deque[ConsoleLine] = deque(maxlen=KEPT)
        self._sent: deque[ConsoleLine] = deque(maxlen=KEPT)
        self._consoles = 0
        self.listeners: list[Callable[[ConsoleLine], None]] = []  # to lines without secrets

    def join(self) -> int:
        """The number of another console."""
        self._consoles += 1
        return self._consoles

    def received(self, console: int, text: str, sender: str = "") -> None:
        """A line that a host has sent, its bytes beyond ASCII as in `gcode.line_protocol.Line`."""
        self._add(self._received, ConsoleLine(self._now_s(), console, True, text, sender))
        if _log.isEnabledFor(logging.DEBUG):
            _log.debug("> %s", without_secrets(decoded(text)), extra={"console": console})

    def sent(self, console: int, text: str) -> None:
        """A line that a console, or 0 for all of them, has received as an answer."""
        if text == "wait" or text.startswith("echo:busy: "):
            return  # they only keep a host from a timeout
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
    """A line without the words of a command that may contain a password."""
    return _SECRET.sub(r"\1 (not shown)", text)
