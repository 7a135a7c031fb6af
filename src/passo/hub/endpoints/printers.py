"""The printers of the farm, and their commands."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, Meta, Struct
from starlette.responses import Response

from passo.errors import HubError, WebError
from passo.hub.call import HubCall
from passo.hub.proposals import ProposedPrinter
from passo.hub.views import Farm, PrinterView
from passo.hub.wishes import Attended, NewPrinter, PrinterChange, Stopped
from passo.web.operation import operation
from passo.web.roles import Role

_PRINTER = ("web.not-found", "hub.unreachable", "hub.refused", "hub.state", "hub.store")
_ADMIN_FIELDS = ("url", "power_group", "heating_w", "clears_itself", "tags")
_PICTURE = "image/png"


class BedClear(Struct, forbid_unknown_fields=True):
    """The user confirms that no print is left on the bed."""

    bed_clear: Annotated[bool, Meta(description="must be true, else nothing changes")]


@operation("farm.get", "GET", "/farm", Role.VIEWER)
async def farm(call: HubCall) -> Farm:
    """The whole farm, as the first message of the feed."""
    return call.view()


@operation("printers.list", "GET", "/printers", Role.VIEWER)
async def printers(call: HubCall) -> list[PrinterView]:
    """The printers that the caller sees."""
    return list(call.view().printers)


@operation(
    "printers.add",
    "POST",
    "/printers",
    Role.ADMIN,
    errors=("hub.address", "hub.code", "hub.known", "hub.unreachable", "hub.refused", "hub.store"),
    status=201,
)
async def add(call: HubCall, body: NewPrinter) -> PrinterView:
    """Adds a printer by its address. A Passo printer that needs a key gives one for a one-time
    code, which its administrator makes on its page."""
    record = await call.site.pair(body)
    return await call.farm.add_printer(record, body.tags, call.user)


@operation("printers.proposed", "GET", "/printers/proposed", Role.ADMIN)
async def proposed(call: HubCall) -> list[ProposedPrinter]:
    """Printers that announce themselves in the local network and are not in the farm."""
    return call.site.proposals.but({printer.id for printer in call.farm.view().printers})


@operation(
    "printers.change",
    "PATCH",
    "/printers/{id}",
    Role.OPERATOR,
    errors=("web.not-found", "hub.address", "hub.store"),
)
async def change(call: HubCall, id: str, body: PrinterChange) -> PrinterView:
    """Changes what the hub knows of a printer. Its address, tags, power and whether it clears its
    bed itself are for administrators."""
    call.printer(id)
    if any(getattr(body, field) is not UNSET for field in _ADMIN_FIELDS):
        call.access.require(call.caller, Role.ADMIN)
    if body.url is not UNSET and not body.url.startswith(("http://", "https://")):
        raise HubError.of("hub.address", value=body.url)
    return await call.farm.change_printer(id, body, call.user)


@operation(
    "printers.remove",
    "DELETE",
    "/printers/{id}",
    Role.ADMIN,
    errors=("web.not-found", "hub.state", "hub.store"),
)
async def remove(call: HubCall, id: str) -> None:
    """Removes a printer that has no run. Its history stays."""
    await call.farm.remove_printer(id, call.user)


@operation(
    "printers.clear",
    "POST",
    "/printers/{id}/clear",
    Role.OPERATOR,
    errors=("web.not-found", "hub.state", "hub.store", "queue.bed"),
)
async def clear(call: HubCall, id: str, body: BedClear) -> PrinterView:
    """Confirms that the bed is empty: the next run may start."""
    call.printer(id)
    if not body.bed_clear:
        raise WebError.of("queue.bed")
    return await call.farm.clear(id, call.user)


@operation(
    "printers.attend",
    "POST",
    "/printers/{id}/attend",
    Role.OPERATOR,
    errors=("web.not-found", "hub.state", "hub.store"),
)
async def attend(call: HubCall, id: str, body: Attended) -> PrinterView:
    """Confirms that a user has dealt with the printer's attention."""
    call.printer(id)
    return await call.farm.attend(id, body.started, call.user)


@operation("printers.pause", "POST", "/printers/{id}/pause", Role.OPERATOR, errors=_PRINTER)
async def pause(call: HubCall, id: str) -> None:
    """Pauses the print."""
    call.printer(id)
    await call.farm.pause(id, call.user)


@operation("printers.resume", "POST", "/printers/{id}/resume", Role.OPERATOR, errors=_PRINTER)
async def resume(call: HubCall, id: str) -> None:
    """Resumes the print."""
    call.printer(id)
    await call.farm.resume(id, call.user)


@operation("printers.cancel", "POST", "/printers/{id}/cancel", Role.OPERATOR, errors=_PRINTER)
async def cancel(call: HubCall, id: str) -> None:
    """Cancels the print."""
    call.printer(id)
    await call.farm.cancel(id, call.user)


@operation("printers.stop", "POST", "/printers/{id}/stop", Role.OPERATOR, errors=("web.not-found",))
async def stop(call: HubCall, id: str) -> Stopped:
    """Emergency stop: halts a printer."""
    call.printer(id)
    return (await call.farm.stop([id], call.user))[0]


@operation("printers.stop_all", "POST", "/stop", Role.OPERATOR)
async def stop_all(call: HubCall) -> list[Stopped]:
    """Emergency stop of all printers that the caller sees, at the same time."""
    return await call.farm.stop([printer.id for printer in call.view().printers], call.user)


@operation(
    "printers.picture",
    "GET",
    "/printers/{id}/picture",
    Role.VIEWER,
    errors=("web.not-found", "hub.unreachable", "hub.refused"),
    produces=_PICTURE,
)
async def picture(call: HubCall, id: str) -> Response:
    """The picture of the running print, as the slicer has made it."""
    call.printer(id)
    data = await call.farm.picture(id)
    if not data:
        raise WebError.of("web.not-found", value=f"picture of printer {id}")
    return Response(data, media_type=_PICTURE, headers={"Cache-Control": "no-cache"})
