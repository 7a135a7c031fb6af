"""Starts the program again with its machine file as it is then, for RESTART and the web."""

from __future__ import annotations

from collections.abc import Callable

from passo import config
from passo.errors import CommandError


class ProgramRestart:
    """`source` is what the machine was loaded from; `printed` is the name of the file that is
    printed, or empty; `end` ends the program, which starts again then."""

    def __init__(self, source: str, printed: Callable[[], str], end: Callable[[], None]) -> None:
        self._source, self._printed, self._end = source, printed, end

    def check(self) -> None:
        """Reads the machine file. Raises ConfigError: the printer goes on with the old one."""
        config.load(self._source)

    def begin(self) -> None:
        """Restarts, once the file was checked. Raises CommandError while a file is printed."""
        if printed := self._printed():
            raise CommandError.of("job.printing", value=printed)
        self._end()
