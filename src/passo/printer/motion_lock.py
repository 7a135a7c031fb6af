"""The lock for moving the machine: one holder at a time, in the order of requests."""

from __future__ import annotations

import asyncio
from collections import deque


class MotionLock:
    """A fair lock. Acquiring it takes neither a task nor a delay while it is free."""

    def __init__(self) -> None:
        self._locked = False
        self._waiting: deque[asyncio.Future[None]] = deque()

    @property
    def locked(self) -> bool:
        """Whether a caller has the lock."""
        return self._locked

    def try_acquire(self) -> bool:
        """Acquires the lock if it is free and no other caller waits for it; returns whether it
        did."""
        if self._locked or self._waiting:
            return False
        self._locked = True
        return True

    async def acquire(self) -> None:
        """Waits until all callers that asked before have released the lock, and acquires it."""
        if self.try_acquire():
            return
        waiting: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append(waiting)
        try:
            await waiting
        except asyncio.CancelledError:
            if waiting in self._waiting:
                self._waiting.remove(waiting)
            elif waiting.done() and not waiting.cancelled():
                self.release()  # the lock was handed over just before the cancellation
            raise

    def release(self) -> None:
        """Hands the lock to the caller that has waited longest, or frees it."""
        while self._waiting:
            waiting = self._waiting.popleft()
            if not waiting.done():
                waiting.set_result(None)
                return
        self._locked = False
