"""Cartesian: one motor an axis."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel


class Cartesian(GeometryModel):
    """Every axis has its own motor."""

    actuators = ("x", "y", "z")
    kind: Literal["cartesian"]
    """A motor for each axis."""
