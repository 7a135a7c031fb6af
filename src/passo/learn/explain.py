"""What one line of a file becomes: words, planned moves, step times, bytes on the wire."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo import _core
from passo.config.pin_names import MAIN
from passo.errors import InputError, PassoError
from passo.gcode.command import Command
from passo.gcode.registry import row_of
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.job.batch.source import lines, open_source
from passo.learn.corner import corner, path_unit

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_MAX_COMMANDS = 12
_MAX_LINES = 40  # of macros
_BEHIND_S = 1.0  # all commands of a move are done so long after it


class _EnoughError(Exception):
    """All that is to be told of the line has been seen."""


@dataclass(slots=True)
class _Seen:
    """The moves of the line, with the one before and the one after."""

    before: _core.Move | None = None
    moves: list[_core.Move] = field(default_factory=list[_core.Move])
    after: _core.Move | None = None
    calls: list[tuple[Command, str]] = field(default_factory=list[tuple[Command, str]])

    def called(self, command: Command, text: str) -> None:
        """A macro is called, and becomes this text."""
        if not self.after and sum(text.count("\n") for _, text in self.calls) < _MAX_LINES:
            self.calls.append((command, text))

    def take(self, moves: list[_core.Move], line: int, *, jumps: bool) -> None:
        """`jumps`: lines may come again, in sub-programs; then the first time is shown."""
        for move in moves:
            if self.after is not None:
                return
            if move.line == line:
                self.moves.append(move)
            elif self.moves or (move.line > line and not jumps):
                self.after = move
            else:
                self.before = move


def explain(machine: MachineConfig, path: str | os.PathLike[str], line: int, policy: Policy) -> str:
    """Prints the file on the simulated board until one line is done, and tells what became of it.
    What is wrong with a later line ends the print there.

    Raises InputError (no such line, or the file is bad up to it) or MachineError.
    """
    text = _line(path, line)
    try:
        job, seen = _printed(machine, path, line, policy)
    except PassoError as error:
        bad = error.problems[0].line
        if bad is None or bad <= line:
            raise
        job, seen = _printed(machine, path, line, policy, bad)
    parts = [f"{path}:{line}: {text}", _commands(job.job, machine)]
    if seen.calls:
        parts.append(_became(seen.calls))
    if not seen.moves and any(code == "M98" for code, _, _ in job.job.heard[2]):
        parts.append("The lines of the sub-program move; explain one of them.")
        return "\n\n".join(parts)
    if not seen.moves:
        parts.append("This line moves nothing, so there is no plan and no step of its own.")
        return "\n\n".join(parts)
    hz = machine.board.clock_hz
    names = job.job.limit_names
    shown = seen.moves if len(seen.moves) <= 3 else [seen.moves[0], seen.moves[-1]]
    if len(shown) < len(seen.moves):
        parts.append(f"The line became {len(seen.moves)} planned moves; the first and the last:")
    parts += [_move(move, hz, names, path_unit(machine)) for move in shown]
    parts.append(f"Junction before: {corner(seen.before, seen.moves[0], machine)}.")
    parts.append(f"Junction after: {corner(seen.moves[-1], seen.after, machine)}.")
    begin, end = seen.moves[0].start_ticks, seen.moves[-1].end_ticks
    runs = _runs(job, begin, end)
    parts.append(_steps(job, runs, hz))
    told = [run for run in runs if machine.all_boards[run.board].firmware != "passo"]
    if told or not runs:
        parts.append(_wire(told, {c.name: c.board.clock_hz for c in job.connection.connections}))
    if len(told) < len(runs):
        parts.append(
            "What a simulated board with Passo's firmware is sent does not show:"
            ' it does with firmware = "virtual".'
        )
    return "\n\n".join(parts)


def _printed(
    machine: MachineConfig,
    path: str | os.PathLike[str],
    line: int,
    policy: Policy,
    end: int | None = None,
) -> tuple[Print, _Seen]:
    """The print of the file, or of its lines before `end`, and the moves of one line."""
    job = Print(machine, policy)
    seen = _Seen()
    job.job.keep_moves(True)
    job.job.listen(line)

    def look() -> None:
        seen.take(job.job.take_moves(), line, jumps=job.job.calls)
        if not seen.moves:  # what the board has done by now is of other lines
            for stepper in job.connection.board.steppers:
                job.board.take_commands(stepper.name)
        if seen.after is None:
            return
        done = seen.moves[-1].end_ticks if seen.moves else 0.0
        if job.connection.now - job.base > done + _BEHIND_S * machine.board.clock_hz:
            raise _EnoughError

    job.watch(look)
    job.macros.watch = lambda command, text: (
        seen.called(command, text) if command.line == line else None
    )
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


def _became(calls: list[tuple[Command, str]]) -> str:
    """What macros, and those that they call, became: the lines that are not empty."""
    rows: list[str] = []
    for command, text in calls:
        rows.append(f"{command.code} {command.text}".rstrip() + " became:")
        rows += [f"  {line.strip()}" for line in text.splitlines() if line.strip()]
    if len(rows) > _MAX_LINES:
        rows[_MAX_LINES:] = [f"and {len(rows) - _MAX_LINES} more lines"]
    return "\n".join(rows)


def _commands(job: _core.Job, machine: MachineConfig) -> str:
    number, checked, commands = job.heard
    rows: list[str] = []
    if number:
        sum_ = "; its checksum is right" if checked else ""
        rows.append(f"The line has the number {number}, which is skipped{sum_}.")
    if not commands:
        rows.append("There is no command on this line.")
    for code, words, text in commands:
        row = row_of("T" if re.fullmatch(r"T-?\d+", code) else code)
        if code in machine.macros:
            about = machine.macros[code].description
            rows.append(f"{code}: A macro of the machine file{about and ': ' + about}.")
        elif not code:
            rows.append("A move in the way of the last one before, G1 if there was none.")
        elif code == "S":
            rows.append("S: The power of laser or spindle.")
        else:
            rows.append(f"{code}: {row.text if row else 'unknown here, skipped.'}")
        if text and (row is None or row.bare is None or not words):
            rows.append(f"  {text}")
        else:
            rows += [f"  {word}" for word in words]
    return "\n".join(rows)


def _move(move: _core.Move, hz: int, names: list[str], unit: str) -> str:
    if move.kind == "dwell":
        return f"Planned: the machine waits {move.cruise_ticks / hz:.3f} s."
    ends = (move.start_mm, move.end_mm)
    start, end = (", ".join(f"{a} {p[i]:.3f}" for i, a in enumerate("XYZE")) for p in ends)
    slow = move.length - move.accelerate_length - move.cruise_length
    cruises, ramps = move.cruise_length > 1e-9, move.accelerate_length + slow > 1e-9
    shape = "trapezoid" if cruises and ramps else "constant speed" if cruises else "triangle"
    wide = f"  its steps may miss their ideal times by {move.tolerance_ticks / hz * 1e6:.1f} µs"
    return "\n".join(
        (
            f"Planned: a {move.kind} move of {move.length:.3f} {unit}, from {start} to {end}",
            f"  {shape}: starts at {move.start_speed:.2f} {unit}/s, reaches {move.cruise_speed:.2f}"
            f" (at most {move.speed_cap:.2f}), ends at {move.end_speed:.2f}",
            f"  speeds up over {move.accelerate_length:.3f} {unit}"
            f" in {move.accelerate_ticks / hz * 1e3:.2f} ms"
            f", cruises {move.cruise_length:.3f} {unit} in {move.cruise_ticks / hz * 1e3:.2f} ms"
            f", slows down over {slow:.3f} {unit} in {move.decelerate_ticks / hz * 1e3:.2f} ms",
            f"  from {move.start_ticks / hz:.6f} s to {move.end_ticks / hz:.6f} s of print time",
            f"  speed is bound by: {names[move.speed_limit]}"
            f"; acceleration {abs(move.acceleration):.0f} {unit}/s² by: {names[move.accel_limit]}",
            *([wide + ": the board's budget of commands"] if move.tolerance_ticks > 0 else []),
        )
    )


@dataclass(frozen=True, slots=True)
class _Run:
    """A command that a board executed, and the job's clocks of its steps within the moves."""

    stepper: str
    board: str
    clock: int
    text: str
    payload: bytes
    steps: list[int]


