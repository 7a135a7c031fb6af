"""Manual probing with a sheet of paper."""

from __future__ import annotations

from typing import Literal

from passo.probes.base import Probe


class ManualProbe(Probe):
    """A sheet of paper. At each point the user lowers the nozzle until the paper just moves (TESTZ,
    G1 Z), and sends ACCEPT."""

    kind: Literal["manual"]
    """A sheet of paper."""
