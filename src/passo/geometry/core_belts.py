"""CoreXY, CoreXZ, CoreYZ: two motors move two axes together, A = u + v and B = u - v."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel, Point


class CoreXY(GeometryModel):
    """A = X + Y, B = X - Y."""

    actuators = ("a", "b", "z")
    kind: Literal["corexy"]
    """Crossed belts: A = X + Y, B = X − Y."""

    def inverse(self, point: Point) -> Point:
        """The motors' positions, mm, at a point in mm; every point has them."""
        x, y, z = point
        return x + y, x - y, z

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position, mm, from half the sum and half the difference of both belts."""
        a, b, z = actuators
        return (a + b) / 2, (a - b) / 2, z


class CoreXZ(GeometryModel):
    """A = X + Z, B = X - Z."""

    actuators = ("a", "y", "b")
    kind: Literal["corexz"]
    """Crossed belts: A = X + Z, B = X − Z."""

    def inverse(self, point: Point) -> Point:
        """The motors' positions, mm, at a point in mm; every point has them."""
        x, y, z = point
        return x + z, y, x - z

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position, mm, from half the sum and half the difference of both belts."""
        a, y, b = actuators
        return (a + b) / 2, y, (a - b) / 2


class CoreYZ(GeometryModel):
    """A = Y + Z, B = Y - Z."""

    actuators = ("x", "a", "b")
    kind: Literal["coreyz"]
    """Crossed belts: A = Y + Z, B = Y − Z."""

    def inverse(self, point: Point) -> Point:
        """The motors' positions, mm, at a point in mm; every point has them."""
        x, y, z = point
        return x, y + z, y - z

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position, mm, from half the sum and half the difference of both belts."""
        x, a, b = actuators
        return x, (a + b) / 2, (a - b) / 2