def _runs(job: Print, begin: float, end: float) -> list[_Run]:
    """The step commands with steps between two ticks of the job, in the order of their clocks."""
    runs: list[_Run] = []
    for connection in job.connection.connections:
        commands = connection.dictionary.commands
        number = next(i for i, text in commands if text.startswith("queue_step "))
        margin = connection.board.clock_hz // 1000  # 1 ms: more than clocks are known wrong by
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


def _steps(job: Print, runs: list[_Run], hz: int) -> str:
    rows = ["Steps, as the board executed them (print time):"]
    for stepper in job.connection.board.steppers:
        ticks = [tick for run in runs if run.stepper == stepper.name for tick in run.steps]
        rows.append(
            f"  {stepper.name}: {len(ticks)}, the first at {ticks[0] / hz:.6f} s,"
            f" the last at {ticks[-1] / hz:.6f} s"
            if ticks
            else f"  {stepper.name}: none"
        )
    return "\n".join(rows)


def _wire(runs: list[_Run], hz: dict[str, int]) -> str:
    """`hz`: of each board's clock."""
    if not runs:
        return "On the wire: nothing of this line."
    ticks = [f"{1e9 / hz[name]:.1f} ns{f' on {name}' * (name != MAIN)}" for name in hz]
    rows = [
        "On the wire: an interval is the ticks to the first step, `count` the steps, `add` what",
        f"the interval grows by after each; a tick is {', '.join(ticks)}. {len(runs)} commands:",
    ]
    for run in runs[:_MAX_COMMANDS]:
        where = f"{run.board}: " * (run.board != MAIN)
        rows.append(f"  {run.payload.hex(' '):<30} {where}{run.stepper}: {run.text}")
    if len(runs) > _MAX_COMMANDS:
        rows.append(f"  and {len(runs) - _MAX_COMMANDS} more")
    first = runs[0]
    frame = _core.make_frame(first.payload, 1)
    rows.append("A frame with the first of them alone (length, sequence, payload, CRC, 7e):")
    rows.append(f"  {frame.hex(' ')}")
    return "\n".join(rows)
