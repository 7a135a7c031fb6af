"""WebSockets with timeouts: uvicorn's protocol with additional limits. The first one loads it."""

from __future__ import annotations

import asyncio

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from passo.web.protocol import Timeout

UNREAD_MESSAGES_S = 5.0  # maximum time for which a client may leave messages unread


class LimitedWebSocket(WebSocketsSansIOProtocol):
    """Ends the connection of a client that does not read, without a close message, which the client
    would not read either."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called when a connection becomes a WebSocket."""
        self._unread = Timeout()
        super().connection_made(transport)

    def pause_writing(self) -> None:
        """Called when more data waits for the client than the buffer may contain."""
        super().pause_writing()
        self._unread.start(UNREAD_MESSAGES_S, self.transport)

    def resume_writing(self) -> None:
        """Called when the client has read enough."""
        self._unread.stop()
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called when the connection has ended."""
        self._unread.stop()
        super().connection_lost(exc)
