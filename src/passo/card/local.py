"""Files of this computer that can be printed like files of a card; a `file:` URI names them."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from urllib.parse import unquote, urlsplit

from passo.card.api import Reader
from passo.errors import InputError

_SCHEME = "file:"
_FLAGS = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC


def local_uri(path: str | os.PathLike[str]) -> str:
    """The absolute `file:` URI of a file."""
    return Path(path).resolve().as_uri()


def is_local(path: str) -> bool:
    """Whether a path is such a URI, and not a path on a card."""
    return path.startswith(_SCHEME)


def local_name(uri: str) -> str:
    """The file's name without its directories."""
    return _path(uri).name


def open_local(uri: str) -> Reader:
    """The file, open for reading. Raises InputError, also for an empty file, a directory or a pipe.
    A failed read raises InputError too."""
    path = _path(uri)
    try:
        file = os.open(path, _FLAGS)
    except OSError as error:
        raise _unreadable(path, error) from None
    about = os.fstat(file)
    if not stat.S_ISREG(about.st_mode):
        os.close(file)
        raise InputError.of("input.unreadable", str(path), value="it is not a file")
    if about.st_size == 0:
        os.close(file)
        raise InputError.of("input.empty", str(path))

    def fetch(offset: int, into: memoryview) -> None:
        done = 0
        try:
            while done < len(into):
                data = os.pread(file, len(into) - done, offset + done)
                if not data:
                    raise OSError(0, "the file has become shorter")
                into[done : done + len(data)] = data
                done += len(data)
        except OSError as error:
            raise _unreadable(path, error) from None

    return Reader(about.st_size, fetch, lambda: os.close(file))


def _unreadable(path: Path, error: OSError) -> InputError:
    return InputError.of("input.unreadable", str(path), value=error.strerror or str(error))


def _path(uri: str) -> Path:
    return Path(unquote(urlsplit(uri).path, errors="surrogateescape"))
