"""Makes the messages of the feed as text, once for all clients."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING

import msgspec

from passo.web.deltas import Tree, changes, tree

if TYPE_CHECKING:
    from passo.events import Event
    from passo.web.bridge import Snapshot

_KEPT = 8  # cached states and differences; for slower clients they are computed again


class Messages:
    """The texts for the clients of one printer. Use it only in the web's event loop."""

    def __init__(self) -> None:
        self._trees: OrderedDict[int, Tree] = OrderedDict()
        self._changes: OrderedDict[tuple[int, int], str] = OrderedDict()
        self._event: Event | None = None
        self._event_text = ""

    def status(self, snapshot: Snapshot) -> str:
        """The whole status."""
        return text("status", version=snapshot.version, status=self._tree(snapshot))

    def changes(self, before: Snapshot, now: Snapshot) -> str:
        """The changes between two snapshots; empty if there are none."""
        key = before.version, now.version
        if key not in self._changes:
            changed = changes(self._tree(before), self._tree(now))
            known = text("changes", version=now.version, changes=changed) if changed else ""
            self._changes[key] = known
            if len(self._changes) > _KEPT:
                self._changes.popitem(last=False)
        return self._changes[key]

    def event(self, event: Event) -> str:
        """An event."""
        if event is not self._event:
            self._event = event
            self._event_text = text("event", event={"kind": type(event).__name__, **tree(event)})
        return self._event_text

    def _tree(self, snapshot: Snapshot) -> Tree:
        if snapshot.version not in self._trees:
            self._trees[snapshot.version] = tree(snapshot.status)
            if len(self._trees) > _KEPT:
                self._trees.popitem(last=False)
        return self._trees[snapshot.version]


def text(kind: str, **fields: object) -> str:
    """The text of a message of this type."""
    return msgspec.json.encode({"type": kind, **fields}).decode()
