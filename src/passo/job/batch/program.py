"""Feeds a program to a job without consoles."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import islice
from math import inf
from typing import BinaryIO

from passo import _core
from passo.errors import CommandError, InputError, MachineError, Problem, WordError
from passo.gcode.command import Command
from passo.job.batch.source import chunks, lines, open_source
from passo.job.loops import LOOPS, Loops
from passo.job.preflight import prepare, survey
from passo.printer.commands.program import Commands
from passo.printer.macros import EmergencyStop
from passo.printer.planned_status import PlannedFile
from passo.printer.skipped_commands import SkippedCommand
from passo.printer.unfit_commands import ALL, ALLOWED_BY, Skips, unfit
from passo.printer.wait_requests import (
    Stop,
    Wait,
    WaitForHoming,
    WaitForMoves,
    WaitForReading,
    WaitForTemperatures,
)

_log = logging.getLogger(__name__)

_MAX_MESSAGES = 1 << 15
_STARTED_S = 60.0  # a print starts at least this long after its printer
_OPTIONS = {  # options of the command line, by the field of Skips
    "clamp": "--out-of-range clamp",
    "ignore_tools": "--missing-tool ignore",
    "unknown": "--unknown skip",
    "levelling": "--levelling skip",
}
_HINTS = {code: _OPTIONS[field] for code, field in ALLOWED_BY.items()} | {
    "input.not-homed": "it for a piece of G-code by --assume-ready",
    "input.cold": "it for a piece of G-code by --assume-ready",
    "input.no-macro": "it to be left out by --unknown skip",
    "input.call": "it to be left out, if the sub-program is missing, by --unknown skip",
}

Settle = Callable[[Wait], None]


class _Text:
    """The pieces of an open file, for a job that reads them. Its loops go back in it."""

    def __init__(self, job: _core.Job, commands: Commands, source: BinaryIO, name: str) -> None:
        self._job = job
        self._source, self._name = source, name
        self._pieces = chunks(source, name)
        self._begin = 0  # of the text that the job reads
        self._loops = Loops(commands.omitted)

    def __iter__(self) -> Iterator[bytes]:
        return self

    def __next__(self) -> bytes:
        return next(self._pieces)

    @property
    def offset(self) -> int:
        """The byte of the next line."""
        return self._begin + self._job.program.offset

    def repeats(self, command: Command) -> bool:
        """Carries out a command of a loop; returns False for any other one. Raises
        CommandError."""
        if command.code not in LOOPS:
            return False
        depth = self._job.program.macro_depth + self._job.program.subprogram_depth
        back = self._loops.take(command, self.offset, depth)
        if back is not None:
            self._job.program.restart(back.line)
            self._begin = back.offset
            self._source.seek(back.offset)
            self._pieces = chunks(self._source, self._name)
        return True


def _repeats_nothing(command: Command) -> bool:
    """For a text that cannot be read again."""
    del command
    return False


def at_rest(job: _core.Job) -> Settle:
    """Ends the waits of a plan without temperatures. Homing sets positions; all other waits only
    stop the machine."""

    def settle(wait: Wait) -> None:
        if isinstance(wait, WaitForHoming):
            job.axes.settle()
        else:
            job.flush()
        if isinstance(wait, WaitForMoves) and wait.then is not None:
            wait.then()

    return settle


def heated(job: _core.Job, wait_for: Callable[[list[str]], None]) -> Settle:
    """Like `at_rest`, but waits for temperatures."""
    rest = at_rest(job)

    def settle(wait: Wait) -> None:
        if isinstance(wait, WaitForTemperatures):
            wait_for(list(wait.heaters))
        elif isinstance(wait, WaitForReading) and wait.heats:
            wait_for([wait.name])
        else:
            rest(wait)

    return settle


def refuse_stop(wait: Wait, file: str) -> None:
    """Raises MachineError for a command of `file` that stops the machine."""
    if isinstance(wait, Stop):
        raise MachineError([wait.problem(file)])


def read_program(
    job: _core.Job,
    commands: Commands,
    pieces: Iterable[bytes],
    name: str,
    settle: Settle,
    skips: Skips = ALL,
    unsurveyed: Skips = ALL,
    horizon: Callable[[], float] = lambda: inf,
    repeats: Callable[[Command], bool] = _repeats_nothing,
) -> Iterator[None]:
    """Feeds all pieces to the job, and executes its commands. It yields when the job has made
    progress, when the plan has reached the clock of `horizon`, or when its message queue is full;
    then the caller must take the messages. At the last yield, the job is flushed. Refused commands
    become warnings if `commands` allows it. Raises InputError with `name` as the file for a refused
    command otherwise, and for words without a number. `skips` are the commands that lines may skip;
    `unsurveyed` those of lines of macros, which the survey does not read. `repeats` carries out the
    commands of loops.
    """
    source = iter(pieces)
    for found in _executed(job, commands, name, settle, skips, unsurveyed, horizon, repeats):
        if found == _core.JobStatus.NEED_INPUT:
            data = next(source, b"")
            if data:
                job.feed(data)
            else:
                job.finish()
        elif found == _core.JobStatus.END:
            break
        yield
    job.flush()
    yield


def _executed(
    job: _core.Job,
    commands: Commands,
    name: str,
    settle: Settle,
    skips: Skips,
    unsurveyed: Skips,
    horizon: Callable[[], float] = lambda: inf,
    repeats: Callable[[Command], bool] = _repeats_nothing,
) -> Iterator[_core.JobStatus]:
    """Executes the commands of the lines that the job has; yields as `read_program`, with the
    status of the job, also when the job needs more lines. Raises as `read_program`."""
    status = _core.JobStatus
    while not commands.ended:
        found = job.advance(horizon(), _MAX_MESSAGES)
        if found == status.MACRO:
            _expand(job, commands, name, settle)
        elif found == status.EVENT:
            command = Command(*job.event)
            if problem := unfit(command, unsurveyed if job.program.macro_depth else skips):
                raise InputError([with_option(replace(problem, file=name))])
            try:
                if repeats(command):
                    continue
                wait = commands.run(command)
            except WordError as error:
                problems = [replace(p, file=name, line=command.line) for p in error.problems]
                raise InputError(problems) from None
            except CommandError as error:
                commands.refuse(command, error, name)
                continue
            if wait is not None:
                _end(wait, command, commands, settle, name)
        elif found == status.ERROR:
            raise InputError([with_option(commands.problem(name))])
        else:
            yield found


def start_up(
    job: _core.Job, commands: Commands, settle: Settle, skips: Skips, unsurveyed: Skips
) -> Iterator[None]:
    """Executes the delayed G-code that a printer has carried out soon after its start, before a
    program: macros often keep their settings there. Yields as `read_program`. As on the printer,
    an error ends only this G-code, and is a warning."""
    soon = [
        (delayed.initial_duration_s, name)
        for name, delayed in commands.machine.delayed_gcode.items()
        if 0 < delayed.initial_duration_s <= _STARTED_S
    ]
    for _, name in sorted(soon):
        job.program.select(True)  # as a console: the modes of the file are its own
        try:
            key, gcode = f"delayed_gcode.{name}", commands.machine.delayed_gcode[name].gcode
            text = commands.macros.rendered(key, gcode, commands.status(), _log.info)
            job.program.insert(text.encode("utf-8", "surrogateescape"))
            for found in _executed(job, commands, "", settle, skips, unsurveyed):
                if found == _core.JobStatus.NEED_INPUT:
                    break
                yield
        except (CommandError, InputError) as error:
            job.abandon()
            job.program.forget_macros()
            what = f"delayed_gcode.{name}: {error}"
            commands.omitted.count(SkippedCommand.REFUSED, what, job.line)
    job.program.select(False)


def _end(wait: Wait, command: Command, commands: Commands, settle: Settle, name: str) -> None:
    """Raises InputError with `name` as the file if an action after the wait is refused."""
    try:
        settle(wait)
        commands.settled(wait)
    except CommandError as error:
        commands.refuse(command, error, name)


def _expand(job: _core.Job, commands: Commands, name: str, settle: Settle) -> None:
    """Expands a macro call to its lines. Raises InputError with `name` as the file."""
    command = Command(*job.event)
    try:
        commands.expand(command, lambda text: _log.info("%s", text))
    except CommandError as error:
        problems = [replace(p, file=name, line=command.line) for p in error.problems]
        raise InputError(problems) from None
    except EmergencyStop as stop:
        _log.error("macro %s: %s", command.code, stop)
        cause = Problem("macro.raised", values={"axis": command.code, "value": str(stop)})
        settle(Stop("M112", command.line, cause))


def with_option(problem: Problem) -> Problem:
    """The problem, with a hint to the command-line option that allows it."""
    option = _HINTS.get(problem.code)
    advice = f"{problem.entry.action}, or allow {option}"
    return replace(problem, hint=advice) if option else problem


def run_program(
    job: _core.Job,
    commands: Commands,
    path: str | os.PathLike[str],
    settle: Settle | None = None,
    skips: Skips = ALL,
    end: int | None = None,
) -> Iterator[float]:
    """Like `read_program`, for a file, or for its lines before number `end`; yields the fraction of
    the file that is read. `skips` are the commands that it may skip. Without `settle` it waits for
    nothing. Raises InputError before the first line for commands that must not be skipped (unless
    the file is a pipe), and at the end for a text without any known command."""
    with open_source(path) as source:
        size = os.fstat(source.fileno()).st_size
        yield from run_open_program(job, commands, source, size, str(path), settle, skips, end)


def run_open_program(
    job: _core.Job,
    commands: Commands,
    source: BinaryIO,
    size: int,
    name: str,
    settle: Settle | None = None,
    skips: Skips = ALL,
    end: int | None = None,
    horizon: Callable[[], float] = lambda: inf,
) -> Iterator[float]:
    """Like `run_program`, for an open file of `size` bytes, which is at its beginning."""
    read = skips
    commands.file = PlannedFile(name, size)
    if source.seekable():
        found = survey(commands.machine, chunks(source, name))
        source.seek(0)
        if wrong := prepare(job, found, name, skips):
            raise InputError([with_option(problem) for problem in wrong])
        read = ALL
    text = _Text(job, commands, source, name)
    pieces = text if end is None else islice(lines(source), end - 1)
    repeats = text.repeats if end is None and source.seekable() else _repeats_nothing
    settle = settle or at_rest(job)
    for _ in start_up(job, commands, settle, read, skips):
        yield 0.0
    for _ in read_program(job, commands, pieces, name, settle, read, skips, horizon, repeats):
        yield min(text.offset / size, 1.0) if size else 0.0
    if end is not None:
        return
    if job.program.ends_in_move:
        commands.omitted.cut_at = job.line
    if job.program.commands == commands.omitted.times(SkippedCommand.UNKNOWN):
        raise InputError.of(
            "input.no-known-command" if job.program.commands else "input.empty", name
        )
