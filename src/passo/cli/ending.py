"""The end of a served printer by a signal."""

from __future__ import annotations

import asyncio


class Ending:
    """Ends the program once, over all its restarts. While the printer closes, a signal is only
    noted: closing switches heaters and laser off, and nothing may cut it short."""

    def __init__(self) -> None:
        self.asked = False
        """Whether the program shall end."""
        self._task: asyncio.Task[object] | None = None

    def begin(self, task: asyncio.Task[object]) -> None:
        """From now on, `task` serves the printer."""
        self._task = task

    def close(self) -> None:
        """From now on, the printer closes, for a restart."""
        self._task = None

    def ask(self) -> None:
        """The program shall end: cancels the task, unless the printer closes already."""
        self.asked = True
        if self._task is not None:
            self._task.cancel()
        self._task = None
