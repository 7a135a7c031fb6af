"""The parameters of BED_MESH_CALIBRATE that replace the grid of the machine file."""

from __future__ import annotations

from collections.abc import Mapping

from passo.errors import CommandError
from passo.levelling.areas import Grid
from passo.levelling.mesh import Interpolation
from passo.printer.commands.klipper_commands import number

_Words = Mapping[str, str]
_ALGORITHMS = "bicubic", "lagrange", "direct"
_MOST_POINTS = 41  # along one axis
_LAGRANGE = 3  # points up to which a Lagrange surface is made of straight or single pieces


def given_grid(words: _Words, usual: Grid | None) -> Grid:
    """The grid that MESH_MIN, MESH_MAX and PROBE_COUNT give, or MESH_RADIUS, MESH_ORIGIN and
    ROUND_PROBE_COUNT for a round bed; the rest is that of the usual grid. Raises CommandError."""
    if "MESH_RADIUS" in words:
        radius = number(words, "MESH_RADIUS")
        x, y = _pair(words, "MESH_ORIGIN") if "MESH_ORIGIN" in words else (0.0, 0.0)
        grid = Grid((x - radius, y - radius, x + radius, y + radius), (5, 5), radius)
    else:
        grid = usual
    low = _pair(words, "MESH_MIN") if "MESH_MIN" in words else None
    high = _pair(words, "MESH_MAX") if "MESH_MAX" in words else None
    if low is not None and high is not None:
        grid = Grid((*low, *high), grid.count if grid else (_LAGRANGE, _LAGRANGE))
    if grid is None:
        raise CommandError.of("levelling.no-area")
    if low is None or high is None:
        area = (*(low or grid.area[:2]), *(high or grid.area[2:]))
        grid = Grid((area[0], area[1], area[2], area[3]), grid.count, grid.radius)
    if not (grid.area[0] < grid.area[2] and grid.area[1] < grid.area[3]):
        x0, y0, x1, y1 = grid.area
        limit = f"more than MESH_MIN {x0:g},{y0:g}"
        raise CommandError.of("command.value", axis="MESH_MAX", value=f"{x1:g},{y1:g}", limit=limit)
    key = "PROBE_COUNT" if grid.radius is None else "ROUND_PROBE_COUNT"
    if key in words:
        nx, ny = _pair(words, key)
        limit = f"2 to {_MOST_POINTS} along each axis"
        if not (
            nx.is_integer() and ny.is_integer() and 2 <= min(nx, ny) <= _MOST_POINTS >= max(nx, ny)
        ):
            raise CommandError.of("command.value", axis=key, value=words[key], limit=limit)
        grid = Grid(grid.area, (int(nx), int(ny)), grid.radius)
    return grid


def given_interpolation(words: _Words, grid: Grid, usual: Interpolation) -> Interpolation:
    """The interpolation that ALGORITHM names. A Lagrange surface of up to 3 points is bilinear
    here, and bicubic with more points. Raises CommandError."""
    written = words.get("ALGORITHM", "").lower()
    if not written:
        return usual
    if written not in _ALGORITHMS:
        limit = ", ".join(_ALGORITHMS)
        raise CommandError.of("command.value", axis="ALGORITHM", value=written, limit=limit)
    smooth = written == "bicubic" or (written == "lagrange" and max(grid.count) > _LAGRANGE)
    return "bicubic" if smooth else "bilinear"


def _pair(words: _Words, key: str) -> tuple[float, float]:
    """Two numbers with a comma between them, or one number for both. Raises CommandError."""
    parts = words[key].split(",")
    if len(parts) > 2:
        limit = "two numbers with a comma between them"
        raise CommandError.of("command.value", axis=key, value=words[key], limit=limit)
    first, last = (number({key: part}, key) for part in (parts[0], parts[-1]))
    return first, last
