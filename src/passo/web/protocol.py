"""Connections with timeouts: uvicorn's protocols with additional limits."""

from __future__ import annotations

import asyncio
from email.utils import formatdate
from ipaddress import ip_address

from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

HEADERS_S = 10.0  # maximum time until the headers of a request are complete
# maximum time for which a client may leave an answer unread, such as a browser that asks its user
UNREAD_S = 60.0
MAX_CONNECTIONS = 1000
MAX_OF_PEER = 64  # maximum of connections from one address, except a proxy on this computer


class Timeout:
    """Calls `action` once after some time, unless it is stopped before."""

    def __init__(self) -> None:
        self._handle: asyncio.TimerHandle | None = None

    @property
    def runs(self) -> bool:
        """Whether it is started."""
        return self._handle is not None

    def start(self, after_s: float, transport: asyncio.Transport) -> None:
        """Starts the timeout: the connection ends `after_s` seconds from now."""
        self.stop()
        self._handle = asyncio.get_running_loop().call_later(after_s, transport.abort)

    def stop(self) -> None:
        """Stops the timeout."""
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None


class LimitedProtocol(H11Protocol):
    """Closes a connection if its headers arrive too slowly, if its client does not read, or if its
    address has too many connections."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Called when a client has connected."""
        self._headers, self._unread = Timeout(), Timeout()
        super().connection_made(transport)
        if self._too_many():
            transport.abort()
        else:
            self._headers.start(HEADERS_S, transport)

    def data_received(self, data: bytes) -> None:
        """Called when bytes have arrived. The timeout of headers runs until they are complete."""
        date = formatdate(usegmt=True).encode()
        self.server_state.default_headers = [(b"date", date)]  # else uvicorn would tick for it
        super().data_received(data)
        # not in `connections`: it is a WebSocket now
        if self._asked or self not in self.connections:
            self._headers.stop()
        elif not self._headers.runs:
            self._headers.start(HEADERS_S, self.transport)

    @property
    def _asked(self) -> bool:
        """Whether a request is in progress."""
        # None before the first request
        cycle: RequestResponseCycle | None = getattr(self, "cycle", None)
        return cycle is not None and not cycle.response_complete

    def pause_writing(self) -> None:
        """Called when more data waits for the client than the buffer may contain."""
        super().pause_writing()
        self._unread.start(UNREAD_S, self.transport)

    def resume_writing(self) -> None:
        """Called when the client has read enough."""
        self._unread.stop()
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called when the connection has ended."""
        self._headers.stop()
        self._unread.stop()
        super().connection_lost(exc)

    def _too_many(self) -> bool:
        if len(self.connections) > MAX_CONNECTIONS:
            return True
        peer = self.client[0] if self.client else ""
        if not peer or ip_address(peer.partition("%")[0]).is_loopback:
            return False
        clients = [getattr(one, "client", None) for one in self.connections]
        return sum(client is not None and client[0] == peer for client in clients) > MAX_OF_PEER
