"""Transports for TCP and for standard input and output, and the code that all transports share.
Pseudo terminals and serial devices are in `serial`."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import selectors
import shutil
import sys
import threading
from collections.abc import Callable
from io import FileIO
from typing import Protocol

from passo.console.session import Session, Wire
from passo.errors import PassoError

_log = logging.getLogger(__name__)

# bytes of one read; asyncio would read 256 KiB, whose lines would block other tasks for 0.8 s
_AT_ONCE = 4096
_ROOM = 1 << 16  # waiting bytes above which dispensable text is dropped
_DEAD = 1 << 20  # waiting bytes above which all text is dropped

NewSession = Callable[[Wire], Session]  # makes the session of a console that opens


class Console(Protocol):
    """An open console; `place` names it for users."""

    place: str

    def close(self) -> None:
        """Closes the console and its sessions."""


class ConsoleError(PassoError):
    """A console cannot be opened."""


def cannot_open(what: str, error: Exception) -> ConsoleError:
    """The error for a console that cannot be opened."""
    why = error.strerror if isinstance(error, OSError) else None
    return ConsoleError.of("console.unopened", axis=what, value=why or str(error))


class StreamWire(asyncio.Protocol):
    """Connects a session to its transport: one for both directions, or one for reading and one for
    writing. The one for writing must be set first."""

    def __init__(
        self,
        new_session: NewSession,
        place: str,
        closed: Callable[[StreamWire], None] | None = None,
    ) -> None:
        self.place = place
        self._new_session, self.closed = new_session, closed
        self.reader: asyncio.ReadTransport | None = None
        self.writer: asyncio.WriteTransport | _Filed | None = None
        self.session: Session | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Starts a session when the transport is open."""
        if isinstance(transport, asyncio.ReadTransport):
            self.reader = transport
            transport.max_size = _AT_ONCE  # pyright: ignore[reportAttributeAccessIssue]
        if self.writer is None and isinstance(transport, asyncio.WriteTransport):
            self.writer = transport
        self.session = self._new_session(self)
        _log.info("Console %d opened on %s", self.session.number, self.place)

    def data_received(self, data: bytes) -> None:
        """Passes the bytes of a host to the session."""
        if self.session is not None:
            self.session.receive(data)

    def connection_lost(self, exc: Exception | None) -> None:
        """Ends the session when the host has disconnected."""
        if self.session is not None and not self.session.closed:
            self.session.close()
            _log.info("Console %d closed", self.session.number)
            if self.closed is not None:
                self.closed(self)

    def unread(self) -> None:
        """Called when the separate output stream is closed; the session stays until the input
        ends."""
        self.writer = None  # the transport has closed itself

    def write(self, text: bytes, *, dispensable: bool = False) -> None:
        """Sends bytes; drops them if no client reads."""
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

    def close(self) -> None:
        """Ends the session; answers that are not read yet are dropped."""
        if self.reader is not None:
            self.reader.close()
        if self.writer is not None:
            self.writer.abort()


