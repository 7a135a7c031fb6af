"""The body of a request, read as it arrives, with a minimum rate."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import suppress
from typing import TYPE_CHECKING

from anyio import current_time, fail_after
from starlette.requests import ClientDisconnect

from passo.errors import InputError

if TYPE_CHECKING:
    from starlette.requests import Request

SPAN_S = 30.0
MIN_BYTES = 3000  # in each span: 100 bytes/s, less than any working network


class Pace:
    """Checks whether a sender is fast enough. Times are in seconds of any steady clock."""

    def __init__(self, now_s: float) -> None:
        self._since_s, self._bytes = now_s, 0

    def received(self, now_s: float, count: int) -> None:
        """Call this when bytes have arrived. Raises InputError `upload.slow`."""
        self._bytes += count
        if now_s - self._since_s < SPAN_S:
            return
        if self._bytes < MIN_BYTES:
            raise self.too_slow()
        self._since_s, self._bytes = now_s, 0

    def too_slow(self) -> InputError:
        """The error for a sender that is too slow."""
        return InputError.of("upload.slow", value=self._bytes, limit=f"{SPAN_S:g}")


class Body:
    """The body of one request. It can be read once."""

    def __init__(self, request: Request) -> None:
        self._receive = request.receive
        self._more = True
        self.type = request.headers.get("content-type", "")
        length = request.headers.get("content-length", "")
        self.length = int(length) if length.isascii() and length.isdecimal() else None
        """The size in bytes, if the client has declared it."""

    async def pieces(self) -> AsyncGenerator[bytes]:
        """The next bytes, as they arrive. Raises InputError `upload.slow`, and ClientDisconnect."""
        pace = Pace(current_time())
        while self._more:
            try:
                with fail_after(SPAN_S):
                    message = await self._receive()
            except TimeoutError:
                self._more = False
                raise pace.too_slow() from None
            if message["type"] == "http.disconnect":
                self._more = False
                raise ClientDisconnect
            data, more = message.get("body", b""), message.get("more_body", False)
            self._more = False  # do not read more from a sender that is too slow
            pace.received(current_time(), len(data))
            self._more = more
            if data:
                yield data

    async def drain(self) -> None:
        """Reads and discards the rest, because a client that is still sending does not read the
        answer."""
        with suppress(InputError, ClientDisconnect):
            async for _ in self.pieces():
                pass
