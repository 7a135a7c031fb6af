"""The common base of all geometry models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isnan
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field

from passo import _core
from passo.geometry.shoulder import Limits

Point = tuple[float, float, float]
Joints = tuple[float, ...]
"""Positions of the actuators, mm or degrees, in their order."""
Offset = Annotated[float, Field(ge=-1e4, le=1e4)]


class Unreachable(ValueError):
    """No motor positions reach the point, or no point belongs to the motor positions."""


class GeometryModel(BaseModel):
    """The parameters of a geometry. `motors` names its actuators; those in `rotary` count in
    degrees, and those of them in `endless` turn without end. `arms` are actuators that need their
    own endstops, because no axis move moves one of them alone; they alone move the `axes_of_arms`.
    Arms in `free` may have no endstop: they are at 0 where homing finds them. If it
    `lifts_together`, a Z move in the middle moves all arms equally. `homes` is false if no switch
    can find the place of the nozzle."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True
    )
    motors: ClassVar[tuple[str, ...]]
    rotary: ClassVar[tuple[str, ...]] = ()
    endless: ClassVar[tuple[str, ...]] = ()
    free: ClassVar[tuple[str, ...]] = ()
    homes: ClassVar[bool] = True
    lifts_together: ClassVar[bool] = False
    arms: ClassVar[tuple[str, ...]] = ()
    axes_of_arms: ClassVar[tuple[str, ...]] = ("x", "y")

    @classmethod
    def motors_of(cls, data: Mapping[str, object]) -> tuple[str, ...]:
        """The actuators of a geometry with these unchecked parameters."""
        del data
        return cls.motors

    @property
    def actuators(self) -> tuple[str, ...]:
        """The names of its actuators."""
        return self.motors

    @property
    def square(self) -> Self:
        """The same geometry without skew: homing uses it."""
        return self

    def spec(self) -> dict[str, Any]:
        """The kind and the parameters as plain numbers, for the core."""
        return self.model_dump()

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """The same geometry on a machine. `middle` is the middle of its axes, mm; `limits` are
        those of the positions of actuators, infinite without limits. The angle range of an arm with
        a shoulder ends on the side of the shoulder that is away from the middle."""
        del middle, limits
        return self

    def options(self) -> dict[str, float]:
        """The parameters by APrinter's names, lengths in mm; empty for a geometry without
        parameters."""
        return {}

    def inverse(self, point: Point) -> Joints:
        """The actuator positions (mm or degrees) for the nozzle position `point` (mm). Computed by
        the core. Raises Unreachable.
        """
        found = self._found(point)
        if found is None:
            raise Unreachable(self.reason(point) or self.edge(point))
        return found

    def _found(self, point: Point) -> Joints | None:
        kernel = _core.Geometry(self.spec())
        found = tuple(kernel.inverse(i, point) for i in range(kernel.actuators))
        return None if any(map(isnan, found)) else found

    def forward(self, actuators: Sequence[float]) -> Point:
        """The nozzle position (mm) for the actuator positions (mm or degrees). Computed by the
        core. Raises Unreachable."""
        try:
            return _core.Geometry(self.spec()).forward(actuators)
        except ValueError:
            where = ", ".join(f"{q:g}" for q in actuators)
            raise Unreachable(f"no point belongs to the motor positions {where}") from None

    def reaches(self, point: Point) -> bool:
        """Whether the motors can reach this point (mm)."""
        return self._found(point) is not None

    def why_not(self, point: Point) -> str:
        """The reason why the core has refused a straight move that passes `point` (mm)."""
        return self.reason(point) or self.edge(point)

    def reason(self, point: Point) -> str:
        """The part that does not reach `point` (mm), with value and limit; empty if all parts reach
        it."""
        del point
        return ""

    def edge(self, point: Point) -> str:
        """The reason why no line may cross `point` (mm), although the motors reach the points
        around it."""
        del point
        return "it lies on the edge of what the motors reach"
