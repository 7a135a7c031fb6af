"""Explains one line of a file: words, planned moves, step times, bytes on the link."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import InputError, PassoError
from passo.gcode.command import Command
from passo.gcode.registry import row_of
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.job.batch.source import lines, open_source
from passo.learn.corner import corner, path_unit
from passo.learn.explanation import (
    MAX_MACRO_LINES,
    ExplainedCommand,
    ExplainedMacro,
    ExplainedMove,
    ExplainedSteps,
    Explanation,
    WireCommand,
)
from passo.learn.filter_effects import filter_effects

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_BEHIND_S = 1.0  # this long after a move, all its commands are executed


class _EnoughError(Exception):
    """All data about the line has been collected."""


@dataclass(slots=True)
class _Seen:
    """The moves of the line, the move before, and the move after."""

    before: _core.Move | None = None
    moves: list[_core.Move] = field(default_factory=list[_core.Move])
    after: _core.Move | None = None
    calls: list[tuple[Command, str]] = field(default_factory=list[tuple[Command, str]])

    def called(self, command: Command, text: str) -> None:
        """Call this when a macro call is expanded to `text`."""
        if not self.after and sum(text.count("\n") for _, text in self.calls) < MAX_MACRO_LINES:
            self.calls.append((command, text))

    def take(self, moves: list[_core.Move], line: int, *, jumps: bool) -> None:
        """Takes moves. `jumps`: the file has sub-programs, so that a line may be executed again;
        only the first time is shown."""
        for move in moves:
            if self.after is not None:
                return
            if move.line == line:
                self.moves.append(move)
            elif self.moves or (move.line > line and not jumps):
                self.after = move
            else:
                self.before = move


def explain(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    line: int,
    policy: Policy,
) -> Explanation:
    """Prints the file on the simulated board until one line is done, and explains that line. An
    error in a later line ends the print early. Raises InputError (no such line, or an error in the
    file before it) or MachineError.
    """
    text = _line(path, line)
    try:
        job, seen = _printed(machine, path, line, policy)
    except PassoError as error:
        bad = error.problems[0].line
        if bad is None or bad <= line:
            raise
        job, seen = _printed(machine, path, line, policy, bad)
    number, checked, commands = job.job.program.watched_line
    explanation = Explanation(
        place=f"{path}:{line}",
        line=text,
        number=number,
        checksum=checked,
        commands=tuple(_command(*one, machine) for one in commands),
        macros=tuple(_macro(*call) for call in seen.calls),
        planned=len(seen.moves),
        sub_program=any(code == "M98" for code, _, _ in commands),
    )
    if not seen.moves:
        return explanation
    hz = machine.board.clock_hz
    names, unit = job.job.limits.names, path_unit(machine)
    shown = seen.moves if len(seen.moves) <= 3 else [seen.moves[0], seen.moves[-1]]
    delay = round(job.filters.delay_s * hz)
    runs = _runs(job, seen.moves[0].start_ticks + delay, seen.moves[-1].end_ticks + delay)
    wire = [run for run in runs if machine.all_boards[run.board].firmware != "passo"]
    return replace(
        explanation,
        moves=tuple(_move(move, hz, names, unit) for move in shown),
        junction_before=corner(seen.before, seen.moves[0], machine),
        junction_after=corner(seen.moves[-1], seen.after, machine),
        filters=filter_effects(job.filters, seen.moves),
        steps=tuple(_steps(job, runs, hz)),
        wire=tuple(WireCommand(r.board, r.stepper, r.text, r.payload.hex(" ")) for r in wire),
        frame=_core.make_frame(wire[0].payload, 1).hex(" ") if wire else "",
        tick_ns={c.name: 1e9 / c.board.clock_hz for c in job.connection.connections},
        unseen=len(wire) < len(runs),
    )


def _printed(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    line: int,
    policy: Policy,
    end: int | None = None,
) -> tuple[Print, _Seen]:
    """Prints the file, or its lines before `end`; returns the print and the moves of the line."""
    job = Print(machine, policy)
    seen = _Seen()
    job.job.results.keep_moves(True)
    job.job.program.watch_line(line)

    def look() -> None:
        seen.take(job.job.results.take_moves(), line, jumps=job.job.program.has_calls)
        if not seen.moves:  # the board has not reached the line yet
            for stepper in job.connection.board.steppers:
                job.board.take_commands(stepper.name)
        if seen.after is None:
            return
        done = seen.moves[-1].end_ticks if seen.moves else 0.0
        if job.connection.now - job.base > done + _BEHIND_S * machine.board.clock_hz:
            raise _EnoughError

    job.watch(look)

    def called(command: Command, text: str) -> None:
        if command.line == line:
            seen.called(command, text)

    job.macros.watchers.append(called)
    job.trace_until(1e9)
    with suppress(_EnoughError):
        job.run(path, end)
    return job, seen


def _line(path: str | os.PathLike[str], line: int) -> str:
    number = 0
    with open_source(path) as source:
        if not source.seekable():
            raise InputError.of("input.pipe", str(path))
        for number, raw in enumerate(lines(source), 1):
            if number == line:
                return raw.decode("utf-8", "replace").strip()
    raise InputError.of("input.no-line", str(path), line, value=line, limit=number)


def _macro(command: Command, text: str) -> ExplainedMacro:
    lines = tuple(line.strip() for line in text.splitlines() if line.strip())
    return ExplainedMacro(f"{command.code} {command.text}".rstrip(), lines)


def _command(
    code: str, words: Sequence[str], text: str, machine: MachineConfig
) -> ExplainedCommand:
    row = row_of("T" if re.fullmatch(r"T-?\d+", code) else code)
    if (macro := machine.macro_names.get(code)) is not None:
        about = machine.macros[macro].description
        meaning = f"A macro of the machine file{about and ': ' + about}."
    elif not code:
        meaning = "A move of the same kind as the last one before; G1 if there was none."
    elif code == "S":
        meaning = "The power of laser or spindle."
    else:
        meaning = row.text if row else "unknown here, skipped."
    whole = text and (row is None or row.takes_text or not words)
    return ExplainedCommand(code, meaning, (text,) if whole else tuple(words))


def _move(move: _core.Move, hz: int, names: list[str], unit: str) -> ExplainedMove:
    slow = move.length - move.accelerate_length - move.cruise_length
    cruises, ramps = move.cruise_length > 1e-9, move.accelerate_length + slow > 1e-9
    shape = "trapezoid" if cruises and ramps else "constant speed" if cruises else "triangle"
    return ExplainedMove(
        kind=move.kind,
        unit=unit,
        length=move.length,
        start_mm=tuple(move.start_mm[:4]),
        end_mm=tuple(move.end_mm[:4]),
        shape=shape,
        start_speed=move.start_speed,
        cruise_speed=move.cruise_speed,
        speed_cap=move.speed_cap,
        end_speed=move.end_speed,
        accelerate_length=move.accelerate_length,
        accelerate_s=move.accelerate_ticks / hz,
        cruise_length=move.cruise_length,
        cruise_s=move.cruise_ticks / hz,
        decelerate_length=slow,
        decelerate_s=move.decelerate_ticks / hz,
        start_s=move.start_ticks / hz,
        end_s=move.end_ticks / hz,
        speed_limit=names[move.speed_limit],
        acceleration=move.acceleration,
        accel_limit=names[move.accel_limit],
        tolerance_us=move.tolerance_ticks / hz * 1e6,
    )


@dataclass(frozen=True, slots=True)
class _Run:
    """A command that a board executed, and the clocks, within the job, of its steps during the
    moves."""

    stepper: str
    board: str
    clock: int
    text: str
    payload: bytes
    steps: list[int]


def _runs(job: Print, begin: float, end: float) -> list[_Run]:
    """The step commands that have steps between two clocks of the job, in the order of time."""
    runs: list[_Run] = []
    for connection in job.connection.connections:
        commands = connection.dictionary.commands
        number = next(i for i, text in commands if text.startswith("queue_step "))
        margin = connection.board.clock_hz // 1000  # 1 ms: more than the error of the clocks
        for oid, stepper in enumerate(connection.board.steppers):
            name = stepper.name
            early = job.board.own_clock(name, job.base + int(begin)) - margin
            late = job.board.own_clock(name, job.base + int(end)) + margin
            for start, interval, count, add, _ in job.board.take_commands(name):
                if (
                    start >= late
                    or start + interval * count + add * count * (count - 1) // 2 < early
                ):
                    continue
                own = (start + interval * (k + 1) + add * k * (k + 1) // 2 for k in range(count))
                clocks = (job.board.main_clock(name, clock) - job.base for clock in own)
                inside = [clock for clock in clocks if begin <= clock < end]
                if not inside:
                    continue
                values = (number, oid, interval, count, add)
                payload = b"".join(_core.encode_vlq(value) for value in values)
                text = f"queue_step oid={oid} interval={interval} count={count} add={add}"
                clock = job.board.main_clock(name, start) - job.base
                runs.append(_Run(name, connection.name, clock, text, payload, inside))
    return sorted(runs, key=lambda run: run.clock)


def _steps(job: Print, runs: list[_Run], hz: int) -> Iterator[ExplainedSteps]:
    for stepper in job.connection.board.steppers:
        ticks = [tick for run in runs if run.stepper == stepper.name for tick in run.steps]
        first, last = (ticks[0] / hz, ticks[-1] / hz) if ticks else (None, None)
        yield ExplainedSteps(stepper.name, len(ticks), first, last)
