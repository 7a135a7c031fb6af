"""A bad cable between a host and the printer."""

from __future__ import annotations

import os
import random
import select
import socket
import threading
import tty
from pathlib import Path


class Noise:
    """Passes bytes both ways and damages one in a hundred of the numbered lines to the printer: a
    byte of it is changed, lost or doubled. The same lines for the same seed."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._stop = threading.Event()
        self._rest = b""
        self._fds: list[int] = []
        self._thread: threading.Thread | None = None
        self.damaged = 0

    def on_pty(self, printer: str, link: Path) -> Noise:
        """Between the printer's pty and a new one, linked at `link`."""
        host, slave = os.openpty()
        tty.setraw(slave)
        link.symlink_to(os.ttyname(slave))
        port = os.open(printer, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(port)
        self._fds = [host, port, slave]
        return self._start(lambda: (host, port))

    def on_tcp(self, printer: str) -> tuple[Noise, str]:
        """Between the printer's TCP port and a new one, whose address it returns; one client."""
        server = socket.create_server(("127.0.0.1", 0))
        host, _, port = printer.rpartition(":")

        def joined() -> tuple[int, int]:
            with server:
                client, _ = server.accept()
            self._fds = [client.detach(), socket.create_connection((host, int(port))).detach()]
            return self._fds[0], self._fds[1]

        return self._start(joined), f"127.0.0.1:{server.getsockname()[1]}"

    def _start(self, joined) -> Noise:
        self._thread = threading.Thread(target=lambda: self._carry(*joined()))
        self._thread.start()
        return self

    def close(self) -> None:
        """Cuts the cable."""
        self._stop.set()
        assert self._thread is not None
        self._thread.join(timeout=10)
        for fd in self._fds:
            os.close(fd)

    def _carry(self, host: int, printer: int) -> None:
        while not self._stop.is_set():
            ready, _, _ = select.select([host, printer], [], [], 0.1)
            for fd in ready:
                data = os.read(fd, 4096)
                if not data:
                    return
                if fd == host:
                    os.write(printer, self._damage(data))
                else:
                    os.write(host, data)

    def _damage(self, data: bytes) -> bytes:
        *lines, self._rest = (self._rest + data).split(b"\n")
        return b"".join(self._line(line) + b"\n" for line in lines)

    def _line(self, line: bytes) -> bytes:
        if line[:1] != b"N" or b"M110" in line or self._random.random() >= 0.01:
            return line
        self.damaged += 1
        at = self._random.randrange(len(line))
        middle = self._random.choice((b"", line[at : at + 1] * 2, bytes([line[at] ^ 1])))
        return line[:at] + middle + line[at + 1 :]
