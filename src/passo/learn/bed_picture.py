"""The first layer above the bed, as a picture of the cells in which the print extruded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.learn.page import picture

if TYPE_CHECKING:
    from passo.job.batch.first_layer import FirstLayerWatch

_LEAST_RANGE_MM = 0.05  # cells that differ less look the same


def bed_picture(watch: FirstLayerWatch) -> str:
    """The section of the page; empty if nothing was extruded along the bed."""
    layer = watch.layer
    if layer is None:
        return ""
    rows, (x0, y0, x1, y1) = watch.cells, watch.area_mm
    wide, high = (x1 - x0) / len(rows[0]), (y1 - y0) / len(rows)
    known = [
        (x0 + i * wide, y0 + j * high, mm)
        for j, row in enumerate(rows)
        for i, mm in enumerate(row)
        if mm is not None
    ]
    most = max(_LEAST_RANGE_MM, max(abs(mm - layer.mean_mm) for *_, mm in known))
    cells = "".join(
        f'<rect x="{x:.3f}" y="{-y - high:.3f}" width="{wide:.3f}" height="{high:.3f}"'
        f' style="fill:var(--c{int(mm < layer.mean_mm)})"'
        f' fill-opacity="{0.1 + 0.9 * abs(mm - layer.mean_mm) / most:.2f}">'
        f"<title>X{x + wide / 2:.0f} Y{y + high / 2:.0f}: {mm:.3f} mm</title></rect>"
        for x, y, mm in known
    )
    bed = f'<path class="bed" d="M{x0:g} {-y0:g}H{x1:g}V{-y1:g}H{x0:g}z"/>'
    drawing = f'<svg viewBox="{x0:g} {-y1:g} {x1 - x0:g} {y1 - y0:g}">{bed}{cells}</svg>'
    lower = '<b style="color:var(--c1)">Orange</b>: nearer to the bed than on average'
    higher = '<b style="color:var(--c0)">blue</b>: farther from it'
    figures = str(layer)
    legend = f"{figures[0].upper()}{figures[1:]}. {lower}; {higher}."
    return picture("First layer", drawing, legend)
