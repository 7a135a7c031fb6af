"""An input shaper that was fitted to a spectrum."""

from __future__ import annotations

from dataclasses import dataclass

from passo.config.shapers import ShaperType


@dataclass(frozen=True, slots=True)
class Fit:
    """A shaper for a spectrum. `vibrations` is the part of the vibration that remains, 0 to 1;
    `smoothing_mm` is the distance by which it cuts a corner at 5000 mm/s²; the smoothing stays
    below 0.12 mm up to `max_accel_mm_s2`."""

    kind: ShaperType
    frequency_hz: float
    vibrations: float
    smoothing_mm: float
    max_accel_mm_s2: float
    score: float

    @property
    def line(self) -> str:
        """The fit in Klipper's words."""
        return (
            f"Fitted shaper '{self.kind}' frequency = {self.frequency_hz:.1f} Hz (vibrations ="
            f" {self.vibrations * 100:.1f}%, smoothing ~= {self.smoothing_mm:.3f})"
        )
