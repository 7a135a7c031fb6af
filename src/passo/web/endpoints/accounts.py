"""Accounts and API keys, for administrators."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from msgspec import Meta, Struct

from passo.web.accounts.accounts import Account, Key
from passo.web.call import ServerCall
from passo.web.endpoints.session import Name, NewPassword
from passo.web.operation import operation
from passo.web.roles import Role

RoleName: TypeAlias = Literal["viewer", "operator", "admin"]


class NewAccount(Struct, forbid_unknown_fields=True):
    """An account to make."""

    name: Name
    password: NewPassword
    role: RoleName


class AccountChange(Struct, forbid_unknown_fields=True):
    """The changes of an account; an omitted value stays."""

    password: NewPassword | None = None
    role: RoleName | None = None


class AccountRecord(Struct):
    """An account."""

    name: str
    role: RoleName


class NewKey(Struct, forbid_unknown_fields=True):
    """An API key to make; `name` describes its purpose."""

    name: Annotated[str, Meta(min_length=1, max_length=64)]
    role: RoleName = "operator"


class KeyRecord(Struct):
    """An API key, without its secret; `made_s` is in seconds since 1970."""

    id: str
    name: str
    role: RoleName
    made_s: float


class MadeKey(Struct):
    """A new key. `key` is shown only this once."""

    record: KeyRecord
    key: str


@operation("accounts.list", "GET", "/accounts", Role.ADMIN)
async def accounts(call: ServerCall) -> list[AccountRecord]:
    """All accounts."""
    return [_account(account) for account in call.accounts.all]


@operation(
    "accounts.add",
    "POST",
    "/accounts",
    Role.ADMIN,
    errors=("web.account-exists", "web.accounts"),
    status=201,
    fresh=True,
)
async def add(call: ServerCall, body: NewAccount) -> AccountRecord:
    """Makes an account."""
    made = await call.accounts.add(body.name, body.password, Role[body.role.upper()])
    return _account(made)


@operation(
    "accounts.change",
    "PATCH",
    "/accounts/{name}",
    Role.ADMIN,
    errors=("web.not-found", "web.last-administrator", "web.accounts"),
    fresh=True,
)
async def change(call: ServerCall, name: str, body: AccountChange) -> AccountRecord:
    """Changes the password or the role of an account, and ends its log-ins, except this one."""
    role = None if body.role is None else Role[body.role.upper()]
    changed = await call.accounts.change(
        name, password=body.password, role=role, but=call.caller.session
    )
    return _account(changed)


@operation(
    "accounts.remove",
    "DELETE",
    "/accounts/{name}",
    Role.ADMIN,
    errors=("web.not-found", "web.last-administrator", "web.accounts"),
    fresh=True,
)
async def remove(call: ServerCall, name: str) -> None:
    """Removes an account and ends its log-ins. One administrator stays."""
    await call.accounts.remove(name)


@operation("keys.list", "GET", "/keys", Role.ADMIN)
async def keys(call: ServerCall) -> list[KeyRecord]:
    """All API keys, without their secrets."""
    return [_key(key) for key in call.accounts.keys]


@operation(
    "keys.add",
    "POST",
    "/keys",
    Role.ADMIN,
    errors=("web.accounts",),
    status=201,
    fresh=True,
)
async def add_key(call: ServerCall, body: NewKey) -> MadeKey:
    """Makes an API key for a slicer or a script, which sends it in the header `X-Api-Key`."""
    key, token = await call.accounts.add_key(body.name, Role[body.role.upper()])
    return MadeKey(_key(key), token)


@operation(
    "keys.revoke",
    "DELETE",
    "/keys/{id}",
    Role.ADMIN,
    errors=("web.not-found", "web.accounts"),
    fresh=True,
)
async def revoke_key(call: ServerCall, id: str) -> None:
    """Makes a key invalid at once."""
    await call.accounts.revoke_key(id)


def _account(account: Account) -> AccountRecord:
    return AccountRecord(account.name, _ROLES[account.role])


def _key(key: Key) -> KeyRecord:
    return KeyRecord(key.id, key.name, _ROLES[key.role], key.made_s)


_ROLES: dict[Role, RoleName] = {
    Role.VIEWER: "viewer",
    Role.OPERATOR: "operator",
    Role.ADMIN: "admin",
}
