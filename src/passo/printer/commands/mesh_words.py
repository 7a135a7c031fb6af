"""The parameters of BED_MESH_CALIBRATE that replace the grid of the machine file."""

from __future__ import annotations

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import number_of
from passo.levelling.areas import Grid
from passo.levelling.mesh import Interpolation

ALGORITHMS = "bicubic", "lagrange", "direct"
MOST_POINTS = 41  # along one axis
_LAGRANGE = 3  # points up to which a Lagrange surface is made of straight or single pieces


def given_grid(command: Command, usual: Grid | None) -> Grid:
    """The grid that MESH_MIN, MESH_MAX and PROBE_COUNT give, or MESH_RADIUS, MESH_ORIGIN and
    ROUND_PROBE_COUNT for a round bed; the rest is that of the usual grid. Raises CommandError."""
    if command.has("MESH_RADIUS"):
        radius = command.value("MESH_RADIUS")
        x, y = _pair(command, "MESH_ORIGIN") or (0.0, 0.0)
        grid = Grid((x - radius, y - radius, x + radius, y + radius), (5, 5), radius)
    else:
        grid = usual
    low = _pair(command, "MESH_MIN")
    high = _pair(command, "MESH_MAX")
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
    if (count := _pair(command, key)) is not None:
        nx, ny = count
        limit = f"2 to {MOST_POINTS} along each axis"
        if not (
            nx.is_integer() and ny.is_integer() and 2 <= min(nx, ny) <= MOST_POINTS >= max(nx, ny)
        ):
            shown = command.string(key)
            raise CommandError.of("command.value", axis=key, value=shown, limit=limit)
        grid = Grid(grid.area, (int(nx), int(ny)), grid.radius)
    return grid


def given_interpolation(command: Command, grid: Grid, usual: Interpolation) -> Interpolation:
    """The interpolation that ALGORITHM names. A Lagrange surface of up to 3 points is bilinear
    here, and bicubic with more points."""
    written = command.string("ALGORITHM").lower()
    if not written:
        return usual
    smooth = written == "bicubic" or (written == "lagrange" and max(grid.count) > _LAGRANGE)
    return "bicubic" if smooth else "bilinear"


def _pair(command: Command, key: str) -> tuple[float, float] | None:
    """Two numbers with a comma between them, or one number for both; None if the command has no
    such parameter. Raises CommandError."""
    if not command.has(key):
        return None
    parts = command.string(key).split(",")
    if len(parts) > 2:
        limit = "two numbers with a comma between them"
        raise CommandError.of("command.value", axis=key, value=command.string(key), limit=limit)
    first, last = (number_of(key, part) for part in (parts[0], parts[-1]))
    return first, last
