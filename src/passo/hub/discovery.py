"""Finds printers that announce themselves in the local network by multicast DNS. Needs the extra
`passo[mdns]`."""

from __future__ import annotations

import asyncio
import logging

from zeroconf import IPVersion, ServiceStateChange, Zeroconf
from zeroconf.asyncio import AsyncServiceBrowser, AsyncServiceInfo, AsyncZeroconf

from passo.hub.proposals import Proposals, ProposedPrinter

_log = logging.getLogger(__name__)

SERVICE = "_passo._tcp.local."
_ANSWER_MS = 3000.0


async def discover(proposals: Proposals) -> None:
    """Proposes the printers that announce themselves, until cancelled. A failure is only logged,
    because printers can be added by their address."""
    try:
        multicast = AsyncZeroconf()
    except OSError as error:
        _log.warning("No printers are found by multicast DNS: %s", error.strerror or error)
        return
    asked: set[asyncio.Task[None]] = set()
    ids: dict[str, str] = {}

    async def ask(name: str) -> None:
        info = AsyncServiceInfo(SERVICE, name)
        if not await info.async_request(multicast.zeroconf, _ANSWER_MS):
            return
        if (found := proposed(info)) is not None:
            ids[name] = found.id
            proposals.announced(found)

    def changed(
        zeroconf: Zeroconf, service_type: str, name: str, state_change: ServiceStateChange
    ) -> None:
        if state_change is ServiceStateChange.Removed:
            proposals.withdrawn(ids.pop(name, ""))
            return
        task = asyncio.get_running_loop().create_task(ask(name))
        asked.add(task)
        task.add_done_callback(asked.discard)

    browser = AsyncServiceBrowser(multicast.zeroconf, SERVICE, handlers=[changed])
    try:
        await asyncio.get_running_loop().create_future()
    finally:
        for task in list(asked):
            task.cancel()
        await browser.async_cancel()
        await multicast.async_close()


def proposed(info: AsyncServiceInfo) -> ProposedPrinter | None:
    """The printer of an announcement; None if it lacks an id or an address."""
    texts = {
        key.decode(errors="replace"): (value or b"").decode(errors="replace")
        for key, value in info.properties.items()
    }
    addresses = info.parsed_addresses(IPVersion.V4Only) or info.parsed_addresses()
    if not texts.get("id") or not addresses or info.port is None:
        return None
    host = f"[{addresses[0]}]" if ":" in addresses[0] else addresses[0]
    name = texts.get("name") or info.name.partition(".")[0]
    return ProposedPrinter(texts["id"], name, f"http://{host}:{info.port}")
