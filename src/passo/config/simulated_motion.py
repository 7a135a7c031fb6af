"""The vibration of head and bed, and the pressure in the nozzle, of a simulated printer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from passo.config.types import Model

_DAMPING = 0.1


class SimulatedMass(Model):
    """The head or the bed as a mass on the belt of an axis of a simulated printer. It vibrates when
    the motors accelerate."""

    frequency_hz: Annotated[float, Field(ge=5, le=500)]
    """The frequency of the vibration."""
    damping: Annotated[float, Field(ge=0.001, le=0.9)] = _DAMPING
    """The damping ratio: the vibration loses about 6 times this fraction of its amplitude in each
    cycle."""


# Typical frequencies of X, Y and Z in Hz. On a cartesian printer Y moves the bed, which is heavy;
# crossed belts move a light head, and Z is driven by stiff screws. The towers of a delta are alike.
_TYPICAL_HZ = {
    "cartesian": (55.0, 35.0, 110.0),
    "corexy": (70.0, 60.0, 110.0),
    "corexz": (60.0, 40.0, 60.0),
    "coreyz": (55.0, 60.0, 60.0),
    "delta": (50.0, 50.0, 90.0),
}
_OTHER_HZ = (45.0, 45.0, 90.0)  # rotary deltas and arms


def simulated_masses(
    kind: str, given: Mapping[str, SimulatedMass]
) -> tuple[SimulatedMass, SimulatedMass, SimulatedMass]:
    """The masses of X, Y and Z: those of the machine file, else typical ones for this geometry."""
    typical = zip("xyz", _TYPICAL_HZ.get(kind, _OTHER_HZ), strict=True)
    x, y, z = (given.get(name) or SimulatedMass(frequency_hz=hz) for name, hz in typical)
    return x, y, z
