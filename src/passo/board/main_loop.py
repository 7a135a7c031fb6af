"""The load of a board, as its firmware reports it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True, slots=True)
class MainLoop:
    """The passes of a board's main loop that did work in the last 5 s: their total time, their mean
    and their standard deviation, in seconds."""

    awake_s: float
    mean_s: float
    deviation_s: float

    @classmethod
    def of(cls, report: Mapping[str, int | bytes], unit: int, hz: float) -> MainLoop:
        """The load in a report `stats` of a board with the clock frequency `hz`; `unit` is the
        number of ticks² in one unit of the reported sum of squares."""
        count, ticks, squares = (int(report[key]) for key in ("count", "sum", "sumsq"))
        if count <= 0:
            return cls(0.0, 0.0, 0.0)
        spread = max(count * squares * unit - ticks * ticks, 0.0)
        return cls(ticks / hz, ticks / count / hz, sqrt(spread) / count / hz)
