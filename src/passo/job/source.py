"""Reading a G-code file, and saying in sentences what is wrong with it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from stat import S_ISREG
from typing import BinaryIO

from passo.errors import InputError
from passo.gcode.dialect import row_of

CHUNK = 1 << 16
_MOST_OF_LINE = 4096  # bytes; none that is a command is longer
_COMMAND = re.compile(
    rb"^[ \t/]*(?:N\s*\d+[ \t]*)?(?:([A-Z])[ \t]*([-+]?\.?\d[.\d]*)|([A-Z_][A-Z0-9_]+))",
    re.IGNORECASE | re.MULTILINE,
)
_MOVE = re.compile(rb"[ \t]*(?:N\s*\d+[ \t]*)?G[ \t]*0*[0-3](?![.\d])", re.IGNORECASE)


def open_source(path: str | os.PathLike[str]) -> BinaryIO:
    """The file, open for reading. Raises InputError if it cannot be read or holds nothing."""
    if not os.fspath(path):
        raise _unreadable("''", "the name is empty")
    try:
        about = Path(path).stat()
        if S_ISREG(about.st_mode) and about.st_size == 0:  # pipes have no size
            raise InputError.of("input.empty", str(path))
        return Path(path).open("rb")
    except OSError as error:
        raise _unreadable(path, error.strerror or str(error)) from None


def chunks(source: BinaryIO, path: str) -> Iterator[bytes]:
    """The file in pieces. Raises InputError when reading fails."""
    while True:
        try:
            data = source.read(CHUNK)
        except OSError as error:
            raise _unreadable(path, error.strerror or str(error)) from None
        if not data:
            return
        yield data


class Text:
    """The pieces of a program, and what they tell as a text: `offset` bytes were read, `known`
    whether a command of the dialect was among them, `cut` whether all ended within a move's line.
    """

    def __init__(self, pieces: Iterable[bytes]) -> None:
        self._pieces = iter(pieces)
        self._line = b""  # so far
        self.offset = 0
        self.known = self.cut = False

    def __iter__(self) -> Iterator[bytes]:
        for piece in self._pieces:
            self.offset += len(piece)
            # A file for a printer has one in its first piece: no more is looked through.
            self.known = self.known or _holds_command(self._line + piece)
            head, newline, rest = piece.rpartition(b"\n")
            self._line = (rest if newline else self._line + head + rest)[:_MOST_OF_LINE]
            yield piece
        self.cut = _MOVE.match(self._line) is not None


def _holds_command(text: bytes) -> bool:
    for match in _COMMAND.finditer(text):
        letter, number, name = match.groups(b"")
        if name or letter.upper() in b"GM":
            code = name or letter + (number.partition(b".")[0].lstrip(b"0") or b"0")
            if row_of(code.decode().upper()) is not None:
                return True
        elif letter.upper() in b"TFXYZEABCUVWS":  # a tool, or words of the move before
            return True
    return False


def _unreadable(path: str | os.PathLike[str], reason: str) -> InputError:
    return InputError.of("input.unreadable", str(path), value=reason)
