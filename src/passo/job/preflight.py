"""A look through a whole program before it begins: what would spoil the print is said first."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import InputError, Problem
from passo.gcode.command import Command
from passo.gcode.dialect import row_of
from passo.job.batch.program import with_option
from passo.job.batch.source import chunks, open_source
from passo.printer.unfit_commands import Skips, unfit

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_MOST_TOLD = 20  # problems


def survey(machine: MachineConfig, pieces: Iterable[bytes]) -> _core.Survey:
    """The commands of a program."""
    found = _core.Survey(machine.core_spec())
    for piece in pieces:
        found.feed(piece)
    found.finish()
    return found


def problems(found: _core.Survey, file: str, skips: Skips) -> list[Problem]:
    """What a print of this program must not leave out, in the order of its lines. Nothing for a
    text without any command that is known: reading it says so."""
    commands = [Command(*row) for row in found.commands]
    if not found.moves and not any(c.letter == "T" or row_of(c.code) for c in commands):
        return []
    wrong = (unfit(command, skips) for command in commands)
    return [replace(problem, file=file) for problem in wrong if problem is not None][:_MOST_TOLD]


def require(machine: MachineConfig, path: str | os.PathLike[str], skips: Skips) -> bool:
    """Looks through a file; False for a pipe, which can be read only once. Raises InputError with
    all `problems`."""
    name = str(path)
    with open_source(path) as source:
        if not source.seekable():
            return False
        found = survey(machine, chunks(source, name))
    if wrong := problems(found, name, skips):
        raise InputError([with_option(problem) for problem in wrong])
    return True
