"""Rotational delta: three arms turn on the base, rods hang the effector from their elbows."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, hypot, pi, radians, sin, sqrt
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Offset, Point, Unreachable, trilaterate

Positive = Annotated[float, Field(gt=0, le=1e4)]


class RotaryDelta(GeometryModel):
    """Lengths in mm: sides of effector and base, rods, arms, height of the base above Z 0."""

    actuators = ("a", "b", "c")
    rotary = ("a", "b", "c")
    lifts_together = True
    arms = ("a", "b", "c")
    kind: Literal["rotary_delta"]
    """Three arms that turn down from the base, at 0°, +120° and −120° about Z."""
    effector_length: Positive = 30.0
    """The side of the triangle of the effector, in mm."""
    base_length: Positive = 40.0
    """The side of the triangle of the base, in mm."""
    rod_length: Positive = 130.0
    """The length of a rod, in mm."""
    arm_length: Positive = 80.0
    """The length of an arm, in mm."""
    z_offset: Offset = 200.0
    """The height of the base above Z 0, in mm."""

    def options(self) -> dict[str, float]:
        """All of its parameters."""
        return {
            "DeltaEndEffectorLength": self.effector_length,
            "DeltaBaseLength": self.base_length,
            "DeltaRodLength": self.rod_length,
            "DeltaArmLength": self.arm_length,
            "DeltaZOffset": self.z_offset,
        }

    def inverse(self, point: Point) -> Point:
        """Degrees below the horizon of the arms at 0, +120 and -120 degrees about Z."""
        a, b, c = (
            self._arm(name, point, radians(turn))
            for name, turn in zip("ABC", (0, 120, -120), strict=True)
        )
        return a, b, c

    def _arm(self, name: str, point: Point, turn: float) -> float:
        """The elbow is at arm length from the shoulder and at rod length from the joint; of the two
        crossings of these circles it is the outer one."""
        px, py, pz = point
        x = px * cos(turn) + py * sin(turn)
        y = (
            py * cos(turn)
            - px * sin(turn)
            + (self.base_length - self.effector_length) / (2 * sqrt(3))
        )
        z = pz - self.z_offset
        reach = hypot(y, z)
        side = reach**2 + self.arm_length**2 - self.rod_length**2 + x**2
        full = 2 * self.arm_length * reach  # 0 on the shoulder's axis: no way to point at
        if abs(side) > full or full == 0:
            rod = sqrt(max(self.rod_length**2 - x**2, 0.0))
            raise Unreachable(
                f"arm {name} and its rod reach from {abs(self.arm_length - rod):.3f} to"
                f" {self.arm_length + rod:.3f} mm there, not {reach:.3f} mm"
            )
        angle = atan2(z, y) - acos(side / full) + pi  # from -pi on
        return degrees(angle - 2 * pi if angle > pi else angle)

    def forward(self, actuators: Point) -> Point:
        """The lower point at rod length from the elbows, moved inward by the effector's size."""
        centres: list[Point] = []
        inward = (self.effector_length - self.base_length) / (2 * sqrt(3))
        for turn, q in zip((0, 120, -120), actuators, strict=True):
            y = inward - self.arm_length * cos(radians(q))
            z = self.z_offset - self.arm_length * sin(radians(q))
            centres.append((-y * sin(radians(turn)), y * cos(radians(turn)), z))
        return trilaterate(
            (centres[0], centres[1], centres[2]),
            (self.rod_length, self.rod_length, self.rod_length),
        )
