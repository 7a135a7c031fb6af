"""One WebSocket: the status as it changes, and each event. A slow client misses states."""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING

import msgspec
from anyio import Event as Signal
from anyio import create_task_group, fail_after
from starlette.websockets import WebSocketDisconnect

from passo.web.deltas import Tree, changes, tree

if TYPE_CHECKING:
    from anyio.abc import TaskGroup
    from starlette.websockets import WebSocket

    from passo.events import Event
    from passo.web.bridge import Bridge, Snapshot

_MAX_EVENTS = 1000  # that wait for a slow client
_TIMEOUT_S = 5.0  # with a client that does not read
_TOO_SLOW = 1013  # "try again later" (IANA, WebSocket close codes)


class Feed:
    """Messages are JSON objects with a `type`: `status` is the whole status, and first; `changes`
    what has changed since the last one that was sent, as a merge patch; `event` something that has
    happened; `lost` tells how many events were dropped."""

    def __init__(self, bridge: Bridge, websocket: WebSocket) -> None:
        self._bridge, self._websocket = bridge, websocket
        self._snapshot: Snapshot | None = None  # newer than the one that was sent
        self._events: deque[Event] = deque()
        self._lost = 0
        self._sent: Tree = {}
        self._news = Signal()

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """As `Listener.on_snapshot`."""
        self._snapshot = snapshot
        self._news.set()

    def on_event(self, event: Event) -> None:
        """As `Listener.on_event`."""
        if len(self._events) == _MAX_EVENTS:
            self._events.popleft()
            self._lost += 1
        self._events.append(event)
        self._news.set()

    async def run(self) -> None:
        """Serves the client until it leaves, or does not read."""
        await self._websocket.accept()
        end = self._bridge.listen(self)
        try:
            async with create_task_group() as group:
                group.start_soon(self._leave, group)
                await self._send_all()
        finally:
            end()

    async def _leave(self, group: TaskGroup) -> None:
        """Ends all when the client has left."""
        with suppress(WebSocketDisconnect, KeyError):
            while True:
                await self._websocket.receive_text()  # a client has nothing to say here
        group.cancel_scope.cancel()

    async def _send_all(self) -> None:
        snapshot = self._bridge.latest()
        self._sent = tree(snapshot.status)
        try:
            await self._send("status", version=snapshot.version, status=self._sent)
            while True:
                await self._news.wait()
                self._news = Signal()
                await self._send_news()
        except TimeoutError:
            await self._websocket.close(_TOO_SLOW)

    async def _send_news(self) -> None:
        if (lost := self._lost) > 0:
            self._lost = 0
            await self._send("lost", events=lost)
        snapshot, self._snapshot = self._snapshot, None
        if snapshot is not None:
            now = tree(snapshot.status)
            changed, self._sent = changes(self._sent, now), now
            if changed:
                await self._send("changes", version=snapshot.version, changes=changed)
        while self._events:
            event = self._events.popleft()
            await self._send("event", event={"kind": type(event).__name__, **tree(event)})

    async def _send(self, kind: str, **fields: object) -> None:
        text = msgspec.json.encode({"type": kind, **fields}).decode()
        with fail_after(_TIMEOUT_S):
            await self._websocket.send_text(text)
