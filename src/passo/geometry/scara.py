"""SCARA: an upper arm turns about the shoulder, a forearm turns at its end, and Z is
independent."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, hypot
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr

from passo.geometry.base import GeometryModel, Offset, Point, Unreachable
from passo.geometry.shoulder import Limits, at_end, reach, turned, why_it_ends

Positive = Annotated[float, Field(gt=0, le=1e4)]


class Scara(GeometryModel):
    """Lengths in mm; the offsets are the position of the shoulder. With `external_motor` the
    elbow's motor sits on the base and turns the forearm relative to the base, otherwise relative to
    the upper arm."""

    motors = ("a", "b", "z")
    rotary = ("a", "b")
    arms = ("a", "b")
    kind: Literal["scara"]
    """An upper arm and a forearm."""
    arm1: Positive = 150.0
    """The length of the upper arm, in mm."""
    arm2: Positive = 150.0
    """The length of the forearm, in mm."""
    external_motor: bool = True
    """Whether the motor of the elbow is on the base. Then the angle of the forearm counts from the
    base, otherwise from the upper arm."""
    x_offset: Offset = 0.0
    """X of the shoulder, in mm."""
    y_offset: Offset = 0.0
    """Y of the shoulder, in mm."""
    # For each arm, its direction to the nozzle in the middle of its angle range, degrees.
    _middles: tuple[float, float] = PrivateAttr((0.0, 0.0))

    def spec(self) -> dict[str, Any]:
        """Kind, parameters and the middles of the ranges of the angles."""
        return self.model_dump() | {"middles": list(self._middles)}

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """The angle range, one full turn, ends on the side opposite to the middle of the bed. Full
        turns are added until it contains the limits."""
        towards = degrees(atan2(middle[1] - self.y_offset, middle[0] - self.x_offset))
        faced = self.model_copy()
        faced._middles = (towards, towards)
        try:
            a, b, _ = faced.inverse(middle)
        except Unreachable:
            return faced
        faced._middles = (towards + turned(a, limits[0]), towards + turned(b, limits[1]))
        return faced

    def edge(self, point: Point) -> str:
        """The boundary on the far side of the shoulder, where the angle range ends."""
        x, y = point[0] - self.x_offset, point[1] - self.y_offset
        behind = at_end(y, x, self._middles[0])
        return why_it_ends(self.x_offset, self.y_offset) if behind else super().edge(point)

    def options(self) -> dict[str, float]:
        """All of its parameters."""
        return {
            "SCARAArm1Length": self.arm1,
            "SCARAArm2Length": self.arm2,
            "SCARAExternalArm2Motor": float(self.external_motor),
            "SCARAXOffset": self.x_offset,
            "SCARAYOffset": self.y_offset,
        }

    def reason(self, point: Point) -> str:
        """The minimum or maximum reach of the arms that the point violates."""
        d = hypot(point[0] - self.x_offset, point[1] - self.y_offset)
        nearest, farthest = reach(self.arm1, self.arm2)
        if nearest <= d <= farthest:
            return ""
        return (
            f"the arms reach from {nearest:.3f} to {farthest:.3f} mm from the shoulder,"
            f" not {d:.3f} mm"
        )
