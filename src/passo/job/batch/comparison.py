"""The trials of a laboratory, and which one is best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from math import inf, isinf
from typing import Any, Literal, Self

from passo.job.batch.quality_watch import Measurement, Quality, ShownCorner

Weight = Literal["balance", "ringing", "corners", "lines", "time"]
WEIGHTS: dict[Weight, str] = {
    "balance": "all four alike",
    "ringing": "walls without waves, before all else",
    "corners": "sharp corners, before all else",
    "lines": "lines of even width, before all else",
    "time": "a short print, before all else",
}
"""What a user may want most, in words."""

_HEAVY = 4.0  # the wanted criterion counts as much as this many others
_LONGER = 0.5  # a print that is longer by this fraction costs as much as the worst ringing of all
_SAME_TIME = 0.0005  # prints whose times differ by a smaller fraction take the same time
_MOST_LOST = 0.005  # a trial that is lost for a larger fraction of the time is not judged


@dataclass(frozen=True, slots=True)
class Trial:
    """The result of one setting. The print time excludes heating. `off_tune_rms_um` is the ringing
    if everything vibrates 10 % slower than the shapers expect, as a heavier print does. `lost` is
    the larger one of both prints. `corner` is the same corner in all trials."""

    name: str
    print_time_s: float
    quality: Quality
    off_tune_rms_um: float
    lost: float
    steps: int
    commands: int
    corner: ShownCorner | None = None

    @classmethod
    def of(cls, name: str, on_tune: Measurement, off_tune: Measurement) -> Self:
        """The trial of two prints, or of two measurements of a stream."""
        return cls(
            name,
            on_tune.print_time_s,
            on_tune.quality,
            off_tune.quality.ringing_rms_um,
            max(on_tune.quality.lost, off_tune.quality.lost),
            on_tune.steps,
            on_tune.commands,
            on_tune.corner,
        )

    @property
    def followed(self) -> bool:
        """Whether the motors followed the file, so that the trial can be judged."""
        return self.lost <= _MOST_LOST


@dataclass(slots=True)
class Comparison:
    """The trials of one file on one machine, in their order, and which one is best."""

    file: str
    machine: str
    weight: Weight
    trials: list[Trial] = field(default_factory=list[Trial])
    warnings: list[str] = field(default_factory=list[str])

    def scores(self) -> list[float]:
        """The cost of each trial; the least is best. Ringing (the mean of that on tune and off
        tune), rounding of corners and width error count as fractions of the largest one of all
        trials, and time by how much longer a print is than the shortest one: a print that is 50 %
        longer, or more, counts 1. The wanted criterion counts four times. Infinite for a trial that
        did not follow the file, with which no other is compared either."""
        judged = [trial for trial in self.trials if trial.followed]
        shortest = min((trial.print_time_s for trial in judged), default=1.0) or 1.0
        columns: dict[Weight, list[float]] = {
            "ringing": _relative([t.quality.ringing_rms_um + t.off_tune_rms_um for t in judged]),
            "corners": _relative([t.quality.rounding_um for t in judged]),
            "lines": _relative([t.quality.width_error for t in judged]),
            "time": [min((t.print_time_s / shortest - 1) / _LONGER, 1.0) for t in judged],
        }
        factors = {name: _HEAVY if name == self.weight else 1.0 for name in columns}
        counted = ([factors[n] * value for value in column] for n, column in columns.items())
        scores = (sum(row) / sum(factors.values()) for row in zip(*counted, strict=True))
        return [next(scores) if trial.followed else inf for trial in self.trials]

    @property
    def best(self) -> int:
        """The index of the best trial, the first of equal ones."""
        scores = self.scores()
        return scores.index(min(scores))

    def reason(self) -> str:
        """One sentence: the best setting, and what it changes."""
        first, best = self.trials[0], self.trials[self.best]
        wanted = f"With the weight on {self.weight} ({WEIGHTS[self.weight]}), {best.name} is best:"
        if best is first:
            return f"{wanted} nothing that was tried is better."
        was, now = first.quality, best.quality
        longer = best.print_time_s / first.print_time_s - 1
        lasts = f"{abs(longer):.1%} {'longer' if longer >= 0 else 'less time'}"
        return (
            f"{wanted} {now.ringing_rms_um:.1f} µm of ringing instead of"
            f" {was.ringing_rms_um:.1f} µm, corners rounded by {now.rounding_um:.0f} µm instead of"
            f" {was.rounding_um:.0f} µm, a width error of {now.width_error:.1%} instead of"
            f" {was.width_error:.1%}; the print takes"
            f" {lasts if abs(longer) >= _SAME_TIME else 'the same time'}."
        )

    def as_dict(self) -> dict[str, Any]:
        """All figures, for JSON. A trial without a score did not follow the file."""
        return {
            "file": self.file,
            "machine": self.machine,
            "weight": self.weight,
            "best": self.trials[self.best].name,
            "trials": [
                {
                    "name": trial.name,
                    "print_time_s": trial.print_time_s,
                    **asdict(trial.quality),
                    "off_tune_rms_um": trial.off_tune_rms_um,
                    "lost": trial.lost,
                    "steps": trial.steps,
                    "commands": trial.commands,
                    "score": None if isinf(score) else score,
                }
                for trial, score in zip(self.trials, self.scores(), strict=True)
            ],
            "warnings": self.warnings,
        }


def _relative(values: Sequence[float]) -> list[float]:
    most = max(values, default=0.0)
    return [value / most if most > 0 else 0.0 for value in values]
