"""Reads a G-code file, and reports errors in it as sentences."""

from __future__ import annotations

import os
from collections.abc import Iterator
from io import TextIOWrapper
from pathlib import Path
from stat import S_ISREG
from typing import BinaryIO

from passo.errors import InputError

CHUNK = 1 << 16


def open_source(path: str | os.PathLike[str]) -> BinaryIO:
    """Opens a file for reading. Raises InputError if it cannot be read or is empty."""
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


def lines(source: BinaryIO) -> Iterator[bytes]:
    """Yields the lines of the file, which end with LF, CR LF or CR as in the core; then closes the
    file."""
    with TextIOWrapper(source, "latin-1", newline="") as text:
        for line in text:
            yield line.encode("latin-1")


def _unreadable(path: str | os.PathLike[str], reason: str) -> InputError:
    return InputError.of("input.unreadable", str(path), value=reason)
