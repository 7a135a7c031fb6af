"""Restarts the program with the current content of its machine file, for RESTART and the web."""

from __future__ import annotations

from collections.abc import Callable

from passo import config
from passo.errors import CommandError


class ProgramRestart:
    """`source` is the name or the file of the machine. `printed` gives the name of the file that is
    being printed, or an empty text. `end` ends the program, which then starts again."""

    def __init__(self, source: str, printed: Callable[[], str], end: Callable[[], None]) -> None:
        self._source, self._printed, self._end = source, printed, end

    def check(self) -> None:
        """Reads the machine file. Raises ConfigError if it has errors; the printer keeps the old
        one."""
        config.load(self._source)

    def begin(self) -> None:
        """Restarts the program. Call `check` first. Raises CommandError during a print from a
        file."""
        if printed := self._printed():
            raise CommandError.of("job.printing", value=printed)
        self._end()
