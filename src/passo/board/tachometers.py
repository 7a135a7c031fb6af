"""The frequencies of the inputs whose changes a board counts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.board.exchange import Values

REPORT = "counter_state"
_WRAP = 1 << 32


@dataclass(frozen=True, slots=True)
class Rate:
    """Changes per second over the time of the last report, which the board has sent at this clock
    of the board."""

    changes_s: float
    clock: int


class Tachometers:
    """The counters of one board, by their object numbers. `rates` has those with two reports."""

    def __init__(self, counters: Mapping[str, int], clock_hz: int) -> None:
        self._names = {oid: name for name, oid in counters.items()}
        self._clock_hz = clock_hz
        self._last: dict[str, tuple[int, int]] = {}  # count and clock of the last change
        self.rates: dict[str, Rate] = {}

    def forget(self) -> None:
        """Call this when the counters have been started again."""
        self._last.clear()
        self.rates.clear()

    def take(self, reports: Iterable[tuple[str, Values]], clock: int) -> None:
        """Takes reports of the board, oldest first; it is `clock` there now."""
        for _, report in reports:
            name = self._names.get(int(report["oid"]))
            if name is None:
                continue
            seen = int(report["count"]), int(report["count_clock"])
            before = self._last.get(name)
            self._last[name] = seen
            if before is not None:
                changes, ticks = ((b - a) % _WRAP for a, b in zip(before, seen, strict=True))
                rate = changes * self._clock_hz / ticks if changes and ticks else 0.0
                self.rates[name] = Rate(rate, clock)
