"""Calibrates the β of a thermistor against true temperatures: by averages, and by least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log, sqrt

from passo.config.thermistor import ZERO_C, Ntc
from passo.levelling.least_squares import RankError, solve

MIN_BETA_K, MAX_BETA_K = 1000.0, 10_000.0
MAX_C_PER_K = 1e-5
FAR = 1 / 3  # fraction of the reading: no real β has a larger error
_MIN_POINTS = 4  # for three coefficients, so that a residual is left
_INVERSE_GOLDEN = (sqrt(5) - 1) / 2


@dataclass(frozen=True, slots=True)
class Point:
    """A reading of the thermistor, and the true temperature by a thermometer, °C."""

    shown_c: float
    true_c: float


@dataclass(frozen=True, slots=True)
class Calibration:
    """A new β, with the resistance at 25 °C and the coefficient C of the equation, and the error
    that they would have had at each point, °C."""

    beta_k: float
    residuals_c: tuple[float, ...]
    r25_ohm: float
    c_per_k: float

    @property
    def rms_c(self) -> float:
        """Root mean square of the residuals."""
        return sqrt(sum(r * r for r in self.residuals_c) / len(self.residuals_c))


def by_averages(ntc: Ntc, points: Sequence[Point]) -> Calibration:
    """The common rule: β · mean of the readings / mean of the true temperatures. It overcorrects,
    because it scales °C, but the equation of a thermistor is linear in 1/T.
    """
    ratio = sum(p.shown_c for p in points) / sum(p.true_c for p in points)
    return _with_beta(ntc, points, ntc.beta_k * ratio)


def by_least_squares(ntc: Ntc, points: Sequence[Point]) -> Calibration:
    """The β with the minimum sum of squares of the residuals, by golden section search (J. Kiefer,
    1953); R25 and C stay unchanged."""

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


def by_steinhart_hart(ntc: Ntc, points: Sequence[Point]) -> Calibration | None:
    """All three coefficients of 1/T = A + B·ln R + C·(ln R)³ by least squares in kelvin (J. S.
    Steinhart, S. R. Hart, 1968); None with fewer than four points, with points too close to each
    other, or if the result is not an NTC resistor. It is accurate between the points, and less so
    beyond them."""
    if len(points) < _MIN_POINTS:
        return None
    rows: list[tuple[float, float, float]] = []
    for point in points:
        x, kelvin = log(ntc.ohm(point.shown_c)), point.true_c + ZERO_C
        # Weights that turn an error of 1/T into one of T: dT = -T² · d(1/T).
        rows.append((kelvin**2, kelvin**2 * x, kelvin**2 * x**3))
    try:
        a, b, c = solve(rows, [point.true_c + ZERO_C for point in points])
    except RankError:
        return None
    if not (b > 0 and MIN_BETA_K <= 1 / b <= MAX_BETA_K and 0 <= c <= MAX_C_PER_K):
        return None
    # R25 solves A + B·x + C·x³ = 1/298.15 K, which ascends in x = ln R.
    low, high = log(1.0), log(1e8)
    while high - low > 1e-12:
        middle = (low + high) / 2
        if a + b * middle + c * middle**3 < 1 / (25 + ZERO_C):
            low = middle
        else:
            high = middle
    new = Ntc(exp(low), 1 / b, c)
    return Calibration(new.beta_k, _residuals(ntc, new, points), new.r25_ohm, new.c_per_k)


def _with_beta(ntc: Ntc, points: Sequence[Point], beta_k: float) -> Calibration:
    new = replace(ntc, beta_k=beta_k)
    return Calibration(beta_k, _residuals(ntc, new, points), ntc.r25_ohm, ntc.c_per_k)


def _residuals(ntc: Ntc, new: Ntc, points: Sequence[Point]) -> tuple[float, ...]:
    """The errors, °C, that `new` would have at the points, which were read with `ntc`."""
    shown = (new.celsius(ntc.ohm(p.shown_c)) for p in points)
    return tuple(s - p.true_c for s, p in zip(shown, points, strict=True))
