"""The WebSockets of one printer, which share one listener of its bridge."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from passo.events import Event
    from passo.web.bridge import Bridge, Snapshot

AT_ONCE = 10  # feeds that are woken before other tasks of the event loop run
RIGHTS_EVERY_S = 5.0  # interval at which an idle feed checks whether its log-in is still valid


class Woken(Protocol):
    """One WebSocket. Its methods return at once."""

    def wake(self) -> None:
        """Called when there is something to send, or when rights may have ended."""
        ...

    def on_event(self, event: Event) -> None:
        """Like `Listener.on_event`; `wake` follows."""
        ...


class Feeds:
    """Wakes the feeds in groups, so that a request waits at most for one group, not for messages to
    hundreds of clients. All feeds send the same `snapshot`, so that each message is made once. Use
    it only in the web's event loop."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self.snapshot = bridge.latest()
        self._feeds: dict[Woken, None] = {}
        self._due: dict[Woken, None] = {}  # in the order of waking
        self._end: Callable[[], None] = lambda: None
        self._rights: asyncio.TimerHandle | None = None

    def join(self, feed: Woken) -> Callable[[], None]:
        """Wakes the feed at each change from now on. Returns a function that ends this."""
        if not self._feeds:
            self.snapshot = self._bridge.latest()
            self._end = self._bridge.listen(self)
            self._look_at_rights()
        self._feeds[feed] = None
        return lambda: self._leave(feed)

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """Like `Listener.on_snapshot`."""
        self.snapshot = snapshot
        self._wake_all()

    def on_event(self, event: Event) -> None:
        """Like `Listener.on_event`."""
        for feed in self._feeds:
            feed.on_event(event)
        self._wake_all()

    def _leave(self, feed: Woken) -> None:
        self._feeds.pop(feed, None)
        self._due.pop(feed, None)
        if not self._feeds:
            self._end()
            if self._rights is not None:
                self._rights.cancel()

    def _look_at_rights(self) -> None:
        loop = asyncio.get_running_loop()
        self._rights = loop.call_later(RIGHTS_EVERY_S, self._look_at_rights)
        self._wake_all()

    def _wake_all(self) -> None:
        """Schedules all feeds; a feed that is scheduled already keeps its place."""
        if not self._due and self._feeds:
            asyncio.get_running_loop().call_soon(self._wake_some)
        self._due.update(self._feeds)

    def _wake_some(self) -> None:
        for feed in list(self._due)[:AT_ONCE]:
            del self._due[feed]
            feed.wake()
        if self._due:
            asyncio.get_running_loop().call_soon(self._wake_some)
