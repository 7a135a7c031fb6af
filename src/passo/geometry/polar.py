"""Polar: the bed turns about its middle, an arm moves the nozzle away from there, and Z is
independent."""

from __future__ import annotations

from math import hypot
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Point


class Polar(GeometryModel):
    """The bed turns by degrees, without end. The arm counts its mm from the middle of the bed,
    which is X 0, Y 0."""

    motors = ("a", "b", "z")
    rotary = ("a",)
    endless = ("a",)
    arms = ("a", "b")
    free = ("a",)
    kind: Literal["polar"]
    """A bed that turns, and an arm."""
    centre: Annotated[float, Field(ge=0.01, le=10)] = 0.02
    """How near to X 0, Y 0 the nozzle may come, in mm. A line that passes nearer is led round the
    middle at twice this distance, slowly, because the bed has to turn half round. No line may end
    nearer, and no arc may pass nearer."""

    def reason(self, point: Point) -> str:
        """The distance from the middle of the bed, if that is too short."""
        mm = hypot(point[0], point[1])
        if mm >= self.centre:
            return ""
        return (
            f"it is {mm:.3f} mm from the middle of the bed, which would have to turn at once there"
            f" (limit {self.centre:g} mm)"
        )
