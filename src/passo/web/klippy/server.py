"""Klipper's socket in the web's event loop."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import PassoError
from passo.gcode.command import Command
from passo.web.klippy.connection import Connection, TooManyRequestsError
from passo.web.klippy.engine import Engine
from passo.web.klippy.wire import FrameTooLongError
from passo.web.unix_sockets import UnixSocket

if TYPE_CHECKING:
    from passo.web.bridge import Bridge

_log = logging.getLogger(__name__)

PUSH_S = 0.25  # between two messages about objects
_TIMEOUT_S = 5.0  # for a client that does not read
_MAX_WAITING = 32 << 20  # bytes that may wait for such a client
_MODE = 0o600  # for this user alone


class KlippySocket:
    """Serves one printer on a Unix socket, which only this user may open. When the printer
    restarts, all connections end and the socket is created again, as clients expect."""

    def __init__(self, bridge: Bridge, path: str, *, log_file: str | None = None) -> None:
        """Raises InputError if the socket cannot be made."""
        self._bridge, self._path, self._log_file = bridge, Path(path), log_file
        self._listening = UnixSocket(self._path, _MODE)

    async def run(self) -> None:
        """Serves until cancelled, and then removes the socket."""
        try:
            while True:
                if await self._serve():
                    await self._restart()
                self._listening = UnixSocket(self._path, _MODE)
        finally:
            self._listening.remove()

    async def _serve(self) -> bool:
        """Serves until the printer restarts. Returns True if the caller must restart it."""
        loop = asyncio.get_running_loop()
        ended: asyncio.Future[bool] = loop.create_future()

        def end(restart: bool) -> None:
            if not ended.done():
                # Let answers that are ready reach the clients.
                loop.call_soon(lambda: ended.done() or ended.set_result(restart))

        engine = Engine(self._bridge, end, now_s=loop.time, log_file=self._log_file)
        clients: set[_Client] = set()
        server = await loop.create_unix_server(
            lambda: _Client(engine, clients), sock=self._listening.socket
        )
        silence = self._bridge.listen(engine)
        try:
            while not ended.done():
                await asyncio.wait([ended], timeout=PUSH_S)
                engine.tell_changes()
                for client in list(clients):
                    client.drop_if_slow()
            return ended.result()
        finally:
            silence()
            server.close()
            self._listening.remove()
            for client in list(clients):
                client.close()

    async def _restart(self) -> None:
        try:
            await self._bridge.call(Command.call("FIRMWARE_RESTART"), sender="Klipper's socket")
        except PassoError as error:
            _log.error("The restart failed: %s", error)


class _Client(asyncio.Protocol):
    """The connection of one client."""

    def __init__(self, engine: Engine, clients: set[_Client]) -> None:
        self._engine, self._clients = engine, clients
        self._connection = Connection(engine, self._send)
        self._transport: asyncio.Transport | None = None
        self._waits_since_s: float | None = None  # since then, data waits for the client to read

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Like `asyncio.Protocol.connection_made`."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._clients.add(self)
        self._engine.connections.append(self._connection)

    def connection_lost(self, exc: Exception | None) -> None:
        """Like `asyncio.Protocol.connection_lost`. Running scripts continue."""
        self._transport = None
        self._clients.discard(self)
        self._engine.connections.remove(self._connection)

    def data_received(self, data: bytes) -> None:
        """Like `asyncio.Protocol.data_received`."""
        try:
            self._connection.receive(data)
        except FrameTooLongError:
            self._drop("its request is too long")
        except TooManyRequestsError:
            self._drop("it does not wait for its answers")

    def drop_if_slow(self) -> None:
        """Ends the connection of a client that has not read for some time."""
        if self._transport is None:
            return
        waiting, now_s = self._transport.get_write_buffer_size(), asyncio.get_running_loop().time()
        if waiting == 0:
            self._waits_since_s = None
        elif self._waits_since_s is None:
            self._waits_since_s = now_s
        elif now_s - self._waits_since_s > _TIMEOUT_S or waiting > _MAX_WAITING:
            self._drop(f"it has left {waiting} bytes unread")

    def close(self) -> None:
        """Closes the connection after the sent data."""
        if self._transport is not None:
            self._transport.close()

    def _send(self, frame: bytes) -> None:
        if self._transport is not None:
            self._transport.write(frame)

    def _drop(self, why: str) -> None:
        _log.warning("A client of Klipper's socket is dropped: %s", why)
        if self._transport is not None:
            self._transport.abort()
