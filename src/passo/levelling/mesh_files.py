"""Meshes as named files: RepRapFirmware's height map (version 2), then one line for Passo.

    RepRapFirmware height map file v2 generated at 2026-11-25 02:00, min error -0.050, …
    axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1
    X,Y,20.0,180.0,20.0,180.0,-1.00,40.0,40.0,5,5
    0.1, 0.04, …
    ;passo {"name": "default", "bed_c": 60.0, "reference": "probe", …}

Numbers have all their digits, so that a stored mesh is read back bit for bit.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

from passo.errors import CommandError
from passo.levelling.mesh import Interpolation, Mesh

_HEAD = "RepRapFirmware height map file v2"
_NAMES = "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1"
_OLDER_NAMES = "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum"
_OWN = ";passo "
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}")
_WHEN = re.compile(r" generated at ([^,]*)")


@dataclass(frozen=True, slots=True)
class StoredMesh:
    """A mesh and the conditions of its measurement: `date` as text, the temperature of the bed
    `bed_c` in °C, and `reference`, the source of Z 0. A value that the file does not have is empty
    or None."""

    name: str
    mesh: Mesh
    date: str = ""
    bed_c: float | None = None
    reference: str = ""
    interpolation: Interpolation = "bicubic"


class MeshStore:
    """The stored meshes of one printer, by their names. This class keeps them in memory. `refused`
    are the errors of files that do not contain a mesh."""

    def __init__(self) -> None:
        self.all: dict[str, StoredMesh] = {}
        self.refused: list[CommandError] = []

    def named(self, name: str) -> StoredMesh:
        """A stored mesh. Raises CommandError."""
        if name not in self.all:
            limit = ", ".join(sorted(self.all)) or "a name that SAVE has stored"
            raise CommandError.of("command.value", axis="the mesh", value=name, limit=limit)
        return self.all[name]

    def save(self, stored: StoredMesh) -> None:
        """Stores a mesh in place of one of the same name. Raises CommandError."""
        self.all[stored.name] = stored

    def remove(self, name: str) -> None:
        """Deletes a stored mesh. Raises CommandError."""
        self.named(name)
        del self.all[name]


def check_name(name: str) -> str:
    """Returns the name of a mesh. Raises CommandError if it cannot be a file name."""
    if not _NAME.fullmatch(name):
        raise CommandError.of("levelling.mesh-name", value=name)
    return name


def summary(mesh: Mesh) -> str:
    """The statistics in the format of RepRapFirmware: min error, max error, mean, deviation."""
    low, high = mesh.range
    squares = [(z - mesh.mean) ** 2 for row in mesh.heights for z in row]
    deviation = (sum(squares) / len(squares)) ** 0.5
    return (
        f"min error {low:.3f}, max error {high:.3f}, mean {mesh.mean:.3f},"
        f" deviation {deviation:.3f}"
    )


def to_csv(stored: StoredMesh) -> str:
    """The text of the file."""
    mesh = stored.mesh
    (dx, dy), (nx, ny) = mesh.spacing, (len(mesh.xs), len(mesh.ys))
    numbers = (mesh.xs[0], mesh.xs[-1], mesh.ys[0], mesh.ys[-1])
    own = {
        "name": stored.name,
        "bed_c": stored.bed_c,
        "reference": stored.reference,
        "interpolation": stored.interpolation,
        "xs": mesh.xs,
        "ys": mesh.ys,
    }
    lines = [
        f"{_HEAD} generated at {stored.date}, {summary(mesh)}",
        _NAMES,
        ",".join(["X,Y", *map(repr, numbers), "-1.00", repr(dx), repr(dy), str(nx), str(ny)]),
        *(", ".join(map(repr, row)) for row in mesh.heights),
        _OWN + json.dumps(own),
    ]
    return "\n".join(lines) + "\n"


def from_csv(text: str, name: str) -> StoredMesh:
    """Parses a mesh file, also one that RepRapFirmware or an older version of it has written.
    `name` is the name of the mesh. Raises CommandError with the line that is wrong."""
    lines = text.splitlines()

    def wrong(line: int, limit: str) -> CommandError:
        found = lines[line - 1] if line <= len(lines) else ""
        return CommandError.of("levelling.mesh-file", name, line, value=found, limit=limit)

    if not lines or not lines[0].startswith(_HEAD[:-1]):
        raise wrong(1, _HEAD)
    own: dict[str, Any] = {}
    if len(lines) > 1 and lines[-1].startswith(_OWN):
        try:
            own = cast("dict[str, Any]", json.loads(lines[-1].removeprefix(_OWN)))
        except ValueError:
            raise wrong(len(lines), "JSON after ;passo") from None
    try:
        older = lines[1].strip() == _OLDER_NAMES
        words = lines[2].split(",")[0 if older else 2 :]
        x0, _, y0, _, _, dx, dy = map(float, words[:7])
        nx, ny = int(words[7]), int(words[8])
    except (IndexError, ValueError):
        raise wrong(3, _NAMES) from None
    rows: list[tuple[float, ...]] = []
    for j in range(ny):
        try:
            row = tuple(map(float, lines[3 + j].split(",")))
        except (IndexError, ValueError):
            raise wrong(4 + j, f"{nx} heights in mm") from None
        if len(row) != nx:
            raise wrong(4 + j, f"{nx} heights in mm")
        rows.append(row)
    date = _WHEN.search(lines[0])
    try:
        xs = tuple(map(float, own.get("xs", [x0 + dx * i for i in range(nx)])))
        ys = tuple(map(float, own.get("ys", [y0 + dy * j for j in range(ny)])))
        bed_c = own.get("bed_c")
        return StoredMesh(
            name,
            Mesh(xs, ys, tuple(rows)),
            date[1] if date else "",
            None if bed_c is None else float(bed_c),
            str(own.get("reference", "")),
            "bilinear" if own.get("interpolation") == "bilinear" else "bicubic",
        )
    except (TypeError, ValueError):
        raise wrong(len(lines), "numbers in ;passo") from None


def profile_data(stored: StoredMesh) -> dict[str, Any]:
    """The mesh in the format of Klipper's profiles and its object bed_mesh: the points row by row
    from the front, and the parameters of the interpolation."""
    mesh = stored.mesh
    bicubic = stored.interpolation == "bicubic"
    parts = 3 if bicubic else 0
    return {
        "points": [[round(z, 6) for z in row] for row in mesh.heights],
        "mesh_params": {
            "min_x": mesh.xs[0],
            "max_x": mesh.xs[-1],
            "min_y": mesh.ys[0],
            "max_y": mesh.ys[-1],
            "x_count": len(mesh.xs),
            "y_count": len(mesh.ys),
            "mesh_x_pps": parts,
            "mesh_y_pps": parts,
            "algo": "bicubic" if bicubic else "direct",
            "tension": 0.5,
        },
    }


def bed_mesh_status(active: StoredMesh | None, stored: dict[str, StoredMesh]) -> dict[str, Any]:
    """Klipper's object bed_mesh: the measured points of the active mesh, its interpolated points,
    and all stored meshes."""
    profiles = {name: profile_data(mesh) for name, mesh in stored.items()}
    if active is None:
        return {
            "profile_name": "",
            "mesh_min": [0.0, 0.0],
            "mesh_max": [0.0, 0.0],
            "probed_matrix": [[]],
            "mesh_matrix": [[]],
            "profiles": profiles,
        }
    mesh = active.mesh
    fine = _fine(mesh) if active.interpolation == "bicubic" else mesh
    return {
        "profile_name": active.name,
        "mesh_min": [mesh.xs[0], mesh.ys[0]],
        "mesh_max": [mesh.xs[-1], mesh.ys[-1]],
        "probed_matrix": [[round(z, 6) for z in row] for row in mesh.heights],
        "mesh_matrix": [[round(z, 6) for z in row] for row in fine.heights],
        "profiles": profiles,
    }


@lru_cache(maxsize=8)
def _fine(mesh: Mesh) -> Mesh:
    """Cached, because clients ask for it several times a second."""
    return mesh.refined(4)
