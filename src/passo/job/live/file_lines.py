"""The file that a printer prints, as the job reads it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import CardError, CommandError, InputError, PassoError, Problem
from passo.gcode.command import Command
from passo.job.live.line_offsets import line_of_offset
from passo.job.live.reader import Reader
from passo.job.loops import LOOPS, Loops
from passo.job.preflight import prepare, survey_in_pieces

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.unfit_commands import Skips

_log = logging.getLogger(__name__)

_CHUNK = 1 << 14  # bytes read at a time
_AS_IT_IS = "print it as it is (M24 U1)"
_ADVICE = f"Change the file, or {_AS_IT_IS}"


class FileLines:
    """The selected file of one printer, from which its job reads lines. `path` is its path on the
    card, `first_line` the number of the first line that was fed, `reader` reads it: None without a
    file."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self.name = self.path = ""
        self.reader: Reader | None = None
        self.loops = Loops()
        self.first_line = 1
        self._begin = 0  # offset of the first byte that was fed since the restart of the source
        # the job that has the sub-programs of this file
        self._surveyed: tuple[Reader, _core.Job] | None = None

    @property
    def size(self) -> int:
        """The size in bytes."""
        return self.reader.size if self.reader else 0

    @property
    def offset(self) -> int:
        """The number of its bytes that are read and planned."""
        with self._control.dispatch.file_selected() as job:
            return self._begin + job.program.offset

    def select(self, name: str, path: str, reader: Reader | None) -> None:
        """Selects a file, or none, in place of the last one. Call `rewind` before it is read."""
        if self.reader:
            self.reader.close()
        self.name, self.path, self.reader = name, path, reader

    def exchange(self, reader: Reader) -> None:
        """Continues to read the same file with a new reader, after its card was mounted again."""
        assert self.reader is not None
        reader.seek(self.reader.tell())
        self.reader.close()
        if self._surveyed is not None and self._surveyed[0] is self.reader:
            self._surveyed = reader, self._surveyed[1]
        self.reader = reader

    def seek(self, offset: int) -> None:
        """Sets the byte from which to read. Raises CommandError without a file, and CardError."""
        if self.reader is None:
            raise CommandError.of("job.no-file")
        offset = min(max(offset, 0), self.reader.size)
        self.rewind(offset, line_of_offset(self.reader, offset))

    def rewind(self, offset: int = 0, line: int = 1) -> None:
        """Reads from this byte on, which begins this line, with the modes of a new program."""
        with self._control.dispatch.file_selected() as job:
            job.program.restart(line)
        self._begin, self.first_line = offset, line
        self.loops.forget()
        if self.reader:
            self.reader.seek(offset)

    async def look_through(self, skips: Skips, goes_on: Callable[[], bool]) -> None:
        """Scans the file for its sub-programs, while `goes_on`. Raises InputError, before any move,
        for a file that must not be printed."""
        reader, at = self.reader, self.reader.tell() if self.reader else 0
        if reader is None:
            return
        begins, job = self.offset == 0, self._control.rig.job
        if not begins and self._surveyed == (reader, job):
            return  # the print continues after a failed line
        try:
            found = await survey_in_pieces(self._control.machine, reader, goes_on)
        except CardError as error:
            raise CardError(self.placed(error, 1)) from None
        finally:
            if reader is self.reader:
                reader.seek(at)
        if not goes_on():
            return
        self._surveyed = reader, job
        wrong = prepare(job, found, self.name, skips)
        if begins and wrong:
            first, *others = (replace(problem, hint=_advice(problem)) for problem in wrong)
            for problem in others:
                self._control.state.announce(_log, logging.WARNING, str(problem), problem)
            raise InputError([first])

    def feed(self) -> None:
        """Gives the job the next bytes, or the end of the file. Raises CardError."""
        assert self.reader is not None
        job = self._control.rig.job
        try:
            data = self.reader.read(_CHUNK)
        except CardError as error:
            # the error is in the next line
            raise CardError(self.placed(error, job.line + 1)) from None
        if data:
            job.feed(data)
        else:
            job.finish()

    def repeats(self, command: Command) -> bool:
        """Carries out a command of a loop; returns False for any other one. Modes and plan stay.
        Raises CommandError."""
        if command.code not in LOOPS:
            return False
        job = self._control.rig.job
        depth = job.program.macro_depth + job.program.subprogram_depth
        back = self.loops.take(command, self._begin + job.program.offset, depth)
        if back is not None:
            job.program.restart(back.line)
            self._begin = back.offset
            assert self.reader is not None
            self.reader.seek(back.offset)
        return True

    def placed(self, error: PassoError, line: int) -> list[Problem]:
        """The error with the line of the file."""
        return [replace(p, file=self.name, line=line) for p in error.problems]


def _advice(problem: Problem) -> str:
    if problem.code == "input.no-macro":
        return f"{problem.entry.action}, or {_AS_IT_IS}"
    return _ADVICE
