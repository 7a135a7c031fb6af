"""One WebSocket: sends changes of the status, events and console lines, and receives scripts. A
slow client misses states."""

from __future__ import annotations

import asyncio
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import msgspec
from anyio import create_task_group
from msgspec import Meta, Struct
from starlette.websockets import WebSocketDisconnect

from passo.errors import PassoError, WebError
from passo.web.answers import fault, refusal
from passo.web.messages import text
from passo.web.roles import Role

if TYPE_CHECKING:
    from anyio.abc import TaskGroup
    from starlette.websockets import WebSocket

    from passo.events import Event
    from passo.printer.console_lines import ConsoleLine
    from passo.web.deltas import Tree
    from passo.web.feeds import Feeds
    from passo.web.messages import Messages
    from passo.web.operation import Caller
    from passo.web.site import Site

_MAX_WAITING = 1000  # maximum of events, and of lines, that wait for a slow client
_MAX_SCRIPTS = 16  # of one client at a time
NOT_ALLOWED = 1008  # "policy violation" (IANA, WebSocket close codes)


class Script(Struct, tag_field="type", tag="script", forbid_unknown_fields=True):
    """Lines of G-code from a client. The answer has the same `id`."""

    id: int
    script: Annotated[str, Meta(max_length=50_000)]


class Listen(Struct, tag_field="type", tag="listen", forbid_unknown_fields=True):
    """Whether the client wants the lines of all consoles, and those of firmware builds."""

    console: bool
    builds: bool = False


@dataclass(frozen=True, slots=True)
class BuildLine:
    """A line of a firmware build, and the state of the build. The line is empty when the build
    ends."""

    number: int
    state: str
    line: str


async def serve_feed(site: Site, feeds: Feeds, messages: Messages, websocket: WebSocket) -> None:
    """Serves a client if it has the right to see the printer. Nothing is sent before this is
    checked."""
    if (caller := await viewer_of(site, websocket)) is not None:
        await Feed(site, feeds, messages, websocket, caller).run()


async def viewer_of(site: Site, websocket: WebSocket) -> Caller | None:
    """The caller of a WebSocket; None if it is refused, for it may not see the printer."""
    try:
        caller = site.access.caller(websocket, writes=False)
        site.access.require(caller, Role.VIEWER)
    except PassoError as error:
        await websocket.send_denial_response(refusal(error))
        return None
    return caller


class Feed:
    """Messages are JSON objects with a `type`: docs/reference/http.md lists them."""

    def __init__(
        self,
        site: Site,
        feeds: Feeds,
        messages: Messages,
        websocket: WebSocket,
        caller: Caller,
    ) -> None:
        self._site, self._feeds, self._messages = site, feeds, messages
        self._websocket, self._caller = websocket, caller
        self._waiting: deque[Event | ConsoleLine | BuildLine] = deque()
        self._answers: deque[Tree] = deque()
        self._lost = 0
        self._news = asyncio.Event()
        self._scripts = 0
        self._end_lines = lambda: None

    def wake(self) -> None:
        """Like `Woken.wake`."""
        self._news.set()

    def on_event(self, event: Event) -> None:
        """Like `Woken.on_event`."""
        self._keep(event)

    def _keep(self, one: Event | ConsoleLine | BuildLine) -> None:
        if len(self._waiting) == _MAX_WAITING:
            self._waiting.popleft()
            self._lost += 1
        self._waiting.append(one)

    def _queue(self, one: ConsoleLine | BuildLine) -> None:
        self._keep(one)
        self._news.set()

    async def run(self) -> None:
        """Serves the client until it disconnects, does not read, or loses the right to see the
        printer."""
        await self._websocket.accept()
        end = self._feeds.join(self)
        self._sent = self._feeds.snapshot
        try:
            async with create_task_group() as group:
                group.start_soon(self._receive, group)
                with suppress(WebSocketDisconnect):  # it may disconnect at any time
                    await self._send_all()
                group.cancel_scope.cancel()
        finally:
            end()
            self._end_lines()
            self._listen_to_builds(wanted=False)

    # -- from the client --------------------------------------------------------------------------

    async def _receive(self, group: TaskGroup) -> None:
        """Receives the messages of the client; ends the other tasks when it has disconnected."""
        with suppress(WebSocketDisconnect, KeyError):  # KeyError: the message is not text
            while True:
                self._take(await self._websocket.receive_text(), group)
        group.cancel_scope.cancel()

    def _take(self, received: str, group: TaskGroup) -> None:
        try:
            message = msgspec.json.decode(received, type=Script | Listen)
        except msgspec.DecodeError as error:
            self._answer(None, WebError.of("web.malformed", value=error))
            return
        if isinstance(message, Listen):
            self._end_lines()
            listen = self._site.bridge.on_console_line
            self._end_lines = listen(self._queue) if message.console else lambda: None
            self._listen_to_builds(wanted=message.builds)
        else:
            group.start_soon(self._run, message)

    def _listen_to_builds(self, *, wanted: bool) -> None:
        listeners = self._site.builds.listeners
        if self._build in listeners:
            listeners.remove(self._build)
        if wanted:
            listeners.append(self._build)

    def _build(self, number: int, state: str, line: str) -> None:
        self._queue(BuildLine(number, state, line))

    async def _run(self, message: Script) -> None:
        self._scripts += 1
        try:
            if not self._site.access.holds(self._caller):
                raise WebError.of("web.log-in")
            self._site.access.require(self._caller, Role.OPERATOR)
            if self._scripts > _MAX_SCRIPTS:
                raise WebError.of("web.scripts", limit=_MAX_SCRIPTS)
            lines = await self._site.bridge.run(message.script, sender=self._caller.name)
            self._answers.append({"id": message.id, "lines": lines, "error": None})
            self._news.set()
        except PassoError as error:
            self._answer(message.id, error)
        finally:
            self._scripts -= 1

    def _answer(self, id_: int | None, error: PassoError) -> None:
        self._answers.append({"id": id_, "lines": [], "error": fault(error.problems[0])})
        self._news.set()

    # -- to the client ----------------------------------------------------------------------------

    async def _send_all(self) -> None:
        await self._send(self._messages.status(self._sent))
        while True:
            await self._news.wait()
            self._news.clear()
            if not self._site.access.holds(self._caller):
                await self._websocket.close(NOT_ALLOWED)
                return
            await self._send_news()

    async def _send_news(self) -> None:
        if (lost := self._lost) > 0:
            self._lost = 0
            await self._send(text("lost", events=lost))
        if (snapshot := self._feeds.snapshot) is not self._sent:
            changed, self._sent = self._messages.changes(self._sent, snapshot), snapshot
            if changed:
                await self._send(changed)
        while self._waiting:
            one = self._waiting.popleft()
            if isinstance(one, BuildLine):
                await self._send(text("build", number=one.number, state=one.state, line=one.line))
            elif isinstance(one, tuple):
                await self._send(text("line", line=one._asdict()))
            else:
                await self._send(self._messages.event(one))
        while self._answers:
            await self._send(text("answer", **self._answers.popleft()))

    async def _send(self, message: str) -> None:
        """Sends a message. Waits while the client does not read; `web/protocol.py` limits that
        time."""
        await self._websocket.send_text(message)
