"""Calibration of a thermistor's β against true temperatures: the rule of averages, and a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

from passo.config.thermistor import Ntc

MIN_BETA_K, MAX_BETA_K = 1000.0, 10_000.0
_INVERSE_GOLDEN = (sqrt(5) - 1) / 2


@dataclass(frozen=True, slots=True)
class Point:
    """A temperature that was shown, and the true one that a thermometer said, °C."""

    shown_c: float
    true_c: float


@dataclass(frozen=True, slots=True)
class Calibration:
    """A new β, and what it would have shown at each point beyond the true temperature, °C."""

    beta_k: float
    residuals_c: tuple[float, ...]

    @property
    def rms_c(self) -> float:
        """Root mean square of the residuals."""
        return sqrt(sum(r * r for r in self.residuals_c) / len(self.residuals_c))


def by_averages(ntc: Ntc, points: Sequence[Point]) -> Calibration:
    """The rule as it is taught: β · mean of the shown / mean of the true temperatures.

    It goes too far: it scales in °C, where the thermistor's equation is linear in 1/T.
    """
    ratio = sum(p.shown_c for p in points) / sum(p.true_c for p in points)
    return _with_beta(ntc, points, ntc.beta_k * ratio)


def by_least_squares(ntc: Ntc, points: Sequence[Point]) -> Calibration:
    """The β with the least sum of squares of the residuals, by golden section search (J. Kiefer,
    1953); R25 and C stay as they are."""

    def squares(beta_k: float) -> float:
        return sum(r * r for r in _with_beta(ntc, points, beta_k).residuals_c)

    low, high = MIN_BETA_K, MAX_BETA_K
    while high - low > 1e-3:
        third = _INVERSE_GOLDEN * (high - low)
        if squares(high - third) < squares(low + third):
            high = low + third
        else:
            low = high - third
    return _with_beta(ntc, points, (low + high) / 2)


def _with_beta(ntc: Ntc, points: Sequence[Point], beta_k: float) -> Calibration:
    new = replace(ntc, beta_k=beta_k)
    shown = (new.celsius(ntc.ohm(p.shown_c)) for p in points)
    return Calibration(beta_k, tuple(s - p.true_c for s, p in zip(shown, points, strict=True)))
