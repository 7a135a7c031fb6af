"""CoreXY, CoreXZ, CoreYZ: two motors move two axes together, A = u + v and B = u - v."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel


class CoreXY(GeometryModel):
    """A = X + Y, B = X - Y."""

    actuators = ("a", "b", "z")
    kind: Literal["corexy"]
    """Crossed belts: A = X + Y, B = X − Y."""


class CoreXZ(GeometryModel):
    """A = X + Z, B = X - Z."""

    actuators = ("a", "y", "b")
    kind: Literal["corexz"]
    """Crossed belts: A = X + Z, B = X − Z."""


class CoreYZ(GeometryModel):
    """A = Y + Z, B = Y - Z."""

    actuators = ("x", "a", "b")
    kind: Literal["coreyz"]
    """Crossed belts: A = Y + Z, B = Y − Z."""
