"""Groups of printers on one fuse."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.hub.call import HubCall
from passo.hub.views import PowerGroup
from passo.web.operation import operation
from passo.web.roles import Role


class PowerLimit(Struct, forbid_unknown_fields=True):
    """The greatest power of the heating printers of a group, W."""

    limit_w: Annotated[float, Meta(gt=0, le=1e6)]


@operation("power.list", "GET", "/power", Role.VIEWER)
async def groups(call: HubCall) -> list[PowerGroup]:
    """The power groups, and the power that their heating printers use."""
    return list(call.view().groups)


@operation("power.set", "PUT", "/power/{name}", Role.ADMIN, errors=("hub.store",))
async def set_limit(
    call: HubCall, name: Annotated[str, Meta(min_length=1, max_length=40)], body: PowerLimit
) -> PowerGroup:
    """Makes a power group, or changes its limit: a run starts only if the heating printers of its
    group stay below."""
    return await call.farm.set_power_group(name, body.limit_w, call.user)


@operation(
    "power.remove", "DELETE", "/power/{name}", Role.ADMIN, errors=("web.not-found", "hub.store")
)
async def remove(call: HubCall, name: str) -> None:
    """Removes a power group. Its printers belong to none then."""
    await call.farm.remove_power_group(name, call.user)
