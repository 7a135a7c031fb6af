"""Every geometry, by the `kind` in a machine file. A new geometry is one file and one entry
here."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.geometry.cartesian import Cartesian
from passo.geometry.core_belts import CoreXY, CoreXZ, CoreYZ, HybridCoreXY, HybridCoreXZ
from passo.geometry.delta import Delta
from passo.geometry.deltesian import Deltesian
from passo.geometry.dual_scara import DualScara
from passo.geometry.motionless import Motionless
from passo.geometry.polar import Polar
from passo.geometry.rotary_delta import RotaryDelta
from passo.geometry.scara import Scara
from passo.geometry.winch import Winch

_BELTS = (CoreXY, CoreXZ, CoreYZ, HybridCoreXY, HybridCoreXZ)
_OTHERS = (Polar, Winch, Motionless)
GEOMETRIES = (Cartesian, *_BELTS, Delta, Deltesian, RotaryDelta, Scara, DualScara, *_OTHERS)

AnyGeometry = Annotated[
    Cartesian
    | CoreXY
    | CoreXZ
    | CoreYZ
    | HybridCoreXY
    | HybridCoreXZ
    | Delta
    | Deltesian
    | RotaryDelta
    | Scara
    | DualScara
    | Polar
    | Winch
    | Motionless,
    Field(discriminator="kind"),
]
