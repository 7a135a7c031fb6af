"""SCARA: an upper arm about the shoulder, a forearm at its end, Z by itself."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, hypot, radians, sin
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Offset, Point, Unreachable

Positive = Annotated[float, Field(gt=0, le=1e4)]


class Scara(GeometryModel):
    """Lengths in mm; the offsets are the shoulder's place. With `external_motor` the elbow's motor
    sits on the base and turns the forearm against the room, else against the upper arm."""

    actuators = ("a", "b", "z")
    rotary = ("a", "b")
    arms = ("a", "b")
    kind: Literal["scara"]
    arm1: Positive = 150.0
    arm2: Positive = 150.0
    external_motor: bool = True
    x_offset: Offset = 0.0
    y_offset: Offset = 0.0

    def options(self) -> dict[str, float]:
        """All of its parameters."""
        return {
            "SCARAArm1Length": self.arm1,
            "SCARAArm2Length": self.arm2,
            "SCARAExternalArm2Motor": float(self.external_motor),
            "SCARAXOffset": self.x_offset,
            "SCARAYOffset": self.y_offset,
        }

    def inverse(self, point: Point) -> Point:
        """Law of cosines: cos E = (d² - arm1² - arm2²) / (2 arm1 arm2), and the shoulder is less
        than d's direction by the angle between upper arm and d."""
        x, y = point[0] - self.x_offset, point[1] - self.y_offset
        d = hypot(x, y)
        cosine = (d**2 - self.arm1**2 - self.arm2**2) / (2 * self.arm1 * self.arm2)
        if abs(cosine) > 1 or d == 0:
            raise Unreachable(
                f"the arms reach from {abs(self.arm1 - self.arm2):.3f} to"
                f" {self.arm1 + self.arm2:.3f} mm from the shoulder, not {d:.3f} mm"
            )
        elbow = acos(cosine)
        shoulder = atan2(y, x) - acos((d**2 + self.arm1**2 - self.arm2**2) / (2 * self.arm1 * d))
        if not self.external_motor:
            return degrees(shoulder), degrees(elbow), point[2]
        forearm = atan2(y, x) + acos((d**2 + self.arm2**2 - self.arm1**2) / (2 * self.arm2 * d))
        return degrees(shoulder), degrees(forearm), point[2]

    def forward(self, actuators: Point) -> Point:
        """The end of the forearm, mm, for the motors' angles in degrees and Z in mm."""
        shoulder, elbow = radians(actuators[0]), radians(actuators[1])
        forearm = elbow if self.external_motor else shoulder + elbow
        x = self.arm1 * cos(shoulder) + self.arm2 * cos(forearm) + self.x_offset
        y = self.arm1 * sin(shoulder) + self.arm2 * sin(forearm) + self.y_offset
        return x, y, actuators[2]
