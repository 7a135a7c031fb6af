"""Transports for one host each: pseudo terminals and serial devices. Hosts and devices come and
go."""

from __future__ import annotations

import asyncio
import os
import termios
import tty
from pathlib import Path

from passo.console.session import Session
from passo.console.transports.streams import Console, NewSession, StreamWire, cannot_open, join
from passo.serial_line import open_serial_line

REOPEN_S = 1.0  # interval of checks for an unplugged device


class _Pty(StreamWire):
    """A pseudo terminal with a link to it. The program keeps the host's end open too. It closes its
    copy during an upload and within a line, so that a disconnection of the host is detected: later
    bytes must not go into the file, or end the line."""

    def __init__(self, new_session: NewSession, path: str) -> None:
        super().__init__(new_session, f"pty {path}")
        self._link = Path(path)
        self._master, slave = os.openpty()
        self._slave: int | None = slave
        self._name = os.ttyname(slave)
        self._joining: asyncio.Task[StreamWire] | None = None
        tty.setraw(slave)

    async def open(self) -> None:
        """Creates the link, and waits for hosts. Raises OSError."""
        try:
            if self._link.is_symlink():
                self._link.unlink()
            self._link.symlink_to(self._name)
        except OSError:
            self._let_go()
            raise
        await self._join()

    async def _join(self) -> StreamWire:
        return await join(self, os.dup(self._master), os.dup(self._master))

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """A host has opened the other end."""
        super().connection_made(transport)
        assert self.session is not None
        self.session.on_upload = self._share

    def data_received(self, data: bytes) -> None:
        """Passes the bytes of a host to the session."""
        super().data_received(data)
        if self._master >= 0:
            self._share()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called when the host has disconnected, or this end is closed."""
        super().connection_lost(exc)
        if self._master >= 0:  # the host has disconnected: open its end again for the next host
            self._hold(True)
            if self.writer is not None:
                self.writer.abort()
            assert self._slave is not None
            termios.tcflush(self._slave, termios.TCIFLUSH)  # drop answers to the disconnected host
            self._joining = asyncio.get_running_loop().create_task(self._join())

    def _share(self) -> None:
        session = self.session
        if session is not None and not session.closed:
            self._hold(session.upload is None and not session.unfinished)

    def _hold(self, holds: bool) -> None:
        if not holds and self._slave is not None:
            os.close(self._slave)
            self._slave = None
        elif holds and self._slave is None:
            self._slave = os.open(self._name, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(self._slave, termios.TCSANOW)  # keep answers that are not read yet

    def _let_go(self) -> None:
        for fd in (self._master, self._slave):
            if fd is not None:
                os.close(fd)
        self._master, self._slave = -1, None

    def close(self) -> None:
        """Closes both ends."""
        self._let_go()
        if self._joining is not None:
            self._joining.cancel()
        super().close()
        if self._link.is_symlink() and str(self._link.readlink()) == self._name:
            self._link.unlink()


async def open_pty(new_session: NewSession, path: str) -> Console:
    """Opens a pseudo terminal, and makes `path` a link to it, which replaces an existing link.
    Hosts may open and close it at any time. Raises ConsoleError."""
    wire = _Pty(new_session, path)
    try:
        await wire.open()
    except OSError as error:
        raise cannot_open(f"the pty {path}", error) from None
    return wire


class _Serial:
    """A serial device that may be unplugged; it is opened again when it is back."""

    def __init__(self, new_session: NewSession, device: str, baud: int) -> None:
        self.place = f"serial {device} at {baud}"
        self._new_session, self._device, self._baud = new_session, device, baud
        self._wire: StreamWire | None = None
        self._waiting: asyncio.Task[None] | None = None

    @property
    def session(self) -> Session | None:
        """The session of the device that is plugged in."""
        return None if self._wire is None else self._wire.session

    async def open(self) -> None:
        """Opens the device. Raises OSError."""
        line = open_serial_line(self._device, self._baud)
        self._wire = StreamWire(self._new_session, self.place, self._unplugged)
        await join(self._wire, line, os.dup(line))

    def _unplugged(self, wire: StreamWire) -> None:
        wire.close()
        self._wire = None
        self._waiting = asyncio.get_running_loop().create_task(self._wait_for_it())

    async def _wait_for_it(self) -> None:
        while self._wire is None:
            await asyncio.sleep(REOPEN_S)
            try:
                await self.open()
            except OSError:
                self._wire = None

    def close(self) -> None:
        """Closes the device and its session."""
        if self._waiting is not None:
            self._waiting.cancel()
        if self._wire is not None:
            self._wire.closed = None
            self._wire.close()


async def open_serial(new_session: NewSession, device: str, baud: int) -> Console:
    """Opens a serial device at any baud rate that its driver supports. When the device is
    unplugged, its session ends; when it is back, a new session begins. Raises ConsoleError."""
    serial = _Serial(new_session, device, baud)
    try:
        await serial.open()
    except OSError as error:
        raise cannot_open(f"the serial device {device}", error) from None
    return serial
