"""Connections that do not wait for ever: uvicorn's protocols with limits that they lack."""

from __future__ import annotations

import asyncio
from ipaddress import ip_address

from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

HEADERS_S = 10.0  # until the headers of a request are complete
UNREAD_S = 60.0  # for which a client may leave an answer unread, as a browser that asks its user
UNREAD_MESSAGES_S = 5.0  # for which the client of a WebSocket may do so
MAX_CONNECTIONS = 1000
MAX_OF_PEER = 64  # connections of one address; a proxy on this computer may have more


class _Timeout:
    """Calls `action` once after some time, unless it is stopped before."""

    def __init__(self) -> None:
        self._handle: asyncio.TimerHandle | None = None

    @property
    def runs(self) -> bool:
        return self._handle is not None

    def start(self, after_s: float, transport: asyncio.Transport) -> None:
        """The connection ends after so many seconds from now."""
        self.stop()
        self._handle = asyncio.get_running_loop().call_later(after_s, transport.abort)

    def stop(self) -> None:
        """It does not."""
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None


class LimitedProtocol(H11Protocol):
    """Closes a connection whose headers come too slowly, one whose client does not read, and one of
    a peer that has too many."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """A client has connected."""
        self._headers, self._unread = _Timeout(), _Timeout()
        super().connection_made(transport)
        if self._too_many():
            transport.abort()
        else:
            self._headers.start(HEADERS_S, transport)

    def data_received(self, data: bytes) -> None:
        """Bytes have come. The timeout of headers runs until they are complete."""
        super().data_received(data)
        if self._asked or self not in self.connections:  # the latter: it is a WebSocket now
            self._headers.stop()
        elif not self._headers.runs:
            self._headers.start(HEADERS_S, self.transport)

    @property
    def _asked(self) -> bool:
        """Whether a request is in progress."""
        cycle: RequestResponseCycle | None = getattr(self, "cycle", None)  # None before the first
        return cycle is not None and not cycle.response_complete

    def pause_writing(self) -> None:
        """The client leaves more unread than is kept for it."""
        super().pause_writing()
        self._unread.start(UNREAD_S, self.transport)

    def resume_writing(self) -> None:
        """It has read."""
        self._unread.stop()
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection has ended."""
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


class LimitedWebSocket(WebSocketsSansIOProtocol):
    """Ends the connection of a client that does not read. It gets no close message: it would not
    read that either."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """A connection becomes a WebSocket."""
        self._unread = _Timeout()
        super().connection_made(transport)

    def pause_writing(self) -> None:
        """The client leaves more unread than is kept for it."""
        super().pause_writing()
        self._unread.start(UNREAD_MESSAGES_S, self.transport)

    def resume_writing(self) -> None:
        """It has read."""
        self._unread.stop()
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection has ended."""
        self._unread.stop()
        super().connection_lost(exc)
