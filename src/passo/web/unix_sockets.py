"""Unix sockets that a printer listens on."""

from __future__ import annotations

import socket
import stat
from contextlib import suppress
from pathlib import Path

from passo.errors import InputError

_BACKLOG = 128
_ANSWER_S = 1.0  # a program that serves accepts within this time


class UnixSocket:
    """A listening Unix socket at a path, in place of one that no program serves any more. `mode`
    are its permissions; it never has others. Raises InputError if the path belongs to a file or to
    a socket that a program serves, or if the socket cannot be made."""

    def __init__(self, path: Path, mode: int) -> None:
        self.path = path
        try:
            _require_free(path)
            self.socket = _listening(path, mode)
            self._inode = path.lstat().st_ino
        except OSError as error:
            raise InputError.of(
                "console.unopened", axis=f"socket {path}", value=error.strerror or str(error)
            ) from None

    def remove(self) -> None:
        """Removes the path, unless another program has replaced it."""
        with suppress(OSError):
            if self.path.lstat().st_ino == self._inode:
                self.path.unlink()


def _require_free(path: Path) -> None:
    """Raises OSError unless there is nothing at the path, or a socket that no program serves."""
    try:
        found = path.lstat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISSOCK(found):
        raise FileExistsError(0, "the path is that of a file")
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as caller:
        caller.settimeout(_ANSWER_S)
        try:
            caller.connect(str(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return
        except OSError:
            pass  # it is busy, or it may not be opened
    raise FileExistsError(0, "another program serves this socket")


def _listening(path: Path, mode: int) -> socket.socket:
    made = path.with_name(f"{path.name}~")  # the socket gets its name only after its permissions
    listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        made.unlink(missing_ok=True)
        listening.bind(str(made))
        made.chmod(mode)
        listening.listen(_BACKLOG)
        listening.setblocking(False)
        made.rename(path)
    except OSError:
        listening.close()
        with suppress(OSError):
            made.unlink(missing_ok=True)
        raise
    return listening
