"""A printer that Passo serves, over its HTTP interface."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import aclosing
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

import msgspec
from msgspec import Struct

from passo.errors import HubError
from passo.hub.link import PrinterRecord, Refused, RunReport, Unreachable
from passo.hub.links.http import Exchange, address
from passo.web.answers import Refusal
from passo.web.summary import Summary

if TYPE_CHECKING:
    from aiohttp import ClientSession

    from passo.hub.wishes import NewPrinter

_API = "/api/v1"
_FOLDER = "/hub"  # of the printer's card
_UNKNOWN = "run.unknown"
_CODES = ("web.log-in", "web.pairing")
# An unexpected fault of the printer's program: it may have done what was asked.
_UNCERTAIN = ("web.program", "web.slow")
_T = TypeVar("_T")


class _Stored(Struct):
    path: str
    complete: bool


class _Run(Struct):
    state: str
    reason: str = ""


class _Text(Struct):
    text: str


class _Picture(Struct):
    number: int


class _Pictures(Struct):
    thumbnails: list[_Picture]


class _Key(Struct):
    id: str
    name: str
    key: str


def _refusal(status: int, content: bytes) -> Exception:
    """The printer's own error; without one, something else has answered."""
    try:
        fault = msgspec.json.decode(content, type=Refusal).error
    except msgspec.DecodeError:
        return Unreachable(f"an answer with status {status} is not of Passo")
    if fault.code in _UNCERTAIN:
        return Unreachable(fault.message)
    return Refused(fault.code, fault.message, fault.action)


class PassoLink:
    """One printer; see `Link`. Another printer at its address counts as unreachable."""

    def __init__(self, session: ClientSession, record: PrinterRecord) -> None:
        self._id = record.id
        self._exchange = Exchange(session, record.url, record.key, _refusal)

    async def follow(self, seen: Callable[[Summary], None]) -> None:
        """Like `Link.follow`."""
        async with aclosing(self._exchange.messages(f"{_API}/summary/feed")) as messages:
            async for message in messages:
                seen(self._own(_decoded(message, Summary)))

    async def upload(self, content: Path, name: str, sha256: str) -> str:
        """Like `Link.upload`. The printer checks the hash before the file gets its name."""
        answer = await self._exchange.send(
            "PUT",
            f"{_API}/files/content",
            content,
            lambda pieces: pieces,
            query={"path": f"{_FOLDER}/{name}", "sha256": sha256},
            headers={
                "Content-Type": "application/octet-stream",
                "Content-Length": str(content.stat().st_size),
            },
        )
        stored = _decoded(answer, _Stored)
        if not stored.complete:
            raise Unreachable("the file has not arrived as a whole")
        return stored.path

    async def start(self, run: str, path: str, user: str) -> None:
        """Like `Link.start`: the printer stores the run id before the print starts."""
        await self._post("job/start", user, {"path": path, "run": run})

    async def report(self, run: str) -> RunReport | None:
        """Like `Link.report`."""
        try:
            answer = await self._exchange.ask("GET", f"{_API}/runs/{run}")
        except Refused as refusal:
            if refusal.code != _UNKNOWN:
                raise
            self._own(await self._summary())
            return None
        found = _decoded(answer, _Run)
        return RunReport(found.state, found.reason)

    async def pause(self, user: str) -> None:
        """Like `Link.pause`."""
        await self._post("job/pause", user)

    async def resume(self, user: str) -> None:
        """Like `Link.resume`."""
        await self._post("job/resume", user)

    async def cancel(self, user: str) -> None:
        """Like `Link.cancel`."""
        await self._post("job/cancel", user)

    async def stop(self, user: str) -> None:
        """Like `Link.stop`."""
        await self._post("stop", user)

    async def machine(self) -> str:
        """Like `Link.machine`."""
        return _decoded(await self._exchange.ask("GET", f"{_API}/machine/file"), _Text).text

    async def picture(self, path: str) -> bytes:
        """Like `Link.picture`: the largest one."""
        query = {"path": path}
        answer = await self._exchange.ask("GET", f"{_API}/files/metadata", query=query)
        pictures = _decoded(answer, _Pictures).thumbnails
        if not pictures:
            return b""
        query["number"] = str(pictures[-1].number)
        return await self._exchange.ask("GET", f"{_API}/files/thumbnail", query=query)

    async def close(self) -> None:
        """Like `Link.close`. The connections belong to all links."""

    async def _summary(self) -> Summary:
        return _decoded(await self._exchange.ask("GET", f"{_API}/summary"), Summary)

    async def _post(self, what: str, user: str, body: object = None) -> None:
        await self._exchange.ask("POST", f"{_API}/{what}", body=body, user=user)

    def _own(self, summary: Summary) -> Summary:
        if summary.id != self._id:
            raise Unreachable(f"another printer answers at this address: {summary.name}")
        return summary


async def pair(session: ClientSession, wish: NewPrinter) -> PrinterRecord:
    """Makes the hub known to a printer: with a one-time code, or with a key. A printer without an
    administrator, on this computer, needs neither. Raises HubError, Unreachable and Refused."""
    url = address(wish.url)
    exchange = Exchange(session, url, wish.key, _refusal)
    if wish.key:
        answer = _decoded(await exchange.ask("GET", f"{_API}/summary"), Summary)
        return PrinterRecord(answer.id, wish.name or answer.name, url, "passo", wish.key)
    body = {"code": wish.code, "name": f"hub on {socket.gethostname()}"[:64]}
    try:
        made = _decoded(await exchange.ask("POST", f"{_API}/pair", body=body), _Key)
    except Refused as refusal:
        if refusal.code in _CODES:
            raise HubError.of("hub.code", axis=url) from None
        raise
    return PrinterRecord(made.id, wish.name or made.name, url, "passo", made.key)


def _decoded(content: bytes, kind: type[_T]) -> _T:
    try:
        return cast("_T", msgspec.json.decode(content, type=cast("Any", kind)))
    except msgspec.DecodeError as error:
        raise Unreachable(f"an answer is not of Passo: {error}") from None
