"""Cartesian: one motor an axis."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel, Point


class Cartesian(GeometryModel):
    """Every axis has its own motor."""

    actuators = ("x", "y", "z")
    kind: Literal["cartesian"]
    """A motor for each axis."""

    def inverse(self, point: Point) -> Point:
        """The motors' positions, mm: those of the axes."""
        return point

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position, mm: that of the motors."""
        return actuators
