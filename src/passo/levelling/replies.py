"""Replies with heights of the bed, in the forms that hosts and screens parse.

OctoPrint's Bed Visualizer takes each line of numbers with a decimal point as a row, in the order
printed, front row first, until a line with "ok". Screens of BIGTREETECH recognise a table by its
heading, and skip a fixed number of lines and columns. So each table has a number in each cell, and
no other line between its heading and its end.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

from passo.levelling.fits import Fit
from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import summary


def bilinear_grid(mesh: Mesh) -> list[str]:
    """Marlin's table of the heights. Screens know it by its heading, which is therefore the same
    for a surface."""
    return ["Bilinear Leveling Grid:", *_numbered(mesh.heights, 3)]


def subdivided_grid(mesh: Mesh) -> list[str]:
    """Marlin's table of a bicubic mesh, with the interpolated points."""
    return ["Subdivided with CATMULL ROM Leveling Grid:", *_numbered(mesh.refined(4).heights, 5)]


def mesh_data(mesh: Mesh, offset_mm: float = 0.0) -> list[str]:
    """Marlin's table of a manually measured mesh."""
    nx, ny = len(mesh.xs), len(mesh.ys)
    return [
        "Mesh Bed Level data:",
        f"{nx}x{ny} mesh. Z offset: {offset_mm:.5f}",
        "Measured points:",
        *_numbered(mesh.heights, 5),
    ]


def topography_csv(mesh: Mesh) -> list[str]:
    """Marlin's table for other programs (M420 V1 T1): numbers between tabs."""
    rows = ("\t".join(f"{z:.3f}" for z in row) for row in mesh.heights)
    return ["Bed Topography Report for CSV:", "", *rows]


def correction_matrix(fit: Fit) -> list[str]:
    """Marlin's rotation matrix for the tilt of the fit. Quadratic coefficients are not part of
    it."""
    a, b = fit.cx, fit.cy
    x = [c / hypot(1, a) for c in (1, 0, a)]
    y = [c / hypot(1, b) for c in (0, 1, b)]
    z = [c / hypot(1, a, b) for c in (-a, -b, 1)]
    rows = (" ".join(f"{c:+.6f}" for c in row) for row in (x, y, z))
    return ["Bed Level Correction Matrix:", *rows]


def probed_rows(mesh: Mesh) -> list[str]:
    """Klipper's BED_MESH_OUTPUT."""
    rows = (" ".join(f"{z:9.6f}" for z in row) for row in mesh.heights)
    return ["Mesh Leveling Probed Z positions:", *rows]


def height_map_line(mesh: Mesh) -> str:
    """RepRapFirmware's line after G29 S0."""
    return f"{len(mesh.xs) * len(mesh.ys)} points probed, {summary(mesh)}"


def probe_height(number: int, height_mm: float) -> str:
    """APrinter's line for a point of G32, without its //."""
    return f"ProbeHeight@P{number} {height_mm:.6g}"


def corrections(fit: Fit, *, relative: bool) -> str:
    """APrinter's line of coefficients: of the last G32 (`relative`), or of the whole correction
    (M937)."""
    head = "RelativeCorrections" if relative else "EffectiveCorrections"
    names = ("Z", "X", "Y", "XX", "XY", "YY")
    pairs = zip(names, fit.coefficients, strict=True)
    return " ".join([head, *(f"{name}:{value:.6g}" for name, value in pairs)])


def set_points(mesh: Mesh) -> list[str]:
    """Commands that restore the mesh, for M503."""
    return [
        f"G29 W I{i} J{j} Z{z:.5f}" for j, row in enumerate(mesh.heights) for i, z in enumerate(row)
    ]


def _numbered(rows: Sequence[Sequence[float]], digits: int) -> list[str]:
    """A line of column numbers, then each row with its own number; each height has a sign."""
    head = "".join(f"{i:{digits + 4}d}" for i in range(len(rows[0])))
    return [
        head,
        *(f"{j:2d} " + " ".join(f"{z:+.{digits}f}" for z in row) for j, row in enumerate(rows)),
    ]
