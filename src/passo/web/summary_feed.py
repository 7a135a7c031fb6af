"""A WebSocket that sends the summary of the printer at each change."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING

import msgspec
from anyio import create_task_group
from starlette.websockets import WebSocketDisconnect

from passo.web.deltas import tree
from passo.web.feed import NOT_ALLOWED, viewer_of
from passo.web.summary import is_news

if TYPE_CHECKING:
    from anyio.abc import TaskGroup
    from starlette.websockets import WebSocket

    from passo.events import Event
    from passo.web.feeds import Feeds
    from passo.web.operation import Caller
    from passo.web.site import Site
    from passo.web.summary import Summary

EVERY_S = 2.0  # interval between two messages about progress and temperatures


async def serve_summary_feed(site: Site, feeds: Feeds, websocket: WebSocket) -> None:
    """Serves a client if it has the right to see the printer."""
    if (caller := await viewer_of(site, websocket)) is not None:
        await SummaryFeed(site, feeds, websocket, caller).run()


class SummaryFeed:
    """Sends the whole summary at the start, and then whenever it has changed: at once for news,
    otherwise at most every `EVERY_S`. Nothing is read."""

    def __init__(self, site: Site, feeds: Feeds, websocket: WebSocket, caller: Caller) -> None:
        self._site, self._feeds = site, feeds
        self._websocket, self._caller = websocket, caller
        self._changed = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None

    def wake(self) -> None:
        """Like `Woken.wake`."""
        self._changed.set()

    def on_event(self, event: Event) -> None:
        """Like `Woken.on_event`."""

    async def run(self) -> None:
        """Serves the client until it disconnects or loses the right to see the printer."""
        await self._websocket.accept()
        end = self._feeds.join(self)
        try:
            async with create_task_group() as group:
                group.start_soon(self._wait_for_end, group)
                with suppress(WebSocketDisconnect):  # it may disconnect at any time
                    await self._send_all()
                group.cancel_scope.cancel()
        finally:
            end()
            if self._timer is not None:
                self._timer.cancel()

    async def _wait_for_end(self, group: TaskGroup) -> None:
        while (await self._websocket.receive())["type"] != "websocket.disconnect":
            pass  # it has nothing to say
        group.cancel_scope.cancel()

    async def _send_all(self) -> None:
        loop = asyncio.get_running_loop()
        sent = self._site.summary()
        await self._send(sent)
        next_s = loop.time() + EVERY_S
        while self._site.access.holds(self._caller):
            now = self._site.summary(sent)
            if now != sent and (is_news(sent, now) or loop.time() >= next_s):
                sent, next_s = now, loop.time() + EVERY_S
                await self._send(sent)
            elif now != sent and self._timer is None:
                self._timer = loop.call_at(next_s, self._due)
            await self._changed.wait()
            self._changed.clear()
        await self._websocket.close(NOT_ALLOWED)

    def _due(self) -> None:
        self._timer = None
        self._changed.set()

    async def _send(self, summary: Summary) -> None:
        await self._websocket.send_text(msgspec.json.encode(tree(summary)).decode())
