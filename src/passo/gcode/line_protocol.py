"""The line protocol of hosts: line numbers, checksums, resends. Sans-IO: bytes in, lines out.

A numbered line is `N<number> <command>*<checksum>`, the checksum being the exclusive or of all
bytes before `*`, in decimal. Its number must be one more than the last one's; M110 sets what the
last one was. Lines without a number are taken as they come and change no count.

Hosts read what follows `Error:`. The reasons here hold the words by which they know a fault of the
link, which a resend mends; any other text after `Error:` makes them disconnect.
"""

from __future__ import annotations

import re
from collections import deque
from typing import NamedTuple

LONGEST = 4096  # bytes of a line; a longer one is refused
_REMEMBERED = 64  # lines: one that comes once more, as after two requests for it, is known by them

_NUMBERED = re.compile(r"\s*[Nn]\s*(-?\d{1,18})(?!\d)\s*(.*)\Z", re.DOTALL)
_CHECKSUM = re.compile(r"\*\s*(\d{1,3})\s*\Z")
_FRAGMENT = re.compile(r"\s*([Nn]\s*-?|\d+)\s*\Z")  # of a numbered line that was torn apart
_SET_NUMBER = re.compile(r"[Mm]110(?!\d)\s*(?:[NnLl]\s*(-?\d{1,18})(?!\d))?")
_TEXT = re.compile(r"\s*[Mm]11[78](?!\d)")


class Line(NamedTuple):
    """A line to carry out; `number` if it had one. `text` is free of number, checksum, comment; its
    bytes beyond ASCII are escaped as surrogates, which no pattern takes for digits or blanks."""

    text: str
    number: int | None = None


class Refusal(NamedTuple):
    """A line that is not carried out. The host is told `reason`; with `resend` it is asked for that
    line, and must send `ok`. `text` is what a sound line says that came out of its order. `lost`
    if nobody will send it again."""

    reason: str
    resend: int | None
    text: str = ""
    lost: bool = False


class LineProtocol:
    """One console's incoming bytes. Keeps at most one unfinished line of LONGEST bytes."""

    def __init__(self) -> None:
        self.last = 0  # number of the last line taken
        self._rest = b""
        self._numbering = False  # lines with numbers have come
        self._taken: deque[str] = deque(maxlen=_REMEMBERED)  # the last of them

    @property
    def unfinished(self) -> bool:
        """The beginning of a line has come, and not its end."""
        return bool(self._rest)

    def feed(self, data: bytes) -> list[Line | Refusal]:
        """What the bytes complete, in order. Blank lines and comments are not lines."""
        # A zero byte is noise that the exclusive or does not see.
        data = data.replace(b"\0", b"").replace(b"\r", b"\n")
        *lines, rest = (self._rest + data).split(b"\n")
        self._rest = rest[: LONGEST + 1]
        found: list[Line | Refusal] = []
        for raw in lines:
            if raw:
                line = self._line(raw)
                if line is not None:
                    found.append(line)
        return found

    def _line(self, raw: bytes) -> Line | Refusal | None:
        text = raw[: LONGEST + 1].decode("ascii", "surrogateescape")
        numbered = _NUMBERED.match(text)
        if len(raw) > LONGEST:
            reason = f"format error: line longer than {LONGEST} characters"
            return self._asked_again(reason) if numbered else Refusal(reason, None, lost=True)
        if numbered is None:
            return self._bare(text, raw)
        self._numbering = True
        checked = _CHECKSUM.search(text) if "*" in text else None
        if checked is None:
            return self._asked_again("No Checksum with line number")
        if not _right(raw, checked):
            return self._asked_again("checksum mismatch")
        number = int(numbered[1])
        text = uncommented(text[numbered.start(2) : checked.start()])
        set_number = _SET_NUMBER.match(text)
        if set_number:
            self._count_from(int(set_number[1]) if set_number[1] else number)
        elif number == self.last + 1:
            self.last = number
            self._taken.append(text)
        elif 0 <= self.last - number < len(self._taken) and (
            self._taken[number - self.last - 1] == text
        ):
            return Refusal(f"line {number} has come already", None)
        else:
            return self._asked_again("Line Number is not Last Line Number+1", text)
        return Line(text, number)

    def _bare(self, text: str, raw: bytes) -> Line | Refusal | None:
        if _TEXT.match(text):
            return Line(text.strip())
        checked = _CHECKSUM.search(text)
        sound = checked is not None and (";" in text or _right(raw, checked))
        if (checked and not sound) or (self._numbering and (checked or _FRAGMENT.match(text))):
            # Its number is damaged, for nobody checks lines without one; or a host has hung up in
            # the midst of it, and this is the next one's first line behind that.
            return self._asked_again("checksum mismatch")
        if checked:
            text = text[: checked.start()]
        text = uncommented(text)
        set_number = _SET_NUMBER.match(text)
        if set_number and set_number[1]:
            self._count_from(int(set_number[1]))
        return Line(text) if text else None

    def _count_from(self, number: int) -> None:
        self.last = number
        self._taken.clear()

    def _asked_again(self, reason: str, text: str = "") -> Refusal:
        return Refusal(f"{reason}, Last Line: {self.last}", self.last + 1, text)


def uncommented(text: str) -> str:
    """The line without what stands behind `;`, except in the text of M117 and M118."""
    if ";" not in text or _TEXT.match(text):
        return text.strip()
    return text.partition(";")[0].strip()


def _right(raw: bytes, checked: re.Match[str]) -> bool:
    total = 0
    for byte in raw[: checked.start()]:
        total ^= byte
    return total == int(checked[1])
