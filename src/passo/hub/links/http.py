"""Requests to a printer over HTTP, with time limits."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Mapping
from typing import TYPE_CHECKING, Any

import msgspec
from aiohttp import (
    ClientError,
    ClientSession,
    ClientTimeout,
    TCPConnector,
    WSMsgType,
    WSServerHandshakeError,
)
from anyio import open_file
from yarl import URL

from passo.errors import HubError
from passo.hub.link import SILENT_S, Unreachable

if TYPE_CHECKING:
    from pathlib import Path

_CONNECT_S = 10.0
_ANSWER_S = 30.0  # until a command is answered
_TRANSFER_S = 120.0  # without a byte in a file: printers write to slow cards
_PIECE = 1 << 18  # bytes of a file read at once
_KEPT_S = 75.0  # an unused connection is kept open
_LARGEST = 1 << 24  # bytes of an answer


def session() -> ClientSession:
    """The connections of all links. Call it in the event loop that uses them."""
    return ClientSession(connector=TCPConnector(limit=0, keepalive_timeout=_KEPT_S))


def address(url: str) -> str:
    """The address of a printer without a slash at its end. Raises HubError."""
    try:
        parts = URL(url)
    except ValueError:
        raise HubError.of("hub.address", value=url) from None
    if parts.scheme not in ("http", "https") or not parts.host or parts.query_string:
        raise HubError.of("hub.address", value=url)
    return str(parts.with_fragment(None)).rstrip("/")


class Exchange:
    """Requests to one printer. All methods raise Unreachable, and the error that `refusal` makes
    from the status and the content of an answer that is not a success."""

    def __init__(
        self,
        session: ClientSession,
        url: str,
        key: str,
        refusal: Callable[[int, bytes], Exception],
    ) -> None:
        self._session, self._url, self._refusal = session, address(url), refusal
        self._headers = {"X-Api-Key": key} if key else {}

    async def ask(
        self,
        method: str,
        path: str,
        *,
        query: Mapping[str, str] | None = None,
        body: object = None,
        user: str = "",
    ) -> bytes:
        """The content of the answer to a request with a body of JSON."""
        headers = {**self._headers, **_named(user)}
        data = None
        if body is not None:
            data = msgspec.json.encode(body)
            headers["Content-Type"] = "application/json"
        limits = ClientTimeout(total=_ANSWER_S, sock_connect=_CONNECT_S)
        return await self._exchange(method, path, query, data, headers, limits)

    async def send(
        self,
        method: str,
        path: str,
        content: Path,
        body: Callable[[AsyncIterator[bytes]], Any],
        *,
        query: Mapping[str, str] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> bytes:
        """Sends a file, in a body that `body` makes from its pieces; returns the content of the
        answer. It may take long, while bytes are sent."""
        limits = ClientTimeout(total=None, sock_connect=_CONNECT_S)
        now_s = asyncio.get_running_loop().time
        headers = {**self._headers, **(headers or {})}
        try:
            async with asyncio.timeout(_TRANSFER_S) as stall:

                async def pieces() -> AsyncGenerator[bytes]:
                    async with await open_file(content, "rb") as file:
                        while piece := await file.read(_PIECE):
                            yield piece
                            stall.reschedule(now_s() + _TRANSFER_S)

                return await self._exchange(method, path, query, body(pieces()), headers, limits)
        except TimeoutError as error:
            raise Unreachable(_reason(error)) from None

    async def messages(self, path: str, first: str = "") -> AsyncGenerator[bytes]:
        """The messages of a WebSocket, after `first` is sent. Ends with Unreachable, at most
        `SILENT_S` after the last word of the printer."""
        try:
            async with asyncio.timeout(_ANSWER_S):
                connected = await self._session.ws_connect(
                    self._url + path,
                    headers=self._headers,
                    heartbeat=SILENT_S * 2 / 3,  # a third more until the answer must have come
                    max_msg_size=_LARGEST,
                )
            async with connected as socket:
                if first:
                    await socket.send_str(first)
                async for message in socket:
                    if message.type is WSMsgType.TEXT:
                        yield message.data.encode()
        except (ClientError, TimeoutError, OSError) as error:
            raise Unreachable(_reason(error)) from None
        raise Unreachable("the printer has closed the connection")

    async def _exchange(
        self,
        method: str,
        path: str,
        query: Mapping[str, str] | None,
        data: Any,
        headers: Mapping[str, str],
        limits: ClientTimeout,
    ) -> bytes:
        try:
            async with self._session.request(
                method,
                self._url + path,
                params=query,
                data=data,
                headers=headers,
                timeout=limits,
                allow_redirects=False,
            ) as answer:
                content = await answer.content.read(_LARGEST)
                status = answer.status
        except (ClientError, TimeoutError, OSError) as error:
            raise Unreachable(_reason(error)) from None
        if status >= 300:
            raise self._refusal(status, content)
        return content


def _named(user: str) -> dict[str, str]:
    """The header with the user's name; other characters than ASCII are escaped."""
    if not user:
        return {}
    return {"X-Passo-User": user.encode("ascii", "backslashreplace").decode()}


def _reason(error: Exception) -> str:
    if isinstance(error, WSServerHandshakeError):
        return f"it answers with status {error.status}"
    return str(error) or ("no answer in time" if isinstance(error, TimeoutError) else repr(error))
