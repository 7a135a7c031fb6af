"""Reads files that a machine file names: data dictionaries, tables of sensors."""

from __future__ import annotations

import errno
import os
from pathlib import Path

MAX_BYTES = 4 << 20  # maximum size of a file; a data dictionary of Klipper has about 100 kB


def read_companion(folder: Path, name: str) -> bytes:
    """The content of a file; a relative path is relative to `folder`. A device or a pipe, which has
    no end, and a file of more than 4 MiB are refused. Raises OSError, and ValueError for a name
    that no file can have."""
    path = folder / name
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
    return content
