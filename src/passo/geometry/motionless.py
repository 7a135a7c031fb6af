"""A machine that has no X, Y and Z: only filament, heaters and outputs."""

from __future__ import annotations

from typing import Literal

from passo.geometry.base import GeometryModel, Point


class Motionless(GeometryModel):
    """No motor moves X, Y or Z; the machine file has no table for them."""

    motors = ()
    axes_of_arms = ()
    homes = False
    kind: Literal["none"]
    """No motor moves X, Y or Z."""

    def reason(self, point: Point) -> str:
        """Never empty: there is no motor."""
        del point
        return "it has no motors for X, Y and Z"
