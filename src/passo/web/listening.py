"""The socket on which a web interface listens: TCP, or a Unix socket."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path

from passo.web.access import Binding
from passo.web.server import listening
from passo.web.unix_sockets import UnixSocket

_SHARED = 0o660  # permissions of a Unix socket for a user and a group


@dataclass(frozen=True, slots=True)
class Listening:
    """An open socket. `place` is its address for clients: `http://HOST:PORT` or `unix:PATH`; a Unix
    socket has neither host nor port. `remove`, if there is one, removes its path."""

    socket: socket.socket
    place: str
    host: str = ""
    port: int = 0
    remove: Callable[[], object] | None = None

    def close(self) -> None:
        """Closes a socket that nothing has served."""
        self.socket.close()
        if self.remove is not None:
            self.remove()

    def binding(self, names: frozenset[str]) -> Binding:
        """The address of the web interface, which has these further host names."""
        unix = not self.host
        local = unix or ip_address(self.host.partition("%")[0]).is_loopback
        return Binding(local, names, unix)


def tcp(host: str, port: int) -> Listening:
    """Listens at a host; port 0 is any free port. Raises InputError."""
    opened = listening(host, port)
    host, port = opened.getsockname()[:2]
    return Listening(opened, f"http://{f'[{host}]' if ':' in host else host}:{port}", host, port)


def unix(path: str | os.PathLike[str]) -> Listening:
    """Listens on a Unix socket, which its user and its group may open. Raises InputError."""
    opened = UnixSocket(Path(path), _SHARED)
    return Listening(opened.socket, f"unix:{opened.path.absolute()}", remove=opened.remove)
