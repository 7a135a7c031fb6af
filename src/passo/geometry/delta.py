"""Linear delta: three carriages on vertical towers; rods of fixed length connect them to the
effector."""

from __future__ import annotations

from math import cos, hypot, radians, sin, sqrt
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Point

Positive = Annotated[float, Field(gt=0, le=1e4)]
ANGLES = (210.0, 330.0, 90.0)  # of the usual towers
Angle = Annotated[float, Field(ge=-360, le=360)]


def rise_mm(rod_mm: float, radius_mm: float) -> float:
    """The height of a carriage above a nozzle in the middle, mm. Raises ValueError for a rod that
    is shorter than the radius."""
    return sqrt(rod_mm**2 - radius_mm**2)


class Delta(GeometryModel):
    """Lengths in mm. `radius` is the distance from a tower to the middle, less the offsets of
    effector and carriage."""

    motors = ("a", "b", "c")
    lifts_together = True
    arms = ("a", "b", "c")
    axes_of_arms = ("x", "y", "z")
    kind: Literal["delta"]
    """Carriages on three towers."""
    radius: Positive
    """The distance from a tower to the middle, less the offsets of effector and carriage, in mm."""
    rods: Annotated[list[Positive], Field(min_length=3, max_length=3)]
    """The lengths of the three rods, in mm."""
    angles: Annotated[list[Angle], Field(min_length=3, max_length=3)] = [*ANGLES]
    """The directions of the towers, from +X towards +Y, in degrees."""
    limit_radius: Positive
    """The maximum distance of the nozzle from the middle, in mm."""

    @property
    def towers(self) -> list[tuple[float, float]]:
        """X, Y of the towers, mm."""
        return [
            (self.radius * cos(radians(angle)), self.radius * sin(radians(angle)))
            for angle in self.angles
        ]

    def options(self) -> dict[str, float]:
        """The parameters by APrinter's names, lengths in mm. APrinter subtracts both offsets from
        its rod radius; `radius` has them subtracted already."""
        first, *_ = self.rods
        corrections = {f"DeltaDiagonalRodCorr{i}": r - first for i, r in enumerate(self.rods, 1)}
        return {
            "DeltaDiagonalRod": first,
            **corrections,
            "DeltaSmoothRodOffset": self.radius,
            "DeltaEffectorOffset": 0.0,
            "DeltaCarriageOffset": 0.0,
            "DeltaLimitRadius": self.limit_radius,
        }

    def reason(self, point: Point) -> str:
        """The limit radius that the point exceeds, or the rod that is too short."""
        x, y, _ = point
        if x * x + y * y > self.limit_radius**2:
            return f"it is {hypot(x, y):.3f} mm from the middle (limit {self.limit_radius:.3f} mm)"
        for name, (tx, ty), rod in zip("ABC", self.towers, self.rods, strict=True):
            if (far := hypot(tx - x, ty - y)) > rod:
                return f"it is {far:.3f} mm from tower {name}, whose rod is {rod:.3f} mm long"
        return ""
