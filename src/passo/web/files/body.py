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
MIN_BYTES = 3000  # within each span: 100 bytes/s, less than any network that works


class Pace:
    """Whether a sender is fast enough; times are those of any clock, in seconds."""

    def __init__(self, now_s: float) -> None:
        self._since_s, self._bytes = now_s, 0

    def received(self, now_s: float, count: int) -> None:
        """Bytes have come. Raises InputError `upload.slow`."""
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
    """The body of one request, to be read once."""

    def __init__(self, request: Request) -> None:
        self._receive = request.receive
        self._more = True
        self.type = request.headers.get("content-type", "")
        length = request.headers.get("content-length", "")
        self.length = int(length) if length.isascii() and length.isdecimal() else None
        """Its bytes, if the client declares them before."""

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
            self._more = False  # of a sender that is too slow, no more is read
            pace.received(current_time(), len(data))
            self._more = more
            if data:
                yield data

    async def drain(self) -> None:
        """Reads the rest and discards it: a client that is still sending does not read the
        answer."""
        with suppress(InputError, ClientDisconnect):
            async for _ in self.pieces():
                pass
