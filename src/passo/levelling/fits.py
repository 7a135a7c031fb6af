"""Fits planes and quadrics to probed heights, as in APrinter's bed correction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import atan2, cos, hypot, isfinite, sin, sqrt
from typing import Literal

from passo.config.probing import MIN_DISTANCE_MM, UNKNOWNS
from passo.errors import CommandError
from passo.levelling.least_squares import RankError, solve

Method = Literal["linear", "quadratic"]
Point = tuple[float, float, float]
"""X, Y and the height of the bed there, mm."""


@dataclass(frozen=True, slots=True)
class Fit:
    """c(x, y) = c0 + cx x + cy y + cxx x² + cxy x y + cyy y², in mm; the squares are 0 in a linear
    fit. `residual_rms` is the RMS deviation of the points from the last fit, mm."""

    c0: float = 0.0
    cx: float = 0.0
    cy: float = 0.0
    cxx: float = 0.0
    cxy: float = 0.0
    cyy: float = 0.0
    residual_rms: float = 0.0

    @property
    def coefficients(self) -> tuple[float, float, float, float, float, float]:
        """c0, cx, cy, cxx, cxy, cyy."""
        return self.c0, self.cx, self.cy, self.cxx, self.cxy, self.cyy

    def height(self, x: float, y: float) -> float:
        """The height of the bed at X, Y, mm."""
        return self.c0 + (self.cx + self.cxx * x + self.cxy * y) * x + (self.cy + self.cyy * y) * y

    def __add__(self, other: Fit) -> Fit:
        """The sum of an earlier correction and a new fit that was measured on top of it, with the
        residual of the new fit."""
        return Fit(
            self.c0 + other.c0,
            self.cx + other.cx,
            self.cy + other.cy,
            self.cxx + other.cxx,
            self.cxy + other.cxy,
            self.cyy + other.cyy,
            other.residual_rms,
        )


def fit(points: Sequence[Point], method: Method) -> Fit:
    """The plane or quadric with the least sum of squared deviations from the points. Raises
    CommandError if the points do not determine it, or if a height is not a finite number."""
    check_points([(x, y) for x, y, _ in points], method)
    for number, (_, _, z) in enumerate(points, 1):
        if not isfinite(z):
            raise CommandError.of("levelling.no-height", value=z, place=number)
    # Use coordinates relative to the middle of the points, scaled to about 1, to keep precision.
    (mx, my), scale = _middle(points), _reach(points)
    rows = [_terms((x - mx) / scale, (y - my) / scale, method) for x, y, _ in points]
    a0, ax, ay, axx, axy, ayy = (*solve(rows, [z for *_, z in points]), 0.0, 0.0, 0.0)[:6]
    ax, ay = ax / scale, ay / scale
    axx, axy, ayy = (a / scale**2 for a in (axx, axy, ayy))
    found = Fit(
        a0 - ax * mx - ay * my + axx * mx**2 + axy * mx * my + ayy * my**2,
        ax - 2 * axx * mx - axy * my,
        ay - 2 * ayy * my - axy * mx,
        axx,
        axy,
        ayy,
    )
    squares = sum((found.height(x, y) - z) ** 2 for x, y, z in points)
    return Fit(*found.coefficients, sqrt(squares / len(points)))


def check_points(places: Sequence[tuple[float, float]], method: Method) -> None:
    """Raises CommandError if no heights at these places can determine the plane or quadric: there
    are too few places, two places are too close, or all are on a line or on one curve of second
    degree."""
    needed = UNKNOWNS[method]
    if len(places) < needed:
        raise CommandError.of(
            "levelling.few-points", value=len(places), limit=needed, method=method
        )
    for (i, a), (j, b) in combinations(enumerate(places, 1), 2):
        apart = hypot(a[0] - b[0], a[1] - b[1])
        if apart < MIN_DISTANCE_MM:
            raise CommandError.of(
                "levelling.close-points", value=apart, limit=MIN_DISTANCE_MM, first=i, second=j
            )
    width = line_through(places)[1]
    if width < MIN_DISTANCE_MM:
        raise CommandError.of(
            "levelling.line", value=len(places), deviation=width, limit=MIN_DISTANCE_MM
        )
    (mx, my), scale = _middle(places), _reach(places)
    rows = [_terms((x - mx) / scale, (y - my) / scale, method) for x, y in places]
    try:
        solve(rows, [0.0] * len(rows))
    except RankError as error:
        raise CommandError.of(
            "levelling.conic", value=len(places), limit=needed, rank=error.rank
        ) from None


def _terms(u: float, v: float, method: Method) -> tuple[float, ...]:
    return (1.0, u, v, u * u, u * v, v * v)[: UNKNOWNS[method]]


def _middle(places: Sequence[tuple[float, ...]]) -> tuple[float, float]:
    n = len(places)
    return sum(p[0] for p in places) / n, sum(p[1] for p in places) / n


def _reach(places: Sequence[tuple[float, ...]]) -> float:
    mx, my = _middle(places)
    return max(hypot(p[0] - mx, p[1] - my) for p in places)


def line_through(places: Sequence[tuple[float, ...]]) -> tuple[float, float]:
    """The direction of the line that fits X and Y of the places best, in radians from X, and the
    maximum deviation of the places from it, mm."""
    mx, my = _middle(places)
    sxx = sum((p[0] - mx) ** 2 for p in places)
    syy = sum((p[1] - my) ** 2 for p in places)
    sxy = sum((p[0] - mx) * (p[1] - my) for p in places)
    angle = 0.5 * atan2(2 * sxy, sxx - syy)
    return angle, max(abs((p[1] - my) * cos(angle) - (p[0] - mx) * sin(angle)) for p in places)
