"""What all handlers of one web interface share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.access import Access
    from passo.web.accounts.accounts import Accounts
    from passo.web.bridge import Bridge
    from passo.web.files.metadata import MetadataReader
    from passo.web.files.uploads import Uploads
    from passo.web.logs import Logs
    from passo.web.temperature_history import TemperatureHistory


@dataclass(frozen=True, slots=True)
class Site:
    """One printer, who may use it, the uploads that are on their way to its card, what is known of
    its files, what is kept of its past, and its logs."""

    bridge: Bridge
    accounts: Accounts
    access: Access
    uploads: Uploads
    metadata: MetadataReader
    temperatures: TemperatureHistory
    logs: Logs
