"""Files that appear completely or not at all."""

from __future__ import annotations

import errno
import fcntl
import json
import os
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

MAX_JSON_BYTES = 8 << 20


@contextmanager
def replaced(path: Path) -> Generator[Path, None, None]:
    """Yields a temporary file next to `path` to write to. At the end of the block it replaces
    `path` and survives a power cut; after an error it is removed. If `path` is a link, its target
    is replaced; a folder or a device is refused. Raises OSError."""
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is no regular file", str(path))
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        with temporary.open("rb") as written:
            os.fsync(written.fileno())
        temporary.replace(path)
        fsync_directory(path.parent)
    finally:
        temporary.unlink(missing_ok=True)


def store_json(path: Path, content: Mapping[str, Any]) -> None:
    """Writes an object completely and durably; makes the directory if necessary. Raises OSError,
    also for an object that is too large for `load_json`; then the file is unchanged."""
    text = json.dumps(content, indent=1).encode()
    if len(text) > MAX_JSON_BYTES:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary:
        temporary.write_bytes(text)


def load_json(path: Path) -> dict[str, Any] | None:
    """The object that `store_json` has written; None if there is no file. Raises OSError, and
    ValueError for any other content."""
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_JSON_BYTES + 1)
    except FileNotFoundError:
        return None
    if len(raw) > MAX_JSON_BYTES:
        raise ValueError(f"it has more than {MAX_JSON_BYTES} bytes")
    try:
        content: object = json.loads(raw)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if not isinstance(content, dict):
        raise ValueError("it is not a JSON object")
    return cast("dict[str, Any]", content)


def directory_held(path: Path) -> int | None:
    """Locks a directory, which is made if necessary, and returns a descriptor whose closing
    releases the lock. None if the directory cannot be opened or locked. Raises BlockingIOError if
    another process has the lock."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        directory = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    except OSError:
        return None
    try:
        fcntl.flock(directory, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(directory)
        if isinstance(error, BlockingIOError):
            raise
        return None
    return directory


def fsync_directory(path: Path) -> None:
    """Makes new, changed and deleted names in a directory durable. Raises OSError."""
    directory = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(directory)
    finally:
        os.close(directory)
