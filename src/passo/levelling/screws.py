"""Bed screws: how far to turn each one, as hours and minutes of a clock: 00:15 is a quarter of a
turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from passo.config.calibration import Thread

PITCH_MM = {"M3": 0.5, "M4": 0.7, "M5": 0.8, "M6": 1.0}
EXACT_MM = 0.001
"""A screw with a smaller error, in mm, needs no turn."""


@dataclass(frozen=True, slots=True)
class Screw:
    """The adjustment of one screw. `mm` is the height of the bed at the first screw minus the
    height at this one. `clockwise` is the direction that brings the bed to the height of the first
    screw."""

    name: str
    mm: float
    clockwise: bool
    turns: int
    minutes: int

    @property
    def adjust(self) -> str:
        """The adjustment in Klipper's format: CW 00:15."""
        return f"{'CW' if self.clockwise else 'CCW'} {self.turns:02d}:{self.minutes:02d}"


def adjustments(heights: Sequence[tuple[str, float]], thread: Thread) -> list[Screw]:
    """Computes the adjustments from the name of each screw and the height of the bed there, mm. The
    first screw stays. A thread `cw…` lifts the bed when it is turned clockwise."""
    size, direction = thread.split()
    base = heights[0][1]
    found: list[Screw] = []
    for name, z in heights:
        mm = base - z
        exact = abs(mm) < EXACT_MM
        minutes = 0 if exact else round(60 * abs(mm) / PITCH_MM[size])
        clockwise = (mm >= 0 or exact) == (direction == "cw")
        found.append(Screw(name, mm, clockwise, *divmod(minutes, 60)))
    return found
