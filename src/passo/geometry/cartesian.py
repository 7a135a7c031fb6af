"""Cartesian: one motor an axis."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel, Point


class Cartesian(GeometryModel):
    """Every axis has its own motor."""

    actuators = ("x", "y", "z")
    kind: Literal["cartesian"]

    def inverse(self, point: Point) -> Point:
        return point

    def forward(self, actuators: Point) -> Point:
        return actuators
