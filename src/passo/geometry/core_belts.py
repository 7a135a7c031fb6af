"""CoreXY, CoreXZ, CoreYZ: two motors move two axes together, A = u + v and B = u - v. Hybrids: one
belt A = u - v, and a motor for v alone."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from passo.geometry.skewable import SkewableModel

_End = Annotated[float, Field(ge=-1e6, le=1e6)]
_Reach = Annotated[list[_End], Field(min_length=2, max_length=2)]


class CoreBelts(SkewableModel):
    """Crossed belts."""

    reach_x_mm: _Reach | None = None
    """The first and last X that the carriage reaches, in mm. Needed with skew, which moves it
    beyond its axis."""
    reach_y_mm: _Reach | None = None
    """The same for Y."""

    def spec(self) -> dict[str, Any]:
        """See the base."""
        return self.model_dump(exclude={"reach_x_mm", "reach_y_mm"})


class CoreXY(CoreBelts):
    """A = X + Y, B = X - Y."""

    motors = ("a", "b", "z")
    kind: Literal["corexy"]
    """Crossed belts: A = X + Y, B = X − Y."""


class HybridCoreXY(CoreBelts):
    """A = X - Y."""

    motors = ("a", "y", "z")
    kind: Literal["hybrid_corexy"]
    """One crossed belt: A = X − Y; motors of Y and Z."""


class HybridCoreXZ(CoreBelts):
    """A = X - Z."""

    motors = ("a", "y", "z")
    kind: Literal["hybrid_corexz"]
    """One crossed belt: A = X − Z; motors of Y and Z."""


class CoreXZ(CoreBelts):
    """A = X + Z, B = X - Z."""

    motors = ("a", "y", "b")
    kind: Literal["corexz"]
    """Crossed belts: A = X + Z, B = X − Z."""


class CoreYZ(CoreBelts):
    """A = Y + Z, B = Y - Z."""

    motors = ("x", "a", "b")
    kind: Literal["coreyz"]
    """Crossed belts: A = Y + Z, B = Y − Z."""
