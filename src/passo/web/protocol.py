"""HTTP connections that do not wait for ever: uvicorn's protocol with limits that it lacks."""

from __future__ import annotations

import asyncio
from ipaddress import ip_address

from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle

HEADERS_S = 10.0  # until the headers of a request are whole
MAX_CONNECTIONS = 1000
MAX_OF_PEER = 64  # connections of one address; a proxy on this computer may have more


class LimitedProtocol(H11Protocol):
    """Closes a connection whose headers come too slowly, and one of a peer that has too many."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """A client has connected."""
        super().connection_made(transport)
        if self._too_many():
            transport.abort()
        else:
            self._start()

    def data_received(self, data: bytes) -> None:
        """Bytes have come. The time for headers runs until they are whole."""
        super().data_received(data)
        if self._asked or self not in self.connections:  # the latter: it is a WebSocket now
            self._stop()
        elif self._deadline is None:
            self._start()

    @property
    def _asked(self) -> bool:
        """A request is under way."""
        cycle: RequestResponseCycle | None = getattr(self, "cycle", None)  # None before the first
        return cycle is not None and not cycle.response_complete

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection has ended."""
        self._stop()
        super().connection_lost(exc)

    def _start(self) -> None:
        self._deadline = self.loop.call_later(HEADERS_S, self.transport.abort)

    def _stop(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _too_many(self) -> bool:
        if len(self.connections) > MAX_CONNECTIONS:
            return True
        peer = self.client[0] if self.client else ""
        if not peer or ip_address(peer.partition("%")[0]).is_loopback:
            return False
        clients = [getattr(one, "client", None) for one in self.connections]
        return sum(client is not None and client[0] == peer for client in clients) > MAX_OF_PEER
