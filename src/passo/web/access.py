"""The caller of a request, and the caller's rights."""

from __future__ import annotations

from dataclasses import dataclass
from ipaddress import ip_address
from time import monotonic
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from passo.errors import WebError
from passo.web.accounts.accounts import FRESH_S, digest
from passo.web.accounts.limiter import address_key
from passo.web.operation import HEADER, USER_HEADER, Caller
from passo.web.roles import Role
from passo.web.slicers.address_sessions import AddressSessions

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

    from passo.web.accounts.accounts import Accounts
    from passo.web.operation import Operation

_RRF = "/rr_"  # prefix of the paths of RepRapFirmware's interface
_LOCAL = "local"  # the caller on this computer while there is no administrator
_MAX_USER = 64  # characters of the name of a program's user
# Headers that a proxy adds. A proxy may be on this computer, but its clients are not.
_OF_PROXIES = ("forwarded", "x-forwarded-for", "x-forwarded-host", "x-real-ip", "via")


@dataclass(frozen=True, slots=True)
class Binding:
    """The address of a web interface. `loopback`: only this computer can reach it. `names` are
    further host names of it. `unix`: it is a Unix socket, so that callers have no address."""

    loopback: bool
    names: frozenset[str] = frozenset()
    unix: bool = False

    def has(self, host: str) -> bool:
        """Whether the host of a request is this printer. Another web page may point a foreign name
        to this printer (DNS rebinding), so a name must be one of `names` or localhost. Any IP
        address is accepted; on `loopback`, only loopback addresses."""
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        if name in self.names or name == "localhost":
            return True
        try:
            address = ip_address(name.partition("%")[0])
        except ValueError:
            return False
        return address.is_loopback or not self.loopback


class Access:
    """Finds the caller of each request. An address gives no rights, with one exception: before
    there is an administrator, every program of this computer has all rights if no other computer
    can reach the web interface."""

    def __init__(self, accounts: Accounts, binding: Binding) -> None:
        self.accounts, self._binding = accounts, binding
        self.connected = AddressSessions(monotonic)

    def needs_code(self, connection: HTTPConnection) -> bool:
        """Whether the one-time code is needed to create the administrator."""
        binding = self._binding
        return not (binding.loopback and _is_local(connection, unix=binding.unix))

    def caller(self, connection: HTTPConnection, *, writes: bool) -> Caller:
        """The caller of a request; `writes` if the request may change something. Raises WebError
        for an invalid key, and for a request that another web page has caused."""
        peer = connection.client.host if connection.client is not None else ""
        address = address_key(peer)
        # Before there is an administrator there are no keys: a key in a request is ignored.
        if self.accounts.exist and (token := _key_of(connection)) is not None:
            key = self.accounts.key(token)
            if key is None:
                raise WebError.of("web.log-in")
            name = _with_user(connection, key.name)
            return Caller(name, key.role, key=key.hash, address=address)
        self._require_own_page(connection)
        found = self.accounts.session(_session_of(connection, self.accounts.cookie))
        if found is not None:
            if writes and HEADER.lower() not in connection.headers:
                raise WebError.of("web.origin", value=f"it has no header {HEADER}")
            session, account = found
            return Caller(account.name, account.role, session=session.hash, address=address)
        if not self.accounts.exist and not self.needs_code(connection):
            return Caller(_with_user(connection, _LOCAL), Role.ADMIN, address=address)
        return self._connected(connection, peer) or Caller("", Role.PUBLIC, address=address)

    def connect(self, connection: HTTPConnection, token: str) -> bool:
        """Starts a session of RepRapFirmware's interface with an API key. Returns False if the key
        is invalid."""
        key = self.accounts.key(token)
        peer = connection.client.host if connection.client is not None else ""
        if key is None or any(name in connection.headers for name in _OF_PROXIES):
            return False
        self.connected.begin(peer, Caller(key.name, key.role, key=key.hash))
        return True

    def _connected(self, connection: HTTPConnection, peer: str) -> Caller | None:
        """The caller of such a session, whose further requests have no key."""
        if not connection.url.path.startswith(_RRF):
            return None
        if any(name in connection.headers for name in _OF_PROXIES):
            return None  # the address of a proxy is that of many clients
        caller = self.connected.use(peer)
        return caller if caller is not None and self.holds(caller) else None

    def holds(self, caller: Caller) -> bool:
        """Whether a caller still has its rights. Never waits."""
        if caller.key:
            return any(key.hash == caller.key for key in self.accounts.keys)
        if caller.session:
            found = self.accounts.session(caller.session)
            return found is not None and found[1].role == caller.role
        return not self.accounts.exist

    def permit(self, caller: Caller, operation: Operation) -> None:
        """Raises WebError unless the caller may execute the operation."""
        self.require(caller, operation.role)
        if not operation.fresh:
            return
        if not self.accounts.exist:
            raise WebError.of("web.no-administrator")
        self.require_password(caller)

    def require(self, caller: Caller, role: Role) -> None:
        """Raises WebError unless the caller has at least this role."""
        if caller.role >= role:
            return
        if caller.role is Role.PUBLIC:
            raise WebError.of("web.log-in")
        raise WebError.of("web.role", value=caller.name, limit=role)

    def require_password(self, caller: Caller) -> None:
        """Raises WebError unless the password was entered within the last minutes, or there is no
        account."""
        if self.accounts.exist and not self.accounts.fresh(caller.session):
            raise WebError.of("web.password", limit=f"{FRESH_S / 60:g}")

    async def used(self, caller: Caller) -> None:
        """Records that a session is used, which extends it."""
        if caller.session and (found := self.accounts.session(caller.session)) is not None:
            await self.accounts.use(found[0])

    def _require_own_page(self, connection: HTTPConnection) -> None:
        """Raises WebError for a request that another web page has caused in a browser."""
        site = connection.headers.get("sec-fetch-site", "none")
        if site not in ("same-origin", "none"):
            raise WebError.of("web.origin", value=f"Sec-Fetch-Site is {site}")
        origin = connection.headers.get("origin")
        if origin is None:
            return
        parts = urlsplit(origin)
        host = connection.headers.get("host", "")
        default = {"https": ":443", "http": ":80"}.get(parts.scheme, "")
        same = parts.netloc.lower() in (host.lower(), host.lower().removesuffix(default))
        if not (same or parts.hostname in self._binding.names):
            raise WebError.of("web.origin", value=f"Origin is {origin}")


def _key_of(connection: HTTPConnection) -> str | None:
    if (token := connection.headers.get("x-api-key")) is not None:
        return token
    scheme, _, token = connection.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else None


def _with_user(connection: HTTPConnection, name: str) -> str:
    """The name of a program, with the user for whom it acts, if it names one."""
    user = unquote(connection.headers.get(USER_HEADER.lower(), ""))
    shown = "".join(sign for sign in user if sign.isprintable())[:_MAX_USER].strip()
    return f"{name} ({shown})" if shown else name


def _session_of(connection: HTTPConnection, cookie: str) -> str:
    return digest(connection.cookies.get(cookie, ""))


def _is_local(connection: HTTPConnection, *, unix: bool) -> bool:
    """Whether the caller is a program of this computer, not a proxy."""
    if any(name in connection.headers for name in _OF_PROXIES):
        return False
    if connection.client is None:
        return unix
    try:
        return ip_address(connection.client.host).is_loopback
    except ValueError:
        return False
