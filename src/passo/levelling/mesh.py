"""Meshes: heights of the bed on an even grid, and the interpolation between the points. It is
bilinear or bicubic. Bicubic is the cubic of Catmull and Rom (A class of local interpolating
splines, 1974) along X, then along Y. At the edge of the grid, the missing neighbour continues the
parabola of the last three points, p(-1) = 3 p0 - 3 p1 + p2, so that a dome is exact up to the edge;
with two points it continues their line. Outside of the grid, the height is that of the edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite
from typing import Literal

from passo.errors import CommandError

Interpolation = Literal["bilinear", "bicubic"]

_EVEN_MM = 1e-6


@dataclass(frozen=True, slots=True)
class Mesh:
    """`heights[j][i]`, mm, is the height of the bed at (xs[i], ys[j]). Each axis has at least two
    points, ascending in even steps. Raises CommandError otherwise."""

    xs: tuple[float, ...]
    ys: tuple[float, ...]
    heights: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        """Checks the axes and the heights."""
        for axis, places in (("X", self.xs), ("Y", self.ys)):
            _check_even(axis, places)
        if len(self.heights) != len(self.ys) or any(len(r) != len(self.xs) for r in self.heights):
            raise CommandError.of(
                "levelling.mesh-size",
                value=f"{len(self.heights)} rows of {sorted({len(r) for r in self.heights})}",
                limit=f"{len(self.ys)} rows of {len(self.xs)}",
            )
        for j, row in enumerate(self.heights):
            for i, z in enumerate(row):
                if not isfinite(z):
                    raise CommandError.of(
                        "levelling.no-height", value=z, place=j * len(self.xs) + i + 1
                    )

    @property
    def spacing(self) -> tuple[float, float]:
        """The distance between points along X and along Y, mm."""
        return (
            (self.xs[-1] - self.xs[0]) / (len(self.xs) - 1),
            (self.ys[-1] - self.ys[0]) / (len(self.ys) - 1),
        )

    @property
    def mean(self) -> float:
        """The mean of all heights, mm."""
        return sum(map(sum, self.heights)) / (len(self.xs) * len(self.ys))

    @property
    def range(self) -> tuple[float, float]:
        """The lowest and the highest height, mm."""
        return min(map(min, self.heights)), max(map(max, self.heights))

    def height(self, x: float, y: float, interpolation: Interpolation = "bilinear") -> float:
        """The height of the bed at X, Y, mm."""
        (i, u), (j, v) = _cell(self.xs, x), _cell(self.ys, y)
        if interpolation == "bilinear":
            low, high = (
                row[i] + (row[i + 1] - row[i]) * u for row in (self.heights[j], self.heights[j + 1])
            )
            return low + (high - low) * v
        rows = range(max(j - 1, 0), min(j + 3, len(self.ys)))
        column = [_cubic(self.heights[row], i, u) for row in rows]
        return _cubic(column, j - rows[0], v)

    def refined(self, parts: int) -> Mesh:
        """A mesh with `parts` intervals for each interval of this one, by bicubic interpolation."""
        xs, ys = (_refine(places, parts) for places in (self.xs, self.ys))
        return Mesh(xs, ys, tuple(tuple(self.height(x, y, "bicubic") for x in xs) for y in ys))

    def lowered(self, mm: float) -> Mesh:
        """A copy with all heights lowered by `mm`."""
        return Mesh(self.xs, self.ys, tuple(tuple(z - mm for z in row) for row in self.heights))


def _check_even(axis: str, places: Sequence[float]) -> None:
    if len(places) < 2:
        raise CommandError.of("levelling.mesh-size", value=f"{len(places)} in {axis}", limit="2")
    step = (places[-1] - places[0]) / (len(places) - 1)
    for k, at in enumerate(places):
        if not (step > 0 and abs(at - places[0] - k * step) <= _EVEN_MM):
            raise CommandError.of(
                "levelling.uneven", axis=axis, value=at, limit=places[0] + k * step
            )


def _refine(places: Sequence[float], parts: int) -> tuple[float, ...]:
    n = (len(places) - 1) * parts
    return tuple(places[0] + (places[-1] - places[0]) * k / n for k in range(n + 1))


def _cell(places: Sequence[float], at: float) -> tuple[int, float]:
    """The index of the interval, and the fraction within it from 0 to 1."""
    last = len(places) - 2
    share = (at - places[0]) / (places[-1] - places[0]) * (last + 1)
    i = min(max(floor(share), 0), last)
    return i, min(max(share - i, 0.0), 1.0)


def _cubic(p: Sequence[float], i: int, u: float) -> float:
    """The value between p[i] and p[i + 1] at the fraction u."""
    a, b = p[i], p[i + 1]
    # A missing neighbour continues a parabola, or a line if there are only two points.
    before = p[i - 1] if i > 0 else _beyond(p[i : i + 3])
    after = p[i + 2] if i + 2 < len(p) else _beyond(p[max(i - 1, 0) : i + 2][::-1])
    at_a, at_b = 0.5 * (b - before), 0.5 * (after - a)
    return a + u * (at_a + u * (3 * (b - a) - 2 * at_a - at_b + u * (2 * (a - b) + at_a + at_b)))


def _beyond(p: Sequence[float]) -> float:
    return 3 * p[0] - 3 * p[1] + p[2] if len(p) == 3 else 2 * p[0] - p[1]
