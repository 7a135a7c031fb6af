"""What all handlers of one web interface share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.access import Access
    from passo.web.bridge import Bridge


@dataclass(frozen=True, slots=True)
class Site:
    """One printer and who may use it."""

    bridge: Bridge
    access: Access
