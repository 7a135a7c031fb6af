"""The maintenance of printers."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from passo.hub.call import HubCall
from passo.hub.wishes import ServiceInterval, ServiceItem
from passo.web.operation import operation
from passo.web.roles import Role


@operation("service.list", "GET", "/printers/{id}/service", Role.VIEWER, errors=("web.not-found",))
async def items(call: HubCall, id: str) -> list[ServiceItem]:
    """The maintenance items of a printer, and what has been printed since each was done."""
    call.printer(id)
    return await call.farm.service_items(id)


@operation(
    "service.set",
    "PUT",
    "/printers/{id}/service/{item}",
    Role.OPERATOR,
    errors=("web.not-found", "hub.store"),
)
async def set_item(
    call: HubCall,
    id: str,
    item: Annotated[str, Meta(min_length=1, max_length=80)],
    body: ServiceInterval,
) -> ServiceItem:
    """Makes or changes a maintenance item, or says that it is done."""
    call.printer(id)
    return await call.farm.set_service_item(id, item, body, call.user)


@operation(
    "service.remove",
    "DELETE",
    "/printers/{id}/service/{item}",
    Role.OPERATOR,
    errors=("web.not-found", "hub.store"),
)
async def remove(call: HubCall, id: str, item: str) -> None:
    """Removes a maintenance item."""
    call.printer(id)
    await call.farm.remove_service_item(id, item, call.user)
