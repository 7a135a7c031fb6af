"""The nozzle is the probe: a piezo element, a strain gauge, or a contact to the bed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.probes.base import HeightOffset, SwitchProbe


class NozzleProbe(SwitchProbe):
    """The nozzle itself is the probe: a piezo element, a strain gauge, or a contact to the bed. It
    must be clean, and at most 150 °C warm. It may be triggered as the head brakes, so it settles
    before each descent."""

    kind: Literal["nozzle"]
    """The nozzle is the probe."""
    trigger_height_mm: HeightOffset = 0.0
    """The height of the nozzle above the bed at which the probe triggers."""
    settle_s: Annotated[float, Field(ge=0, le=10)] = 0.3
    """The pause before each descent."""
