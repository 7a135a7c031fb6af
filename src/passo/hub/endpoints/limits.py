"""Accounts that see and command only some printers."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.hub.call import HubCall
from passo.hub.limits import Limit
from passo.hub.views import Tag
from passo.web.operation import operation
from passo.web.roles import Role


class LimitTags(Struct, forbid_unknown_fields=True):
    """The tags of the printers of an account; none: all printers."""

    tags: Annotated[list[Tag], Meta(max_length=20)]


@operation("limits.list", "GET", "/limits", Role.ADMIN)
async def limits(call: HubCall) -> list[Limit]:
    """The accounts that see and command only printers with one of their tags."""
    return call.site.limits.all


@operation(
    "limits.set", "PUT", "/limits/{account}", Role.ADMIN, errors=("web.accounts",), fresh=True
)
async def set_limit(
    call: HubCall, account: Annotated[str, Meta(min_length=1, max_length=80)], body: LimitTags
) -> list[Limit]:
    """Limits an account, or an API key as `key NAME`, to printers with one of these tags; without
    tags, to no group. Administrators always see all printers."""
    await call.site.limits.set(account, body.tags)
    return call.site.limits.all
