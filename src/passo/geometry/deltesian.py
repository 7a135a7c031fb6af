"""Deltesian: two carriages on vertical towers hold the effector by rods in the plane XZ; Y is
independent."""

from __future__ import annotations

from math import cos, radians
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Offset, Point

Positive = Annotated[float, Field(gt=0, le=1e4)]


class Deltesian(GeometryModel):
    """Lengths in mm. The position of a carriage is the height of its end of the rod."""

    motors = ("a", "y", "b")
    lifts_together = True
    arms = ("a", "b")
    axes_of_arms = ("x", "z")
    kind: Literal["deltesian"]
    """Carriages on two towers, and a motor for Y."""
    towers_x: Annotated[list[Offset], Field(min_length=2, max_length=2)]
    """X of the left tower (A) and of the right one (B), less the offset of the effector, in mm."""
    rods: Annotated[list[Positive], Field(min_length=2, max_length=2)]
    """The lengths of both rods, in mm."""
    min_angle: Annotated[float, Field(ge=0, le=80)] = 5.0
    """The minimum angle of a rod to the horizontal, in degrees."""

    def reason(self, point: Point) -> str:
        """The rod that is too flat."""
        for name, x, rod in zip("AB", self.towers_x, self.rods, strict=True):
            far, limit = abs(point[0] - x), rod * cos(radians(self.min_angle))
            if far > limit:
                return f"it is {far:.3f} mm from tower {name}, whose rod reaches {limit:.3f} mm"
        return ""
