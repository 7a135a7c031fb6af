"""Converts line numbers of a file, as counted by the interpreter, to byte offsets and back."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.job.live.reader import Reader

_CHUNK = 1 << 16
_END = re.compile(rb"\r\n?|\n")  # of a line


def offset_of_line(reader: Reader, line: int) -> int:
    """The number of bytes before a line, counted from 1. Raises PassoError if the card fails."""
    reader.seek(0)
    at, left, cut = 0, line - 1, False
    while left > 0:
        data = reader.read(_CHUNK)
        if not data:
            return at
        if cut and data.startswith(b"\n"):  # the second half of a CR LF
            at, data = at + 1, data[1:]
        cut = data.endswith(b"\r")
        ends = _ends(data)
        if ends >= left:
            at += next(islice(_END.finditer(data), left - 1, None)).end()
            return at + (cut and ends == left and reader.read(1) == b"\n")
        left -= ends
        at += len(data)
    return at


def line_of_offset(reader: Reader, offset: int) -> int:
    """The line, counted from 1, of the byte at `offset`. Raises PassoError if the card fails."""
    reader.seek(0)
    line, left, cut = 1, offset, False
    while left > 0 and (data := reader.read(min(_CHUNK, left))):
        line += _ends(data) - (cut and data.startswith(b"\n"))
        cut, left = data.endswith(b"\r"), left - len(data)
    return line


def _ends(data: bytes) -> int:
    return data.count(b"\n") + data.count(b"\r") - data.count(b"\r\n")
