"""The state that all handlers of one web interface share."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.web.slicers.octoprint_sessions import LoginSessions
from passo.web.summary import summary_of

if TYPE_CHECKING:
    from pathlib import Path

    from passo.web.access import Access
    from passo.web.accounts.accounts import Accounts
    from passo.web.bridge import Bridge
    from passo.web.files.metadata import MetadataReader
    from passo.web.files.uploads import Uploads
    from passo.web.firmware.builds import Builds
    from passo.web.firmware.flashes import Flashes
    from passo.web.logs import Logs
    from passo.web.summary import Summary
    from passo.web.temperature_history import TemperatureHistory

_MAX_REPLIES = 100


@dataclass(frozen=True, slots=True)
class Site:
    """One printer, whose id is `printer_id`, with its accounts, the uploads to its card, the facts
    about its files, the history of its temperatures, its logs, its builds of firmware, the boards
    that it flashes, and its state folder, None without one."""

    bridge: Bridge
    accounts: Accounts
    access: Access
    uploads: Uploads
    metadata: MetadataReader
    temperatures: TemperatureHistory
    logs: Logs
    builds: Builds
    flashes: Flashes
    printer_id: str
    state: Path | None = None
    rrf_replies: deque[str] = field(default_factory=lambda: deque(maxlen=_MAX_REPLIES))
    """Answers to lines of `rr_gcode`, until `rr_reply` takes them."""
    octoprint_sessions: LoginSessions = field(default_factory=LoginSessions)

    def summary(self, before: Summary | None = None) -> Summary:
        """The summary of the printer now; see `summary_of`. Never waits."""
        bridge = self.bridge
        return summary_of(self.printer_id, bridge.machine.name, bridge.latest().status, before)
