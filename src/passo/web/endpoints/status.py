"""The status of the printer, and the version of the server."""

from __future__ import annotations

from msgspec import Struct

from passo.printer.status import Status
from passo.version import __version__
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class StatusNow(Struct):
    """The status, and a number that increases with each change of it."""

    version: int
    status: Status


class Version(Struct):
    """The version of Passo, and the name of the machine."""

    passo: str
    machine: str


@operation("status.get", "GET", "/status", Role.VIEWER)
async def status(call: Call) -> StatusNow:
    """The current status: state, positions, heaters, fans, the print, faults. The WebSocket
    `/api/v1/feed` reports its changes. Numbers that are not finite are null."""
    snapshot = call.bridge.latest()
    return StatusNow(snapshot.version, snapshot.status)


@operation("status.version", "GET", "/version", Role.VIEWER)
async def version(call: Call) -> Version:
    """The version of Passo, and the name of its machine."""
    return Version(__version__, call.bridge.machine.name)


@operation("status.places", "GET", "/places", Role.OPERATOR)
async def places(call: Call) -> list[str]:
    """The addresses for hosts, browsers and Moonraker, each with its kind."""
    return list(call.bridge.places)
