"""The points of a mesh: its grid, the part of the bed that a job needs, and areas to avoid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import ceil, floor, hypot

from passo.errors import CommandError
from passo.levelling.mesh import Mesh

Area = tuple[float, float, float, float]
"""A rectangle x0, y0, x1, y1, mm."""


@dataclass(frozen=True, slots=True)
class Grid:
    """The points of a mesh: `count` along X and along Y, evenly spread over an area. With
    `radius`, mm, only points within this distance of the area's middle are probed."""

    area: Area
    count: tuple[int, int]
    radius: float | None = None

    @property
    def xs(self) -> tuple[float, ...]:
        """X of the columns, mm; the distance between them is rounded down to 0.01 mm."""
        return _even(self.area[0], self.area[2], self.count[0])

    @property
    def ys(self) -> tuple[float, ...]:
        """Y of the rows, mm, in the same way."""
        return _even(self.area[1], self.area[3], self.count[1])

    def probed(self) -> list[tuple[float, float]]:
        """The places to probe, row by row in a zigzag."""
        places: list[tuple[float, float]] = []
        for j, y in enumerate(self.ys):
            row = [(x, y) for x in self.xs if self._is_probed(x, y)]
            places += row if j % 2 == 0 else row[::-1]
        return places

    def mesh(self, height: Callable[[float, float], float]) -> Mesh:
        """The mesh from the heights at `probed()`, mm. On a round bed, a point beyond the radius
        gets the height of the nearest probed point in its row, else of the next row."""
        rows: list[list[float] | None] = []
        for y in self.ys:
            inside = [i for i, x in enumerate(self.xs) if self._is_probed(x, y)]
            if not inside:
                rows.append(None)
                continue
            at = {i: height(self.xs[i], y) for i in inside}
            rows.append([at[min(max(i, inside[0]), inside[-1])] for i in range(len(self.xs))])
        known = [j for j, row in enumerate(rows) if row is not None]
        if not known:
            raise CommandError.of("levelling.empty-area", value=self.radius)
        filled = (rows[min(known, key=lambda k: abs(k - j))] for j in range(len(rows)))
        return Mesh(self.xs, self.ys, tuple(tuple(row or ()) for row in filled))

    def _is_probed(self, x: float, y: float) -> bool:
        x0, y0, x1, y1 = self.area
        far = hypot(x - (x0 + x1) / 2, y - (y0 + y1) / 2)
        # the tolerance is the rounding of the columns
        return self.radius is None or far <= self.radius + 0.01

    def adapted(self, job: Area, margin_mm: float) -> Grid:
        """A grid over the area of a job and a margin around it, as dense as this grid and never
        beyond it. Each axis has at least 3 points (4 if the other axis has more than 6). Raises
        CommandError if the job does not touch it."""
        x0, y0, x1, y1 = self.area
        box = (
            max(x0, job[0] - margin_mm),
            max(y0, job[1] - margin_mm),
            min(x1, job[2] + margin_mm),
            min(y1, job[3] + margin_mm),
        )
        if box[0] >= box[2] or box[1] >= box[3]:
            raise CommandError.of("levelling.outside-job", value=_text(job), limit=_text(self.area))
        shares = (box[2] - box[0]) / (x1 - x0), (box[3] - box[1]) / (y1 - y0)
        nx, ny = (ceil(n * share - 1e-9) for n, share in zip(self.count, shares, strict=True))
        nx, ny = max(nx, 3), max(ny, 3)
        if max(nx, ny) > 6:
            nx, ny = max(nx, 4), max(ny, 4)
        return replace(self, area=box, count=(nx, ny))


def check_avoided(areas: Sequence[Area]) -> None:
    """Raises CommandError if an area is empty, or two of them overlap."""
    for area in areas:
        if not (area[0] < area[2] and area[1] < area[3]):
            raise CommandError.of("levelling.bad-area", value=_text(area))
    for a, b in combinations(areas, 2):
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]:
            raise CommandError.of("levelling.overlap", value=_text(a), limit=_text(b))


def places_around(
    x: float, y: float, within: Area, avoid: Sequence[Area]
) -> list[tuple[float, float]]:
    """The places to probe instead of a point. Outside of all areas to avoid, this is the point
    itself. Otherwise it is up to four places within `within`, where the row and the column of the
    point leave the area; the mean of their heights is the height of the point. Raises CommandError
    if no place is left."""
    area = next((a for a in avoid if a[0] <= x <= a[2] and a[1] <= y <= a[3]), None)
    if area is None:
        return [(x, y)]
    # Round away from the area, so that a place on its edge is outside.
    left, low = (floor(c * 100 - 1) / 100 for c in area[:2])
    right, high = (ceil(c * 100 + 1) / 100 for c in area[2:])
    places = [(left, y), (right, y), (x, low), (x, high)]
    found = [
        (px, py)
        for px, py in places
        if within[0] <= px <= within[2]
        and within[1] <= py <= within[3]
        and not any(a[0] <= px <= a[2] and a[1] <= py <= a[3] for a in avoid)
    ]
    if not found:
        raise CommandError.of("levelling.all-avoided", value=f"X{x:g} Y{y:g}", limit=_text(area))
    return found


def _even(first: float, last: float, count: int) -> tuple[float, ...]:
    step = floor(100 * (last - first) / (count - 1) + 1e-6) / 100
    return tuple(round(first + k * step, 6) for k in range(count))


def _text(area: Area) -> str:
    return f"X{area[0]:g} to X{area[2]:g}, Y{area[1]:g} to Y{area[3]:g}"
