"""Linear delta: three carriages on vertical towers, rods of fixed length to the effector."""

from __future__ import annotations

from math import cos, hypot, radians, sin, sqrt
from typing import Annotated, Literal

from pydantic import Field

from passo.geometry.base import GeometryModel, Point, Unreachable, trilaterate

Positive = Annotated[float, Field(gt=0, le=1e4)]
Angle = Annotated[float, Field(ge=-360, le=360)]


class Delta(GeometryModel):
    """Lengths in mm. `radius`: tower to middle, less the offsets of effector and carriage."""

    actuators = ("a", "b", "c")
    lifts_together = True
    arms = ("a", "b", "c")
    kind: Literal["delta"]
    """Carriages on three towers."""
    radius: Positive
    """The distance from a tower to the middle, less the offsets of effector and carriage, in mm."""
    rods: Annotated[list[Positive], Field(min_length=3, max_length=3)]
    """The lengths of the three rods, in mm."""
    angles: Annotated[list[Angle], Field(min_length=3, max_length=3)] = [210.0, 330.0, 90.0]
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
        """APrinter subtracts both offsets from what its rods stand on; `radius` has none left."""
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

    def inverse(self, point: Point) -> Point:
        """Height of carriage i: z + √(rod_i² - (tower_x - x)² - (tower_y - y)²)."""
        x, y, z = point
        if x * x + y * y > self.limit_radius**2:
            raise Unreachable(
                f"it is {sqrt(x * x + y * y):.3f} mm from the middle,"
                f" of at most {self.limit_radius:.3f} mm"
            )
        heights: list[float] = []
        for name, (tx, ty), rod in zip("ABC", self.towers, self.rods, strict=True):
            square = rod**2 - (tx - x) ** 2 - (ty - y) ** 2
            if square < 0:
                raise Unreachable(
                    f"it is {hypot(tx - x, ty - y):.3f} mm from tower {name}, of at most the"
                    f" {rod:.3f} mm of its rod"
                )
            heights.append(z + sqrt(square))
        return heights[0], heights[1], heights[2]

    def forward(self, actuators: Point) -> Point:
        """The lower point at rod length from the three carriages."""
        a, b, c = ((*tower, q) for tower, q in zip(self.towers, actuators, strict=True))
        return trilaterate((a, b, c), (self.rods[0], self.rods[1], self.rods[2]))
