"""A switch, or an inductive or a capacitive sensor, fixed to the head."""

from __future__ import annotations

from typing import Literal

from passo.probes.base import SwitchProbe


class FixedProbe(SwitchProbe):
    """A probe that is fixed to the head: a switch, or an inductive or a capacitive sensor. It
    measures the bed for G30, G32 and G29."""

    kind: Literal["fixed"]
    """Fixed to the head."""
