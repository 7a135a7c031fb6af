"""What every geometry model has in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field

from passo.geometry.shoulder import Limits

Point = tuple[float, float, float]
Offset = Annotated[float, Field(ge=-1e4, le=1e4)]


class Unreachable(ValueError):
    """No motor positions lead to this point, or these positions lead to no point."""


class GeometryModel(BaseModel):
    """Parameters of a geometry. `actuators` names its motors, `rotary` those in degrees; where it
    `lifts_together`, a move of Z in the middle moves all of them alike. `arms` are the actuators
    that find their own switches, since no move of an axis moves one of them alone."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True
    )
    actuators: ClassVar[tuple[str, ...]]
    rotary: ClassVar[tuple[str, ...]] = ()
    lifts_together: ClassVar[bool] = False
    arms: ClassVar[tuple[str, ...]] = ()

    def spec(self) -> dict[str, Any]:
        """Kind and parameters as plain numbers, for the core."""
        return self.model_dump()

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """This geometry on a machine: `middle` is that of its axes, mm, and `limits` are those of
        the actuators' positions, infinite where there are none. Angles of arms that turn about a
        shoulder end behind it, as seen from that middle."""
        del middle, limits
        return self

    def options(self) -> dict[str, float]:
        """Its parameters by APrinter's names, lengths in mm; none of a geometry without any."""
        return {}

    def inverse(self, point: Point) -> Point:
        """Positions of the actuators (mm or degrees) with the nozzle at `point` (mm).

        Raises Unreachable.
        """
        raise Unreachable(f"{type(self).__name__} reaches no point such as {point}")

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position (mm) for these actuator positions. Raises Unreachable."""
        raise Unreachable(f"{type(self).__name__} has no point for {actuators}")

    def why_not(self, point: Point) -> str:
        """Why no line may lead over `point` (mm), which the core has refused."""
        try:
            self.inverse(point)
        except Unreachable as error:
            return str(error)
        return self.edge(point)

    def edge(self, point: Point) -> str:
        """What ends at this point (mm), next to which the motors reach others."""
        del point
        return "it lies on the edge of what the motors reach"


def trilaterate(centres: tuple[Point, Point, Point], radii: Point) -> Point:
    """The lower of the two points at `radii` from three centres. Raises Unreachable.

    In a frame with the first centre as origin, the second on its x axis and the third in its plane:
    x = (r1² - r2² + u²) / 2u, y = (r1² - r3² + i² + j² - 2ix) / 2j, z² = r1² - x² - y².
    """
    a, b, c = centres
    ab = [q - p for p, q in zip(a, b, strict=True)]
    ac = [q - p for p, q in zip(a, c, strict=True)]
    u = sum(v * v for v in ab) ** 0.5
    ex = [v / u for v in ab]
    i = sum(p * q for p, q in zip(ex, ac, strict=True))
    across = [q - i * p for p, q in zip(ex, ac, strict=True)]
    j = sum(v * v for v in across) ** 0.5
    ey = [v / j for v in across]
    ez = [ex[k - 2] * ey[k - 1] - ex[k - 1] * ey[k - 2] for k in range(3)]
    r1, r2, r3 = radii
    x = (r1**2 - r2**2 + u**2) / (2 * u)
    y = (r1**2 - r3**2 + i**2 + j**2 - 2 * i * x) / (2 * j)
    square = r1**2 - x**2 - y**2
    if square < 0:
        raise Unreachable(f"the rods do not meet: {-square:.3f} mm² are missing")
    z = square**0.5 * (-1 if ez[2] > 0 else 1)
    px, py, pz = (a[k] + x * ex[k] + y * ey[k] + z * ez[k] for k in range(3))
    return px, py, pz
