"""The first layer above the bed, as data of a picture of the cells in which the print extruded."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.job.batch.first_layer import FirstLayerWatch


def bed_picture(watch: FirstLayerWatch | None) -> dict[str, object] | None:
    """The bed and the distance of the nozzle from it in each cell, mm; None if nothing was extruded
    along the bed."""
    layer = watch and watch.layer
    if watch is None or layer is None:
        return None
    text = str(layer)
    return {
        "area": watch.area_mm,
        "cells": [[mm if mm is None else round(mm, 4) for mm in row] for row in watch.cells],
        "mean_mm": layer.mean_mm,
        "text": f"{text[0].upper()}{text[1:]}",
    }
