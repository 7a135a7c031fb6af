"""Runs a program through the core's interpreter and keeps all that comes out."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

from passo import config
from passo._core import Fault, Job, JobStatus, Survey


@cache
def spec(machine: str) -> dict[str, Any]:
    """A built-in machine; `unbounded` is the i3 without soft limits."""
    if machine != "unbounded":
        return config.load(machine).core_spec()
    values = config.load("i3").core_spec()
    axes = [axis | {"min": -1e6, "max": 1e6} for axis in values["axes"]]
    return values | {"axes": axes}


@dataclass
class Outcome:
    """Moves as planned; targets without a length are no moves."""

    moves: list[Any] = field(default_factory=list)
    events: list[tuple[int, str, int, int, str, str]] = field(default_factory=list)
    errors: list[tuple[int, Fault, str, float, float]] = field(default_factory=list)
    points: list[tuple[float, float, float]] = field(default_factory=list)  # of the errors
    statistics: dict[str, Any] = field(default_factory=dict)
    clamped: list[Any] = field(default_factory=list)
    ended: bool = False

    @property
    def ends(self) -> list[tuple[float, float, float, float]]:
        """X, Y, Z, E at the end of each move, mm."""
        return [tuple(round(v, 9) for v in move.end_mm[:4]) for move in self.moves]

    @property
    def commands(self) -> list[str]:
        """Events as code and text, such as `M104 S200`."""
        names = [
            name or f"{letter}{n}{f'.{minor}' if minor else ''}"
            for _, letter, n, minor, name, _ in self.events
        ]
        return [f"{n} {e[5]}".strip() for n, e in zip(names, self.events, strict=True)]


def run(
    text: str | bytes | list[bytes],
    machine: Any = "i3",
    chunk: int = 0,
    surveyed: bool = False,
    **policy: bool,
) -> Outcome:
    """All of a program, in these chunks, or in chunks of `chunk` bytes if that is not 0; with its
    sub-programs if it is `surveyed`."""
    data = text.encode() if isinstance(text, str) else text
    job = Job(spec(machine) if isinstance(machine, str) else machine, False, **policy)
    job.results.keep_moves(True)
    out = Outcome()
    ends = ("M2", "M30", "M99") if surveyed else ()
    if surveyed:
        survey = Survey(spec(machine) if isinstance(machine, str) else machine)
        survey.feed(data)
        survey.finish()
        job.program.use_survey(survey)
    if isinstance(data, bytes):
        data = [data[i : i + chunk] for i in range(0, len(data), chunk)] if chunk else [data]
    for piece in data:
        job.feed(piece)
        _drain(job, out, ends)
    job.finish()
    _drain(job, out, ends)
    job.flush()
    out.moves = job.results.take_moves()
    out.statistics = job.results.statistics()
    out.clamped = job.options.clamped
    return out


def _drain(job: Job, out: Outcome, ends: tuple[str, ...]) -> None:
    while not out.ended and (status := job.advance()) not in (JobStatus.END, JobStatus.NEED_INPUT):
        if status == JobStatus.EVENT:
            out.events.append(job.event)
            if out.commands[-1].startswith("G28"):
                job.axes.settle()
            out.ended = out.commands[-1] in ends
            if out.ended:
                return
        elif status == JobStatus.ERROR:
            out.errors.append(job.error[:5])
            out.points.append(job.error[5])
