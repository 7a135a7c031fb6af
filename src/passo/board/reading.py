"""The last reading of a temperature sensor, and its age."""

from __future__ import annotations

from dataclasses import dataclass

STALE_S = 2.0  # a board reports each sensor several times in this time
ABSOLUTE_ZERO_C = -273.15
"""Reported where a number is needed and there is no reading: hosts parse it, and it is clearly not
a temperature."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A temperature, °C, None before the first report. `age_s` is 0 while the board reports;
    otherwise it is the age of the last report in whole seconds, at least 1."""

    celsius: float | None
    age_s: float = 0.0

    @classmethod
    def of(cls, celsius: float, age_s: float, *, lost: bool = False) -> Reading:
        """A reading that was reported so long ago. `lost`: the board cannot report any more."""
        old = lost or age_s > STALE_S
        return cls(celsius, max(1.0, float(int(age_s))) if old else 0.0)

    @property
    def current_c(self) -> float | None:
        """The temperature, unless it is old."""
        return None if self.age_s else self.celsius

    @property
    def number_c(self) -> float:
        """Like `current_c`, but absolute zero in place of None."""
        return ABSOLUTE_ZERO_C if self.current_c is None else self.current_c
