"""Bed screws: what to turn, in turns of a clock: 00:15 is a quarter of a turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from passo.config.calibration import Thread

PITCH_MM = {"M3": 0.5, "M4": 0.7, "M5": 0.8, "M6": 1.0}
EXACT_MM = 0.001
"""A screw that is off by less stays as it is."""


@dataclass(frozen=True, slots=True)
class Screw:
    """What one screw needs. `mm`: how much higher the first screw is than this one; `clockwise`:
    to bring the bed to the height of the first screw."""

    name: str
    mm: float
    clockwise: bool
    turns: int
    minutes: int

    @property
    def adjust(self) -> str:
        """As Klipper has it: CW 00:15."""
        return f"{'CW' if self.clockwise else 'CCW'} {self.turns:02d}:{self.minutes:02d}"


def adjustments(heights: Sequence[tuple[str, float]], thread: Thread) -> list[Screw]:
    """Name and height of the bed at each screw, mm; the first is the one that stays. `cw` threads
    lift the bed where they are turned clockwise."""
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
