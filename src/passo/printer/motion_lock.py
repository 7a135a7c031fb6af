"""Whose turn it is to move the machine: one at a time, in the order of asking."""

from __future__ import annotations

import asyncio
from collections import deque


class Turn:
    """A fair lock. Taking it is free of tasks and delays while nobody holds it."""

    def __init__(self) -> None:
        self._taken = False
        self._asked: deque[asyncio.Future[None]] = deque()

    @property
    def taken(self) -> bool:
        """Somebody has the turn."""
        return self._taken

    def take(self) -> bool:
        """Takes the turn if nobody has it or has asked before."""
        if self._taken or self._asked:
            return False
        self._taken = True
        return True

    async def wait(self) -> None:
        """Takes the turn when all who asked before have had it."""
        if self.take():
            return
        asked: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._asked.append(asked)
        try:
            await asked
        except asyncio.CancelledError:
            if asked in self._asked:
                self._asked.remove(asked)
            elif asked.done() and not asked.cancelled():
                self.give()  # it was handed over in the same moment
            raise

    def give(self) -> None:
        """Hands the turn to who has asked first."""
        while self._asked:
            asked = self._asked.popleft()
            if not asked.done():
                asked.set_result(None)
                return
        self._taken = False
