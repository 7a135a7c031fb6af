"""The line protocol of hosts: line numbers, checksums, resends. Sans-IO: bytes in, lines out.

A numbered line is `N<number> <command>*<checksum>`, the checksum being the exclusive or of all
bytes before `*`, in decimal. Its number must be one more than the last one's; M110 sets what the
last one was. Lines without a number are taken as they come and change no count.
"""

from __future__ import annotations

import re
from typing import NamedTuple

LONGEST = 4096  # bytes of a line; the rest is dropped and the line refused

_NUMBERED = re.compile(r"\s*[Nn]\s*(-?\d+)\s*(.*)\Z", re.DOTALL)
_CHECKSUM = re.compile(r"\*\s*(\d{1,3})\s*\Z")
_MESSAGE = re.compile(r"\s*[Mm]11[78](?!\d)")
_SET_NUMBER = re.compile(r"[Mm]110(?!\d)\s*(?:[NnLl]\s*(-?\d+))?")


class Line(NamedTuple):
    """A line to carry out; `number` if it had one. `text` is free of number, checksum, comment."""

    text: str
    number: int | None = None


class Refusal(NamedTuple):
    """A line that came in damaged. The host is told `reason`; with `resend` it is asked for that
    line, and must send `ok`."""

    reason: str
    resend: int | None


class LineProtocol:
    """One console's incoming bytes. Keeps at most one unfinished line of LONGEST bytes."""

    def __init__(self) -> None:
        self.last = 0  # number of the last line taken
        self._rest = b""
        self._too_long = False

    def feed(self, data: bytes) -> list[Line | Refusal]:
        """What the bytes complete, in order. Blank lines and comments are not lines."""
        *lines, self._rest = (self._rest + data.replace(b"\r", b"\n")).split(b"\n")
        found: list[Line | Refusal] = []
        for raw in lines:
            too_long, self._too_long = self._too_long or len(raw) > LONGEST, False
            if too_long:
                found.append(self._refuse(f"line longer than {LONGEST} characters"))
                continue
            if raw:
                self._take(raw.decode("ascii", "replace"), raw, found)
        if len(self._rest) > LONGEST:
            self._rest, self._too_long = b"", True
        return found

    def reset(self) -> None:
        """The host has gone: the next one begins anew."""
        self.__init__()

    def _take(self, text: str, raw: bytes, found: list[Line | Refusal]) -> None:
        checked = _CHECKSUM.search(text) if "*" in text else None
        if checked and _sum(raw[: raw.rindex(b"*")]) != int(checked[1]):
            found.append(self._refuse("checksum mismatch"))
            return
        if checked:
            text = text[: checked.start()]
        numbered = _NUMBERED.match(text)
        if not numbered:
            text = uncommented(text)
            if checked and text:  # its number is damaged, or has never been there
                found.append(Line(text))
            elif text:
                found.append(self._bare(text))
            return
        number, text = int(numbered[1]), uncommented(numbered[2])
        if not checked:
            found.append(self._refuse("No Checksum with line number"))
            return
        set_number = _SET_NUMBER.match(text)
        if set_number:
            self.last = int(set_number[1]) if set_number[1] else number
        elif number != self.last + 1:
            found.append(self._refuse("Line Number is not Last Line Number+1"))
            return
        else:
            self.last = number
        found.append(Line(text, number))

    def _bare(self, text: str) -> Line:
        set_number = _SET_NUMBER.match(text)
        if set_number and set_number[1]:
            self.last = int(set_number[1])
        return Line(text)

    def _refuse(self, reason: str) -> Refusal:
        return Refusal(f"{reason}, Last Line: {self.last}", self.last + 1)


def uncommented(text: str) -> str:
    """The line without what stands behind `;`, except in the text of M117 and M118."""
    if ";" not in text or _MESSAGE.match(text):
        return text.strip()
    return text.partition(";")[0].strip()


def _sum(data: bytes) -> int:
    total = 0
    for byte in data:
        total ^= byte
    return total
