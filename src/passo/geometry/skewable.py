"""Geometries whose axes need not be at right angles to each other."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field

from passo.geometry.base import GeometryModel, Point

MAX_SKEW = 0.2
_Factor = Annotated[float, Field(ge=-MAX_SKEW, le=MAX_SKEW)]


class SkewableModel(GeometryModel):
    """Motors that move axes on straight lines."""

    skew: Annotated[list[_Factor], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]
    """How far the axes are from right angles to each other: the factors of the planes XY, XZ and
    YZ, as M852 has them. With skew, the machine file must give the range of the carriages."""

    @property
    def square(self) -> Self:
        """The same geometry without skew."""
        return self.model_copy(update={"skew": [0.0, 0.0, 0.0]})

    @property
    def sheared_axes(self) -> str:
        """The axes whose carriages also follow others."""
        xy, xz, yz = self.skew
        return "x" * bool(xy or xz) + "y" * bool(yz)

    def carriages(self, point: Point) -> Point:
        """The positions of the axes' carriages, mm, when the nozzle is at a point, by the formula
        of `core/geometry/skewed.hpp`."""
        (xy, xz, yz), (x, y, z) = self.skew, point
        return x - y * xy - z * (xz - xy * yz), y - z * yz, z
