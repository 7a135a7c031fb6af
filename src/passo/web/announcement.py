"""Announces a web interface in the local network by multicast DNS (RFC 6762, RFC 6763), so that
slicers and browsers list the printer. Needs the extra `passo[mdns]`."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import Awaitable, Callable
from ipaddress import ip_address
from typing import Protocol

from ifaddr import get_adapters
from zeroconf import ServiceInfo
from zeroconf.asyncio import AsyncZeroconf

from passo.errors import InputError
from passo.version import __version__

_log = logging.getLogger(__name__)

# Service browsers find the page; PrusaSlicer and Cura find the interface of OctoPrint; hubs find
# Passo's own.
_KINDS = ("_http._tcp.local.", "_octoprint._tcp.local.", "_passo._tcp.local.")
_LONGEST = 63  # bytes of a label (RFC 1035, 2.3.4)


class Registry(Protocol):
    """The methods of zeroconf that announce services."""

    async def async_register_service(
        self, info: ServiceInfo, *, allow_name_change: bool = ...
    ) -> Awaitable[object]:
        """Announces a service; with `allow_name_change`, under another name if its name is
        taken."""
        ...

    async def async_close(self) -> None:
        """Withdraws all services."""
        ...


class Announcement:
    """The announcement of a web interface that listens at an address; `0.0.0.0` and `::` mean all
    addresses of this computer. It contains the `host_name` of this computer, and the name and the
    id of the printer. Raises InputError for an address that no other computer can reach."""

    def __init__(self, machine: str, host: str, port: int, printer_id: str) -> None:
        address = ip_address(host.partition("%")[0])
        if address.is_loopback:
            raise InputError.of("web.announce-loopback", value=host)
        addresses = [host]
        if address.is_unspecified:
            addresses = _addresses()
        computer = socket.gethostname().partition(".")[0].lower()
        self.host_name = f"{computer}.local"
        name = f"{machine} on {computer}".encode()[:_LONGEST].decode(errors="ignore")
        known = {"path": "/", "version": __version__, "id": printer_id, "name": machine}
        self.services = [
            ServiceInfo(
                kind,
                f"{name.replace('.', '-')}.{kind}",
                port,
                properties=known,
                server=f"{self.host_name}.",
                parsed_addresses=addresses,
            )
            for kind in _KINDS
        ]

    async def run(self, registry: Callable[[], Registry] = AsyncZeroconf) -> None:
        """Announces the web interface until cancelled. A failure is only logged, because the web
        interface works without it."""
        try:
            registered = registry()
        except OSError as error:
            _failed(error)
            return
        try:
            for service in self.services:
                await registered.async_register_service(service, allow_name_change=True)
            await asyncio.get_running_loop().create_future()  # until cancelled
        except OSError as error:
            _failed(error)
        finally:
            await registered.async_close()


def _addresses() -> list[str]:
    """The addresses (IPv4) by which other computers reach this one."""
    found = [ip.ip for adapter in get_adapters() for ip in adapter.ips]
    return [ip for ip in found if isinstance(ip, str) and not ip_address(ip).is_loopback]


def _failed(error: OSError) -> None:
    _log.warning("The printer is not announced: %s", error.strerror or error)
