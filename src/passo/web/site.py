"""What all handlers of one web interface share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.access import Access
    from passo.web.bridge import Bridge
    from passo.web.temperature_history import TemperatureHistory


@dataclass(frozen=True, slots=True)
class Site:
    """One printer, who may use it, and what is kept of its past."""

    bridge: Bridge
    access: Access
    temperatures: TemperatureHistory