class _Writing(asyncio.BaseProtocol):
    """The protocol of a separate writing transport."""

    def __init__(self, wire: StreamWire) -> None:
        self._wire = wire
        self._transport: asyncio.BaseTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called when the transport is open."""
        self._transport = transport

    def connection_lost(self, exc: Exception | None) -> None:
        """Called when the reader has closed its end, or this end is closed."""
        if self._wire.writer is self._transport:
            self._wire.unread()


class _Filed:
    """A writing transport for a file; data that a full disk refuses is dropped."""

    def __init__(self, file: FileIO) -> None:
        self._file = file

    def write(self, data: bytes) -> None:
        """Writes to the file."""
        with contextlib.suppress(OSError):
            self._file.write(data)

    def is_closing(self) -> bool:
        """Whether the file is closed."""
        return self._file.closed

    def get_write_buffer_size(self) -> int:
        """The number of waiting bytes: always 0."""
        return 0

    def abort(self) -> None:
        """Closes the file."""
        self._file.close()


async def join(wire: StreamWire, read_fd: int, write_fd: int) -> StreamWire:
    """Opens a session on two descriptors, and takes their ownership. The reading one must not be a
    file. Raises OSError and ValueError."""
    loop = asyncio.get_running_loop()
    writes, reads = os.fdopen(write_fd, "wb", 0), os.fdopen(read_fd, "rb", 0)
    try:
        if _has_events(write_fd, selectors.EVENT_WRITE):
            wire.writer, _ = await loop.connect_write_pipe(lambda: _Writing(wire), writes)
        else:
            wire.writer = _Filed(writes)
        await loop.connect_read_pipe(lambda: wire, reads)
    except (OSError, ValueError):
        wire.close()
        writes.close()
        reads.close()
        raise
    return wire


def _has_events(fd: int, event: int) -> bool:
    """Whether the event loop can wait for the descriptor; it cannot for files and /dev/null."""
    with selectors.DefaultSelector() as selector:
        try:
            selector.register(fd, event)
        except PermissionError:
            return False
    return True


def _piped(fd: int) -> int:
    """A pipe that a thread fills from a file; the thread takes the ownership of `fd`."""
    reads, writes = os.pipe()

    def carry() -> None:
        file, pipe = os.fdopen(fd, "rb", 0), os.fdopen(writes, "wb", 0)
        # The file is unreadable, or the console is closed: end the input.
        with file, pipe, contextlib.suppress(OSError):
            shutil.copyfileobj(file, pipe)

    threading.Thread(target=carry, daemon=True).start()
    return reads


class _Client(StreamWire):
    """The session of a TCP client."""

    def eof_received(self) -> bool:
        """Called when the client has closed its sending side. Its lines are still executed, because
        it may still read; if it does not, the next write fails."""
        if self.session is None or self.session.closed:
            return False
        self.session.end(self._answered)
        return True

    def _answered(self) -> None:
        if self.closed is not None:
            self.closed(self)
        if self.reader is not None:
            self.reader.close()


class _SentAway(asyncio.Protocol):
    """A client beyond the maximum number."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Sends the reason, and disconnects."""
        if isinstance(transport, asyncio.WriteTransport):
            transport.write(b"Error:too many clients\n")
            transport.close()


class _Tcp:
    """A server with a limited number of clients."""

    def __init__(self, new_session: NewSession, most: int) -> None:
        self.place = ""
        self.server: asyncio.Server | None = None
        self._new_session, self._most = new_session, most
        self._clients: set[StreamWire] = set()

    def client(self) -> asyncio.Protocol:
        """The protocol of a new client."""
        if len(self._clients) >= self._most:
            return _SentAway()
        wire = _Client(self._new_session, self.place, self._clients.discard)
        self._clients.add(wire)
        return wire

    def close(self) -> None:
        """Closes the server and all its sessions."""
        if self.server is not None:
            self.server.close()
        for wire in list(self._clients):
            wire.close()


async def open_tcp(new_session: NewSession, host: str, port: int, clients: int) -> Console:
    """Opens a TCP console for at most `clients` clients at once; a further client receives a
    message and is disconnected. Port 0 is any free port. Raises ConsoleError."""
    tcp = _Tcp(new_session, clients)
    try:
        tcp.server = await asyncio.get_running_loop().create_server(tcp.client, host, port)
    except (OSError, UnicodeError) as error:
        raise cannot_open(f"TCP {host}:{port}", error) from None
    tcp.place = f"tcp {host}:{tcp.server.sockets[0].getsockname()[1]}"
    return tcp


class _Standard(StreamWire):
    """The console on standard input and output. At the end of the input, the queued lines are
    executed, and then `ended` is called. If the reader of standard output closes it, like `head`,
    the console ends at once."""

    ended: Callable[[], None]

    def unread(self) -> None:
        """Called when standard output is closed: discards the queued lines, whose answers could not
        be delivered."""
        super().unread()
        if self.session is not None and not self.session.closed:
            self.session.close()
            self.ended()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called when the input has ended."""
        if self.session is not None and not self.session.closed:
            self.session.end(self.ended)


async def open_stdin(new_session: NewSession, ended: Callable[[], None]) -> Console:
    """Opens a console on standard input and output: a terminal, a pipe or a file. `ended` is called
    when the input has ended and all its lines are executed. Raises ConsoleError."""
    wire = _Standard(new_session, "standard input")
    wire.ended = ended
    # The streams are None if the parent process has closed them.
    if sys.stdin is None or sys.stdout is None:  # pyright: ignore[reportUnnecessaryComparison]
        raise ConsoleError.of(
            "console.unopened", axis=wire.place, value="it, or standard output, is closed"
        )
    reads, writes = os.dup(sys.stdin.fileno()), os.dup(sys.stdout.fileno())
    try:
        if not _has_events(reads, selectors.EVENT_READ):
            reads = _piped(reads)
        return await join(wire, reads, writes)
    except (ValueError, OSError) as error:
        raise cannot_open(wire.place, error) from None
