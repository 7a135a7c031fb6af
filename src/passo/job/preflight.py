"""Scans a whole program before its print: finds its sub-programs, and commands that would spoil the
print."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from passo import _core
from passo.errors import Problem
from passo.gcode.command import Command
from passo.gcode.registry import row_of
from passo.printer.input_errors import call_problem
from passo.printer.unfit_commands import Skips, unfit

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_PIECE = 1 << 18  # bytes
_MAX_TOLD = 20  # problems


class Reader(Protocol):
    """An open file on a card."""

    def read(self, size: int, /) -> bytes:
        """The next bytes; empty at the end."""
        ...

    def seek(self, offset: int, /) -> int:
        """Sets the position of the next read."""
        ...


def survey(machine: MachineConfig, pieces: Iterable[bytes]) -> _core.Survey:
    """Finds the sub-programs and the unusual commands of a program."""
    found = _core.Survey(machine.core_spec())
    for piece in pieces:
        found.feed(piece)
    found.finish()
    return found


async def survey_in_pieces(
    machine: MachineConfig,
    reader: Reader,
    going: Callable[[], bool] = lambda: True,
    rest_s: float = 0.0,
) -> _core.Survey:
    """Like `survey`, for a file on a card, which is read from its beginning while `going` is True;
    other tasks run between two pieces. Raises CardError."""
    found = _core.Survey(machine.core_spec())
    reader.seek(0)
    while going() and (piece := reader.read(_PIECE)):
        found.feed(piece)
        if len(piece) == _PIECE:
            await asyncio.sleep(rest_s)
    found.finish()
    return found


def prepare(job: _core.Job, found: _core.Survey, file: str, skips: Skips) -> list[Problem]:
    """Gives a job the sub-programs of the program that it will read. Returns problems for the
    commands that a print must not skip, in the order of its lines. Empty for a text without any
    known command, which is reported when it is read."""
    job.program.use_survey(found)
    job.options.ignore_calls = skips.unknown
    commands = [Command(*row) for row in found.commands]
    if not found.moves and not any(c.letter == "T" or row_of(c.code) for c in commands):
        return []
    wrong = [unfit(command, skips) for command in commands]
    for line, text, fault in found.bad_calls:
        if not (skips.unknown and fault == _core.CallFault.MISSING):
            wrong.append(call_problem(line, f"M98 {text.strip()}", fault, file))
    problems = [replace(problem, file=file) for problem in wrong if problem is not None]
    return sorted(problems, key=lambda problem: problem.line or 0)[:_MAX_TOLD]
