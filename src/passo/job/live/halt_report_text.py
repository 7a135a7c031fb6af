"""The report of a halt as text, which a user can attach to a question."""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from passo.board.recorded_frames import RecordedFrames
from passo.errors import Problem
from passo.printer.console_lines import ConsoleLine
from passo.printer.watch.heater_history import HeaterSample
from passo.version import __version__

MAX_COMMANDS = 50  # console lines
_MAX_SETTINGS = 500  # lines
_MAX_MACHINE = 200_000  # characters
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # terminal control characters, C0 and C1


class JobMoment(NamedTuple):
    """The print at the halt. `line` is the line of the current move, 0 if there is none; `offset`
    and `size` are bytes of the file, read and in total; `printed_s` is print time without
    pauses."""

    state: str
    file: str
    line: int
    offset: int
    size: int
    printed_s: float


@dataclass(frozen=True, slots=True)
class HaltReport:
    """The data of a report. `when` is the time of day, `host_s` and `print_s` are the host time and
    the print time of the halt."""

    when: str
    host_s: float
    print_s: float
    why: str
    problems: Sequence[Problem]
    trace: str
    printer: str
    job: JobMoment
    console_lines: Sequence[ConsoleLine]
    heaters: Sequence[tuple[float, dict[str, HeaterSample]]]
    frames: Sequence[RecordedFrames]
    settings: Sequence[str]
    machine: str

    def text(self) -> str:
        """The report, with one section for each subject. Times are in seconds relative to the
        halt."""
        sections: list[tuple[str, Iterable[str]]] = [
            ("Cause", self._cause()),
            ("Print", self._print()),
            ("Last lines of the consoles", self._console()),
            ("Heaters: °C / target °C / power", self._heaters()),
            *((f"Frames of board {f.name or 'main'}", self._frames(f)) for f in self.frames),
            ("Settings (M503)", self.settings[:_MAX_SETTINGS]),
            ("Machine: values that are not defaults, without secrets", [self._machine()]),
        ]
        lines = [
            f"Passo {__version__}: report of a halt",
            f"{self.when}, print time {self.print_s:.3f} s, printer {self.printer}",
            f"Python {platform.python_version()}, {platform.system()} {platform.machine()}",
            "Times below are seconds relative to the halt.",
        ]
        for title, content in sections:
            lines += ["", f"== {title} ==", *content]
        return _CONTROL.sub(lambda c: f"\\x{ord(c[0]):02x}", "\n".join(lines)) + "\n"

    def _cause(self) -> Iterator[str]:
        yield self.why
        for problem in self.problems:
            entry = problem.entry
            yield ""
            yield f"code:   {problem.code}"
            yield f"part:   {entry.part}"
            yield f"what:   {problem.sentence}"
            if problem.place:
                yield f"where:  {problem.place}"
            yield f"action: {problem.advice}"
        if self.trace:
            yield ""
            yield self.trace.rstrip("\n")

    def _print(self) -> Iterator[str]:
        job = self.job
        if not job.file:
            yield "no file is selected"
            return
        yield f"file:   {job.file}"
        yield f"state:  {job.state}"
        yield f"line:   {job.line or '-'}, of the move under way"
        yield f"read:   {job.offset} of {job.size} bytes"
        yield f"time:   {job.printed_s:.3f} s, without pauses"

    def _console(self) -> Iterator[str]:
        for line in self.console_lines[-MAX_COMMANDS:]:
            seconds = line.host_s - self.host_s
            console = line.console or "all"
            yield f"{seconds:+10.3f} {console:>3} {'>' if line.received else '<'} {line.text}"

    def _heaters(self) -> Iterator[str]:
        names = list(self.heaters[-1][1]) if self.heaters else []
        yield " " * 10 + "".join(f" {name:>24}" for name in names)
        for print_s, samples in self.heaters:
            shown = (_sample(samples[name]) if name in samples else "" for name in names)
            yield f"{print_s - self.print_s:+10.3f}" + "".join(f" {text:>24}" for text in shown)

    def _frames(self, frames: RecordedFrames) -> Iterator[str]:
        yield f"firmware {frames.dictionary.version or 'unknown'}"
        yield f"clock {frames.board.clock_hz} Hz"
        yield "         s from   board clock  message"
        yield from frames.lines()

    def _machine(self) -> str:
        whole = len(self.machine) <= _MAX_MACHINE
        return self.machine.rstrip("\n") if whole else f"{self.machine[:_MAX_MACHINE]}\n(cut)"


def _sample(heater: HeaterSample) -> str:
    celsius = "-" if heater.celsius is None else f"{heater.celsius:.1f}"
    failed = " failed" if heater.failed else ""
    return f"{celsius} / {heater.target_c:.1f} / {heater.power:.2f}{failed}"
