"""The common base of all geometry models."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field

from passo import _core
from passo.geometry.shoulder import Limits

Point = tuple[float, float, float]
Offset = Annotated[float, Field(ge=-1e4, le=1e4)]


class Unreachable(ValueError):
    """No motor positions reach this point, or these positions give no point."""


class GeometryModel(BaseModel):
    """Parameters of a geometry. `actuators` names its motors, `rotary` those in degrees. If it
    `lifts_together`, a move of Z in the middle moves all of them alike. `arms` are the actuators
    that home by their own endstops, because no move of an axis moves one of them alone."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True
    )
    actuators: ClassVar[tuple[str, ...]]
    rotary: ClassVar[tuple[str, ...]] = ()
    lifts_together: ClassVar[bool] = False
    arms: ClassVar[tuple[str, ...]] = ()

    @property
    def square(self) -> Self:
        """The same geometry with axes at right angles, as the endstops have them."""
        return self

    def spec(self) -> dict[str, Any]:
        """Kind and parameters as plain numbers, for the core."""
        return self.model_dump()

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """The same geometry on a machine. `middle` is the middle of its axes, mm; `limits` are
        those of the positions of actuators, infinite without limits. Angles of arms that turn about
        a shoulder end on the far side of it, seen from that middle."""
        del middle, limits
        return self

    def options(self) -> dict[str, float]:
        """Its parameters by APrinter's names, lengths in mm; empty for a geometry without
        parameters."""
        return {}

    def inverse(self, point: Point) -> Point:
        """Positions of the actuators (mm or degrees) with the nozzle at `point` (mm), by the core.

        Raises Unreachable.
        """
        found = self._found(point)
        if found is None:
            raise Unreachable(self.reason(point) or self.edge(point))
        return found

    def _found(self, point: Point) -> Point | None:
        kernel = _core.Geometry(self.spec())
        a, b, c = (kernel.inverse(i, point) for i in range(3))
        return None if isnan(a) or isnan(b) or isnan(c) else (a, b, c)

    def forward(self, actuators: Point) -> Point:
        """The nozzle's position (mm) for these actuator positions, by the core. Raises
        Unreachable."""
        try:
            return _core.Geometry(self.spec()).forward(actuators)
        except ValueError:
            where = ", ".join(f"{q:g}" for q in actuators)
            raise Unreachable(f"no point belongs to the motor positions {where}") from None

    def reaches(self, point: Point) -> bool:
        """Whether the motors can reach this point (mm)."""
        return self._found(point) is not None

    def why_not(self, point: Point) -> str:
        """Why no line may lead over `point` (mm), which the core has refused."""
        return self.reason(point) or self.edge(point)

    def reason(self, point: Point) -> str:
        """What is too far from this point (mm), with value and limit; empty if nothing is."""
        del point
        return ""

    def edge(self, point: Point) -> str:
        """The boundary at this point (mm), next to which the motors reach other points."""
        del point
        return "it lies on the edge of what the motors reach"
