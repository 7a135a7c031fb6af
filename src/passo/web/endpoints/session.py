"""Log-ins: the first administrator, log in, log out, and the caller's sessions."""

from __future__ import annotations

from typing import Annotated, TypeAlias

from msgspec import Meta, Struct

from passo.errors import WebError
from passo.web.accounts.accounts import MAX_AGE_S, digest
from passo.web.answers import Answer
from passo.web.call import ServerCall
from passo.web.operation import operation
from passo.web.roles import Role

Name: TypeAlias = Annotated[str, Meta(pattern=r"^[A-Za-z0-9._@-]{1,64}$")]
NewPassword: TypeAlias = Annotated[str, Meta(min_length=8, max_length=200)]
GivenPassword: TypeAlias = Annotated[str, Meta(max_length=200)]


class Administrator(Struct, forbid_unknown_fields=True):
    """The first account. `code` is the one-time code of `passo serve`, if `code_needed`."""

    name: Name
    password: NewPassword
    code: Annotated[str, Meta(max_length=32)] = ""


class LogIn(Struct, forbid_unknown_fields=True):
    """A name and its password."""

    name: Annotated[str, Meta(max_length=64)]
    password: GivenPassword


class Password(Struct, forbid_unknown_fields=True):
    """The password of the log-in."""

    password: GivenPassword


class PasswordChange(Struct, forbid_unknown_fields=True):
    """The present password, and the new one."""

    old: GivenPassword
    new: NewPassword


class Identity(Struct):
    """The identity of the caller. `role` is `public` without a log-in. `set_up`: there is an
    administrator. `code_needed`: to create the administrator, the one-time code is needed. `fresh`:
    the password was entered within the last five minutes."""

    name: str
    role: str
    set_up: bool
    code_needed: bool
    fresh: bool


class LogInRecord(Struct):
    """A log-in of an account, with times in seconds since 1970. `own`: it is the caller's."""

    id: str
    account: str
    started_s: float
    used_s: float
    own: bool


@operation("session.get", "GET", "/session", Role.PUBLIC)
async def identity(call: ServerCall) -> Identity:
    """The identity of the caller, and whether there is an administrator."""
    caller, accounts = call.caller, call.accounts
    needed = not accounts.exist and call.access.needs_code(call.request)
    fresh = accounts.fresh(caller.session)
    return Identity(caller.name, str(caller.role), accounts.exist, needed, fresh)


@operation(
    "session.set_up",
    "POST",
    "/session/administrator",
    Role.PUBLIC,
    errors=("web.set-up", "web.code", "web.too-many", "web.accounts"),
)
async def set_up(call: ServerCall, body: Administrator) -> Answer[Identity]:
    """Creates the administrator, once, and logs in. From another computer, this needs the one-time
    code that `passo serve` prints."""
    code = body.code if call.access.needs_code(call.request) else None
    accounts = call.accounts
    token = await accounts.create_administrator(body.name, body.password, call.caller.address, code)
    return _with_cookie(call, token)


@operation(
    "session.log_in",
    "POST",
    "/session",
    Role.PUBLIC,
    errors=("web.credentials", "web.too-many", "web.accounts"),
)
async def log_in(call: ServerCall, body: LogIn) -> Answer[Identity]:
    """Logs in: the answer sets a cookie."""
    token = await call.accounts.log_in(body.name, body.password, call.caller.address)
    return _with_cookie(call, token)


@operation("session.log_out", "DELETE", "/session", Role.VIEWER, errors=("web.accounts",))
async def log_out(call: ServerCall) -> None:
    """Ends the log-in of the cookie."""
    if call.caller.session:
        await call.accounts.end(call.caller.session)


@operation(
    "session.confirm",
    "POST",
    "/session/password",
    Role.VIEWER,
    errors=("web.credentials", "web.too-many", "web.not-found"),
)
async def confirm(call: ServerCall, body: Password) -> None:
    """Confirms the password, which allows operations that need it for the next five minutes."""
    accounts = call.accounts
    await accounts.confirm(_own(call), body.password, call.caller.address)


@operation(
    "session.change_password",
    "PUT",
    "/session/password",
    Role.VIEWER,
    errors=("web.credentials", "web.too-many", "web.not-found", "web.accounts"),
)
async def change_password(call: ServerCall, body: PasswordChange) -> None:
    """Changes the password of the caller's account, and ends its other log-ins."""
    accounts, caller = call.accounts, call.caller
    await accounts.change_own_password(_own(call), body.old, body.new, caller.address)


@operation("session.list", "GET", "/sessions", Role.VIEWER)
async def sessions(call: ServerCall) -> list[LogInRecord]:
    """The caller's log-ins; for an administrator, those of all accounts."""
    return [
        LogInRecord(s.hash[:16], s.account, s.started_s, s.used_s, s.hash == call.caller.session)
        for s in call.accounts.sessions(_whose(call))
    ]


@operation(
    "session.revoke",
    "DELETE",
    "/sessions/{id}",
    Role.VIEWER,
    errors=("web.not-found", "web.accounts"),
)
async def revoke(call: ServerCall, id: str) -> None:
    """Ends a log-in of the caller at once; an administrator can end any log-in."""
    accounts = call.accounts
    found = [s.hash for s in accounts.sessions(_whose(call)) if s.hash[:16] == id]
    if not found:
        raise WebError.of("web.not-found", value=f"log-in {id}")
    await accounts.end(*found)


def _own(call: ServerCall) -> str:
    if not call.caller.session:
        raise WebError.of("web.not-found", value="log-in of this request")
    return call.caller.session


def _whose(call: ServerCall) -> str | None:
    return None if call.caller.role is Role.ADMIN else call.caller.name


def _with_cookie(call: ServerCall, token: str) -> Answer[Identity]:
    """The new identity of the caller, as an answer that sets the cookie."""
    accounts, request = call.accounts, call.request
    found = accounts.session(digest(token))
    assert found is not None
    account = found[1]
    known = Identity(account.name, str(account.role), set_up=True, code_needed=False, fresh=True)
    parts = [f"{accounts.cookie}={token}", f"Max-Age={MAX_AGE_S:.0f}"]
    parts += [f"Path={request.scope.get('root_path', '') or '/'}", "HttpOnly", "SameSite=Strict"]
    if request.headers.get("origin", "").startswith("https:"):
        parts.append("Secure")
    return Answer(known, {"Set-Cookie": "; ".join(parts)})
