"""Cable winch: cables from fixed anchors hold the nozzle. A motor winds each cable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import dist
from typing import Annotated, Any, Literal, Self, cast

from pydantic import Field, PrivateAttr, model_validator

from passo import _core
from passo.geometry.base import GeometryModel, Offset, Point
from passo.geometry.shoulder import Limits

Anchor = Annotated[list[Offset], Field(min_length=3, max_length=3)]
_MOTORS = ("a", "b", "c", "d", "u", "v", "w", "q")  # letters that G1 does not use otherwise
_FEWEST, _NEAR_MM = 3, 1.0
_FLAT_MM2 = 1.0  # twice the area of a triangle whose corners lie on one line


class Winch(GeometryModel):
    """The position of a motor is the length of its cable, from the anchor to the nozzle."""

    motors = _MOTORS
    axes_of_arms = ()
    homes = False
    kind: Literal["winch"]
    """Cables from fixed anchors."""
    anchors: Annotated[list[Anchor], Field(min_length=_FEWEST, max_length=len(_MOTORS))]
    """X, Y and Z of the anchor of each cable, in mm, of three to eight cables."""
    _side: float = PrivateAttr(1.0)  # of three cables: 1 if the nozzle is below their anchors

    @model_validator(mode="after")
    def _no_line(self) -> Self:
        first, second, third = self.anchors[:_FEWEST]
        u, v = ([b - a for a, b in zip(first, end, strict=True)] for end in (second, third))
        if (
            dist((0, 0, 0), [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)])
            < _FLAT_MM2
        ):
            raise ValueError("the first three anchors must not lie on one line")
        return self

    @classmethod
    def motors_of(cls, data: Mapping[str, object]) -> tuple[str, ...]:
        """One for each anchor."""
        anchors = data.get("anchors")
        number = len(cast("list[object]", anchors)) if isinstance(anchors, list) else _FEWEST
        return cls.motors[: max(number, _FEWEST)]

    @property
    def actuators(self) -> tuple[str, ...]:
        """One for each anchor."""
        return self.motors[: len(self.anchors)]

    def spec(self) -> dict[str, Any]:
        """The coordinates of the anchors in one list, and the side of the nozzle."""
        flat = [mm for anchor in self.anchors for mm in anchor]
        return {"kind": self.kind, "anchors": flat, "side": self._side}

    def facing(self, middle: Point, limits: Sequence[Limits]) -> Self:
        """The middle of the axes is on the same side of three anchors as the nozzle."""
        del limits
        faced, found = self.model_copy(), self._found(middle)
        if found is not None:
            below, above = (
                _core.Geometry(self.spec() | {"side": side}).forward(found) for side in (1.0, -1.0)
            )
            faced._side = 1.0 if dist(below, middle) <= dist(above, middle) else -1.0
        return faced

    def reason(self, point: Point) -> str:
        """The cable that is too short."""
        for name, anchor in zip(self.actuators, self.anchors, strict=True):
            if (mm := dist(point, anchor)) < _NEAR_MM:
                return f"cable {name.upper()} is {mm:.3f} mm long there (limit {_NEAR_MM:g} mm)"
        return ""
