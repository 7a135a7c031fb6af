"""Loops in files: SDCARD_LOOP_BEGIN and SDCARD_LOOP_END, as in Klipper."""

from __future__ import annotations

from typing import NamedTuple

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.printer.skipped_commands import SkippedCommand, SkippedCommands

LOOPS = frozenset({"SDCARD_LOOP_BEGIN", "SDCARD_LOOP_END"})
_MAX_DEPTH = 100


class _Loop(NamedTuple):
    """The rounds that are left (0: for ever), and where the lines of the loop begin."""

    left: int
    offset: int
    line: int


class Place(NamedTuple):
    """Where the reader of a file continues: a byte and its line."""

    offset: int
    line: int


class Loops:
    """The open loops of one file."""

    def __init__(self, omitted: SkippedCommands | None = None) -> None:
        """With `omitted`, which counts it, a loop without an end is read once."""
        self._omitted = omitted
        self._open: list[_Loop] = []
        self.used = False  # the file has repeated lines, so that a line may come twice

    def take(self, command: Command, offset: int, depth: int) -> Place | None:
        """Carries out a command of LOOPS. Returns the place to go back to, if there is one.
        `offset` is that of the next line of the file, `depth` the number of macros and
        sub-programs around the command. Raises CommandError."""
        if depth > 0:
            raise CommandError.of("command.loop-in-macro", axis=command.code)
        if command.code == "SDCARD_LOOP_BEGIN":
            self._begin(command, offset)
            return None
        return self._end()

    def _begin(self, command: Command, offset: int) -> None:
        command.check()
        left = command.integer("COUNT")
        if len(self._open) >= _MAX_DEPTH:
            limit = f"at most {_MAX_DEPTH} loops within each other"
            raise CommandError.of("command.value", axis="COUNT", value=left, limit=limit)
        self.used = True
        if left == 0 and self._omitted is not None:
            self._omitted.count(SkippedCommand.ENDLESS, command.code, command.line)
            left = 1
        self._open.append(_Loop(left, offset, command.line + 1))

    def _end(self) -> Place | None:
        loop = self._open.pop() if self._open else None
        if loop is None or loop.left == 1:
            return None
        self._open.append(loop._replace(left=max(loop.left - 1, 0)))
        return Place(loop.offset, loop.line)

    def desist(self) -> None:
        """SDCARD_LOOP_DESIST: the lines of all open loops are read once more at most."""
        self._open.clear()

    def forget(self) -> None:
        """Call this when the file is read from another place."""
        self._open.clear()
        self.used = False
