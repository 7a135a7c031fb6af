"""Rotational delta: three arms turn on the base, and rods connect their elbows to the effector."""

from __future__ import annotations

from math import cos, hypot, radians, sin, sqrt
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Offset, Point

Positive = Annotated[float, Field(gt=0, le=1e4)]


class RotaryDelta(GeometryModel):
    """Lengths in mm: sides of effector and base, rods, arms, height of the base above Z 0."""

    motors = ("a", "b", "c")
    rotary = ("a", "b", "c")
    lifts_together = True
    arms = ("a", "b", "c")
    axes_of_arms = ("x", "y", "z")
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

    def reason(self, point: Point) -> str:
        """The arm (at 0, +120 or -120 degrees about Z) that does not reach the point: no elbow
        position is at arm length from the shoulder and at rod length from the joint."""
        for name, turn in zip("ABC", (0.0, radians(120), radians(-120)), strict=True):
            px, py, pz = point
            x = px * cos(turn) + py * sin(turn)
            inward = (self.base_length - self.effector_length) / (2 * sqrt(3))
            reach = hypot(py * cos(turn) - px * sin(turn) + inward, pz - self.z_offset)
            rod = sqrt(max(self.rod_length**2 - x**2, 0.0))
            low, high = abs(self.arm_length - rod), self.arm_length + rod
            if abs(x) > self.rod_length or reach == 0 or not low <= reach <= high:
                return (
                    f"arm {name} and its rod reach from {low:.3f} to {high:.3f} mm there,"
                    f" not {reach:.3f} mm"
                )
        return ""
