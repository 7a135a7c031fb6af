"""Pairing: how a program that drives many printers gets its key for this one."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.web.accounts.one_time_code import LASTS_S
from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role


class MadeCode(Struct):
    """A one-time code, and the seconds for which it is valid."""

    code: str
    expires_s: float


class PairingRequest(Struct, forbid_unknown_fields=True):
    """The one-time code, and the name of the program: its key has this name. While there is no
    administrator, programs of this computer need no code if no other computer can reach the
    printer: any text will do."""

    code: Annotated[str, Meta(max_length=32)]
    name: Annotated[str, Meta(min_length=1, max_length=64)]


class Paired(Struct):
    """The id and the name of the printer, and the API key, with the role operator. The key is shown
    only this once."""

    id: str
    name: str
    key: str


@operation("pairing.make_code", "POST", "/pairing", Role.ADMIN, fresh=True)
async def make_code(call: Call) -> MadeCode:
    """Makes a one-time code, with which one program can pair (`pairing.pair`) within ten minutes.
    An earlier code becomes invalid."""
    return MadeCode(call.site.accounts.pairing.make(), LASTS_S)


@operation(
    "pairing.pair",
    "POST",
    "/pair",
    Role.PUBLIC,
    errors=("web.pairing", "web.too-many", "web.accounts"),
)
async def pair(call: Call, body: PairingRequest) -> Paired:
    """Makes an API key for a program that has a one-time code."""
    accounts, site = call.site.accounts, call.site
    if accounts.exist or site.access.needs_code(call.request):
        accounts.pairing.use(body.code, call.caller.address)
    _, token = await accounts.add_key(body.name, Role.OPERATOR)
    return Paired(site.printer_id, call.bridge.machine.name, token)
