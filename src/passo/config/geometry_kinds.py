"""Geometry models by their `kind`."""

from __future__ import annotations

from typing import get_args

from passo.geometry.base import GeometryModel
from passo.geometry.registry import GEOMETRIES

KINDS: dict[str, type[GeometryModel]] = {
    kind: model for model in GEOMETRIES for kind in get_args(model.model_fields["kind"].annotation)
}
