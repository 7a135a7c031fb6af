"""What a console does again and again."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

LEAST_S = 0.1  # between two of the same: more of it would drown the answers


class Timers:
    """Actions with names, each at its own interval of host time."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._handles: dict[str, asyncio.TimerHandle] = {}
        self._actions: dict[str, tuple[float, Callable[[], None]]] = {}

    def set(self, name: str, seconds: float, action: Callable[[], None] | None) -> None:
        """In place of the action of that name, at least LEAST_S apart; 0 or None: no more."""
        handle = self._handles.pop(name, None)
        if handle is not None:
            handle.cancel()
        self._actions.pop(name, None)
        if seconds > 0 and action is not None:
            seconds = max(seconds, LEAST_S)
            self._actions[name] = (seconds, action)
            self._handles[name] = self._loop.call_later(seconds, self._act, name)

    def restart(self, name: str) -> None:
        """The interval begins anew, if there is an action of that name."""
        if name in self._actions:
            self.set(name, *self._actions[name])

    def runs(self, name: str) -> bool:
        """There is an action of that name."""
        return name in self._actions

    def stop(self) -> None:
        """No action any more."""
        for handle in self._handles.values():
            handle.cancel()
        self._handles.clear()
        self._actions.clear()

    def _act(self, name: str) -> None:
        _, action = self._actions[name]
        self.restart(name)
        action()
