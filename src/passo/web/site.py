"""What all handlers of one web interface share."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.access import Access
    from passo.web.accounts.accounts import Accounts
    from passo.web.bridge import Bridge
    from passo.web.files.metadata import MetadataReader
    from passo.web.files.uploads import Uploads
    from passo.web.firmware.builds import Builds
    from passo.web.logs import Logs
    from passo.web.temperature_history import TemperatureHistory

_MAX_REPLIES = 100


@dataclass(frozen=True, slots=True)
class Site:
    """One printer, who may use it, the uploads that are on their way to its card, what is known of
    its files, what is kept of its past, its logs,
    and the firmware that is built."""

    bridge: Bridge
    accounts: Accounts
    access: Access
    uploads: Uploads
    metadata: MetadataReader
    temperatures: TemperatureHistory
    logs: Logs
    builds: Builds
    rrf_replies: deque[str] = field(default_factory=lambda: deque(maxlen=_MAX_REPLIES))
    """What lines that came by `rr_gcode` have answered, until `rr_reply` asks."""
