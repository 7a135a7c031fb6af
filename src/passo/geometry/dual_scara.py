"""Dual-arm SCARA (five-bar): two arms from two shoulders meet at the nozzle, with an
independent Z."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, hypot
from typing import Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr

from passo.geometry.base import GeometryModel, Offset, Point, Unreachable
from passo.geometry.shoulder import Limits, at_end, reach, turned, why_it_ends

Positive = Annotated[float, Field(gt=0, le=1e4)]


class DualScara(GeometryModel):
    """Lengths in mm; shoulders at (shoulder_x, 0) plus the offsets; angles from +Y towards +X."""

    motors = ("a", "b", "z")
    rotary = ("a", "b")
    arms = ("a", "b")
    kind: Literal["dual_scara"]
    """Two arms that meet at the nozzle."""
    shoulder1_x: Offset = -50.0
    """X of the first shoulder, in mm."""
    shoulder2_x: Offset = 50.0
    """X of the second shoulder, in mm."""
    proximal1: Positive = 60.0
    """The length from the first shoulder to its elbow, in mm."""
    proximal2: Positive = 60.0
    """The length from the second shoulder to its elbow, in mm."""
    distal1: Positive = 70.0
    """The length from the first elbow to the nozzle, in mm."""
    distal2: Positive = 70.0
    """The length from the second elbow to the nozzle, in mm."""
    x_offset: Offset = 0.0
    """Added to X of both shoulders, in mm."""
    y_offset: Offset = 0.0
    """Y of both shoulders, in mm."""
    # For each arm, its direction to the nozzle in the middle of its angle range, degrees.
    _middles: tuple[float, float] = PrivateAttr((0.0, 0.0))

    def spec(self) -> dict[str, Any]:
        """Kind, parameters and the middles of the ranges of the angles."""
        return self.model_dump() | {"middles": list(self._middles)}

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """The angle range of each arm, one full turn, ends on the side opposite to the middle of
        the bed. Full turns are added until it contains the limits."""
        a, b = (degrees(atan2(*self._from_shoulder(arm, middle))) for arm in (0, 1))
        faced = self.model_copy()
        faced._middles = (a, b)
        try:
            at_a, at_b, _ = faced.inverse(middle)
        except Unreachable:
            return faced
        faced._middles = (a + turned(at_a, limits[0]), b + turned(at_b, limits[1]))
        return faced

    def edge(self, point: Point) -> str:
        """The boundary on the far side of a shoulder, where the angle range of its arm ends."""
        for arm, shoulder in enumerate((self.shoulder1_x, self.shoulder2_x)):
            dx, dy = self._from_shoulder(arm, point)
            if at_end(dx, dy, self._middles[arm]):
                return why_it_ends(shoulder + self.x_offset, self.y_offset)
        return super().edge(point)

    def options(self) -> dict[str, float]:
        """All of its parameters."""
        return {
            "SCARAArm1ShoulderXCoord": self.shoulder1_x,
            "SCARAArm2ShoulderXCoord": self.shoulder2_x,
            "SCARAArm1ProximalSideLength": self.proximal1,
            "SCARAArm2ProximalSideLength": self.proximal2,
            "SCARAArm1DistalSideLength": self.distal1,
            "SCARAArm2DistalSideLength": self.distal2,
            "SCARAXOffset": self.x_offset,
            "SCARAYOffset": self.y_offset,
        }

    def _from_shoulder(self, arm: int, point: Point) -> tuple[float, float]:
        shoulder = (self.shoulder1_x, self.shoulder2_x)[arm]
        return point[0] - self.x_offset - shoulder, point[1] - self.y_offset

    def reason(self, point: Point) -> str:
        """The reach of the arm that is too short, or the joint at the nozzle, which must stay
        convex."""
        for arm in (0, 1):
            d = hypot(*self._from_shoulder(arm, point))
            nearest, farthest = reach(
                (self.proximal1, self.proximal2)[arm], (self.distal1, self.distal2)[arm]
            )
            if not nearest <= d <= farthest:
                return (
                    f"arm {'AB'[arm]} reaches from {nearest:.3f} to {farthest:.3f} mm from its"
                    f" shoulder, not {d:.3f} mm"
                )
        return "" if self.reaches(point) else "the joint at the nozzle would fold through"
