"""Ways in: pty, serial device, TCP, standard input and output. Each gives a session its bytes."""

from __future__ import annotations

import asyncio
import fcntl
import os
import struct
import sys
import termios
import tty
from collections.abc import Callable
from pathlib import Path

from passo.console.session import Session
from passo.errors import PassoError, Problem
from passo.printer.printer import Printer

_AT_ONCE = 4096  # bytes; asyncio would read 256 KiB, whose lines keep all others waiting for 0.8 s
_ROOM = 1 << 16  # bytes that may wait for a reader before dispensable ones are dropped
_DEAD = 1 << 20  # and before all are
_TCGETS2, _TCSETS2 = 0x802C542A, 0x402C542B
_BOTHER, _CBAUD = 0o010000, 0o010017

Opened = Callable[[Session], None]


class ConsoleError(PassoError):
    """A console cannot be opened."""


def _cannot(what: str, error: OSError) -> ConsoleError:
    values = {"axis": what, "value": error.strerror or str(error)}
    return ConsoleError([Problem("console.unopened", values=values)])


class _Wire(asyncio.Protocol):
    """A session on one transport for both ways, or on one that reads and, given before, one that
    writes."""

    def __init__(self, printer: Printer, opened: Opened, closed: Opened | None = None) -> None:
        self._printer, self._opened, self._closed = printer, opened, closed
        self.reader: asyncio.ReadTransport | None = None
        self.writer: asyncio.WriteTransport | None = None
        self.session: Session | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        if isinstance(transport, asyncio.ReadTransport):
            self.reader = transport
            transport.max_size = _AT_ONCE  # pyright: ignore[reportAttributeAccessIssue]
        if self.writer is None and isinstance(transport, asyncio.WriteTransport):
            self.writer = transport
        self.session = Session(self._printer, self)
        self._opened(self.session)

    def data_received(self, data: bytes) -> None:
        if self.session is not None:
            self.session.receive(data)

    def connection_lost(self, exc: Exception | None) -> None:
        if self.session is not None and not self.session.closed:
            self.session.close()
            if self._closed is not None:
                self._closed(self.session)

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        """Sends bytes; drops them where nobody reads."""
        if self.writer is None or self.writer.is_closing():
            return
        waiting = self.writer.get_write_buffer_size()
        if waiting < (_ROOM if dispensable else _DEAD):
            self.writer.write(text)

    def hold(self, held: bool) -> None:
        """Stops or resumes reading."""
        if self.reader is None or self.reader.is_closing():
            return
        if held:
            self.reader.pause_reading()
        else:
            self.reader.resume_reading()


class _Writing(asyncio.BaseProtocol):
    """Of a transport that only writes: what cannot be written is dropped by `_Wire.write`."""


async def _join(printer: Printer, opened: Opened, read_fd: int, write_fd: int) -> _Wire:
    loop = asyncio.get_running_loop()
    wire = _Wire(printer, opened)
    wire.writer, _ = await loop.connect_write_pipe(_Writing, os.fdopen(write_fd, "wb", 0))
    await loop.connect_read_pipe(lambda: wire, os.fdopen(read_fd, "rb", 0))
    return wire


async def open_pty(printer: Printer, path: str, opened: Opened) -> None:
    """A pseudo terminal with a link to it at `path`. Hosts may open and close it as they like: its
    other end stays open here."""
    master, slave = os.openpty()
    tty.setraw(slave)
    link = Path(path)
    try:
        if link.is_symlink():
            link.unlink()
        link.symlink_to(os.ttyname(slave))
    except OSError as error:
        raise _cannot(f"the pty {path}", error) from None
    await _join(printer, opened, master, os.dup(master))


async def open_serial(printer: Printer, device: str, baud: int, opened: Opened) -> None:
    """A serial device at any rate that its driver can do."""
    try:
        port = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(port)
        attributes = bytearray(44)
        fcntl.ioctl(port, _TCGETS2, attributes, True)
        inputs, outputs, control, local, line, keys, _, _ = struct.unpack("4IB19s2I", attributes)
        control = (control & ~_CBAUD) | _BOTHER | termios.CLOCAL | termios.CREAD
        termios2 = struct.pack("4IB19s2I", inputs, outputs, control, local, line, keys, baud, baud)
        fcntl.ioctl(port, _TCSETS2, termios2)
    except termios.error as error:
        raise _cannot(f"the serial device {device}", OSError(*error.args)) from None
    except OSError as error:
        raise _cannot(f"the serial device {device}", error) from None
    await _join(printer, opened, port, os.dup(port))


async def open_tcp(
    printer: Printer, host: str, port: int, clients: int, opened: Opened
) -> asyncio.Server:
    """A TCP console for so many clients at once; one more is told so and sent away."""
    loop = asyncio.get_running_loop()
    present: set[Session] = set()

    def joined(session: Session) -> None:
        present.add(session)
        opened(session)

    class Client(_Wire):
        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            if len(present) >= clients and isinstance(transport, asyncio.WriteTransport):
                transport.write(b"Error:too many clients\n")
                transport.close()
                return
            super().connection_made(transport)

    try:
        return await loop.create_server(
            lambda: Client(printer, joined, present.discard), host or None, port
        )
    except OSError as error:
        raise _cannot(f"TCP {host}:{port}", error) from None


async def open_stdin(printer: Printer, opened: Opened) -> None:
    """The terminal or pipe that the program was started on."""
    try:
        await _join(printer, opened, os.dup(sys.stdin.fileno()), os.dup(sys.stdout.fileno()))
    except ValueError:
        values = {"axis": "standard input", "value": "it is a file"}
        raise ConsoleError([Problem("console.unopened", values=values)]) from None
