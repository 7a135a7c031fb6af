"""Cartesian: one motor for each axis."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field

from passo.geometry.base import GeometryModel

MAX_SKEW = 0.2
_Factor = Annotated[float, Field(ge=-MAX_SKEW, le=MAX_SKEW)]


class Cartesian(GeometryModel):
    """Every axis has its own motor."""

    actuators = ("x", "y", "z")
    kind: Literal["cartesian"]
    """A motor for each axis."""
    skew: Annotated[list[_Factor], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]
    """How far the axes are from right angles to each other: the factors of the planes XY, XZ and
    YZ, as M852 has them. Then the motors of X and Y need limits."""

    @property
    def square(self) -> Self:
        """The same geometry without skew."""
        return self.model_copy(update={"skew": [0.0, 0.0, 0.0]})

    @property
    def sheared_axes(self) -> str:
        """The axes whose motors also follow others."""
        xy, xz, yz = self.skew
        return "x" * bool(xy or xz) + "y" * bool(yz)
