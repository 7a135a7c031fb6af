"""Reading a G-code file, and saying in sentences what is wrong with it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from passo import _core
from passo.errors import InputError, Problem

CHUNK = 1 << 16


def open_source(path: str | os.PathLike[str]) -> BinaryIO:
    """The file, open for reading. Raises InputError if it cannot be read or holds nothing."""
    try:
        if Path(path).stat().st_size == 0:
            raise InputError([Problem("input.empty", str(path))])
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


def _unreadable(path: str | os.PathLike[str], reason: str) -> InputError:
    return InputError([Problem("input.unreadable", str(path), None, {"value": reason})])


def problem_of(job: _core.Job, path: str) -> Problem:
    """The error that `job.advance` stopped at, as a problem of the catalogue."""
    line, fault, word, value, limit, point = job.error
    faults = _core.Fault
    if fault == faults.OUT_OF_RANGE:
        values = {"axis": word.upper(), "value": value, "limit": limit}
        return Problem("input.out-of-range", path, line, values)
    if fault == faults.ACTUATOR:
        return Problem("input.actuator", path, line, {"axis": word, "value": value, "limit": limit})
    if fault == faults.UNREACHABLE:
        where = ", ".join(f"{letter} {x:.3f}" for letter, x in zip("XYZ", point, strict=True))
        return Problem("input.unreachable", path, line, {"value": where})
    if fault == faults.MISSING_TOOL:
        return Problem("input.missing-tool", path, line, {"value": int(value), "limit": int(limit)})
    if fault == faults.NUMBER:
        return Problem(
            "input.number", path, line, {"value": word + (f"{value:g}" if value else "")}
        )
    if fault == faults.FEEDRATE:
        return Problem("input.feedrate", path, line, {"value": value})
    if fault == faults.ARC:
        return Problem("input.arc", path, line, {"value": word})
    if fault == faults.CHECKSUM:
        return Problem("input.checksum", path, line, {"value": word, "limit": int(value)})
    if fault == faults.LINE_TOO_LONG:
        return Problem("input.garbage", path, line, {"value": "a line is longer than 64 KiB"})
    if fault == faults.WORD:
        return Problem("input.garbage", path, line, {"value": f"{word!r} is no command"})
    return Problem("input.garbage", path, line, {"value": "it holds bytes that are no text"})
