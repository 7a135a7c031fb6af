"""Dual-arm SCARA (five-bar): two arms from two shoulders meet at the nozzle, Z by itself."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, hypot, radians, sin, sqrt
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Offset, Point, Unreachable

Positive = Annotated[float, Field(gt=0, le=1e4)]


class DualScara(GeometryModel):
    """Lengths in mm; shoulders at (shoulder_x, 0) less the offsets; angles from +Y towards +X."""

    actuators = ("a", "b", "z")
    rotary = ("a", "b")
    arms = ("a", "b")
    kind: Literal["dual_scara"]
    shoulder1_x: Offset = -50.0
    shoulder2_x: Offset = 50.0
    proximal1: Positive = 60.0
    proximal2: Positive = 60.0
    distal1: Positive = 70.0
    distal2: Positive = 70.0
    x_offset: Offset = 0.0
    y_offset: Offset = 0.0

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

    def _elbow(self, arm: int, angle: float) -> tuple[float, float]:
        shoulder = (self.shoulder1_x, self.shoulder2_x)[arm]
        proximal = (self.proximal1, self.proximal2)[arm]
        return shoulder + proximal * sin(radians(angle)), proximal * cos(radians(angle))

    def inverse(self, point: Point) -> Point:
        """The outer of the elbow's two places; the joint at the nozzle must stay convex."""
        x, y = point[0] - self.x_offset, point[1] - self.y_offset
        angles: list[float] = []
        for arm, outside in ((0, -1), (1, 1)):
            dx = x - (self.shoulder1_x, self.shoulder2_x)[arm]
            proximal = (self.proximal1, self.proximal2)[arm]
            distal = (self.distal1, self.distal2)[arm]
            reach = hypot(dx, y)
            cosine = (reach**2 + proximal**2 - distal**2) / (2 * proximal * reach) if reach else 2
            if abs(cosine) > 1:
                raise Unreachable(
                    f"arm {'AB'[arm]} reaches from {abs(proximal - distal):.3f} to"
                    f" {proximal + distal:.3f} mm from its shoulder, not {reach:.3f} mm"
                )
            angles.append(degrees(atan2(dx, y) + outside * acos(cosine)))
        (ax, ay), (bx, by) = self._elbow(0, angles[0]), self._elbow(1, angles[1])
        if (bx - ax) * (y - ay) - (by - ay) * (x - ax) <= 0:
            raise Unreachable("the joint at the nozzle would fold through")
        return angles[0], angles[1], point[2]

    def forward(self, actuators: Point) -> Point:
        """The upper crossing of the two forearms' circles."""
        (ax, ay), (bx, by) = self._elbow(0, actuators[0]), self._elbow(1, actuators[1])
        dx, dy = bx - ax, by - ay
        square = dx * dx + dy * dy
        along = (self.distal1**2 - self.distal2**2 + square) / (2 * square)
        rest = self.distal1**2 / square - along**2
        if rest < 0:
            raise Unreachable("the forearms do not meet")
        across = sqrt(rest)
        x = ax + along * dx - across * dy + self.x_offset
        y = ay + along * dy + across * dx + self.y_offset
        return x, y, actuators[2]
