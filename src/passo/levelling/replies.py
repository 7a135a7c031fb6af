"""Replies with heights of the bed, in the forms that hosts and screens parse.

OctoPrint's Bed Visualizer takes each line of numbers with a decimal point as a row, in the order
printed, front row first, until a line with "ok". Screens of BIGTREETECH recognise a table by its
heading, and skip a fixed number of lines and columns. So each table has a number in each cell, and
no other line between its heading and its end.
"""

from __future__ import annotations

from collections.abc import Sequence

from passo.levelling.mesh import Mesh


def bilinear_grid(mesh: Mesh) -> list[str]:
    """Marlin's table of the heights. Screens know it by its heading, which is therefore the same
    for a surface."""
    return ["Bilinear Leveling Grid:", *_numbered(mesh.heights)]


def probed_rows(mesh: Mesh) -> list[str]:
    """Klipper's BED_MESH_OUTPUT."""
    rows = (" ".join(f"{z:9.6f}" for z in row) for row in mesh.heights)
    return ["Mesh Leveling Probed Z positions:", *rows]


def _numbered(rows: Sequence[Sequence[float]]) -> list[str]:
    """A line of column numbers, then each row with its own number; each height has a sign."""
    head = "".join(f"{i:7d}" for i in range(len(rows[0])))
    return [
        head,
        *(f"{j:2d} " + " ".join(f"{z:+.3f}" for z in row) for j, row in enumerate(rows)),
    ]
