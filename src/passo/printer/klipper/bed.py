"""Klipper's objects of the bed: its mesh, its probe, and the paper test."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from passo.levelling.mesh import Mesh
from passo.levelling.mesh_files import StoredMesh, bed_mesh_status

if TYPE_CHECKING:
    from passo.printer.status import BedStatus, BedSurface, Status

Object = dict[str, Any]
_NAME_OF_NEW = "default"
_SECTIONS = {"bltouch": "bltouch", "eddy": "probe_eddy_current"}  # by the kind of the probe


def bed_mesh(bed: BedStatus) -> Object:
    """The active mesh and all stored meshes. A fitted surface is shown as a mesh with the name of
    its method."""
    active: StoredMesh | None = None
    if bed.on and bed.mesh is not None:
        active = StoredMesh(bed.profile or _NAME_OF_NEW, bed.mesh)
    elif bed.on and bed.surface is not None:
        active = StoredMesh(bed.method, _mesh_of(bed.surface), interpolation="bilinear")
    return bed_mesh_status(active, dict(bed.meshes))


def _mesh_of(surface: BedSurface) -> Mesh:
    columns, rows = len(surface.rows_mm[0]), len(surface.rows_mm)
    (x0, y0), (x1, y1) = surface.from_mm, surface.to_mm
    xs = tuple(x0 + (x1 - x0) * i / (columns - 1) for i in range(columns))
    ys = tuple(y0 + (y1 - y0) * j / (rows - 1) for j in range(rows))
    return Mesh(xs, ys, surface.rows_mm)


def probe(bed: BedStatus) -> Object:
    """The state of the probe at the last query, and its last measurement."""
    last = bed.points[-1] if bed.points else None
    place = [last.x_mm, last.y_mm, last.height_mm] if last else [0.0, 0.0, 0.0]
    return {
        "name": _SECTIONS.get(bed.probe, "probe"),
        "last_query": bed.triggered,
        "last_probe_position": place,
        "last_z_result": place[2],
    }


def manual_probe(bed: BedStatus) -> Object:
    """The paper test; the dialogs of Mainsail and Fluidd show it."""
    test = bed.manual
    return {
        "is_active": test is not None,
        "z_position": test.z_mm if test else None,
        "z_position_lower": test.below_mm if test else None,
        "z_position_upper": test.above_mm if test else None,
    }


def levelled(status: Status) -> Object:
    """`z_tilt` and `quad_gantry_level`."""
    return {"applied": bool(status.gantry_level)}


def screws_tilt_adjust(status: Status) -> Object:
    """The last measurement of the screws; the dialog of Mainsail shows it."""
    results: Object = {}
    for n, screw in enumerate(status.screws, 1):
        sign, turns = screw.adjust.split()
        z, base = screw.height_mm, screw.base
        results[f"screw{n}"] = {"z": z, "sign": sign, "adjust": turns, "is_base": base}
    limit = status.screws_limit_mm
    return {"error": limit is not None, "max_deviation": limit, "results": results}
