"""What a printer calls as time passes, and when it is closed."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack


class Lifetime:
    """The calls of one printer as time passes, and at its end."""

    def __init__(self) -> None:
        self._watchers: list[Callable[[], None]] = []
        self._closers = ExitStack()

    def as_time_passes(self, *calls: Callable[[], None]) -> None:
        """Calls each of these often, as print time passes."""
        self._watchers += calls

    def at_end(self, call: Callable[[], None]) -> None:
        """Calls `call` once when the printer is closed; the last one is called first."""
        self._closers.callback(call)

    def pass_time(self) -> None:
        """Makes the calls of `as_time_passes`."""
        for watcher in self._watchers:
            watcher()

    def end(self) -> None:
        """Makes the calls of `at_end`, even if one fails."""
        self._closers.close()
