"""The accounts of one web interface, their log-ins, and API keys."""

from __future__ import annotations

import asyncio
import hashlib
import secrets
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from passo.errors import WebError
from passo.web.accounts.limiter import Limiter
from passo.web.accounts.one_time_code import PairingCode, is_code, one_time_code
from passo.web.accounts.passwords import Passwords
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.web.accounts.store import Store

IDLE_S = 14 * 86400.0  # a log-in ends after this time without use
MAX_AGE_S = 90 * 86400.0  # every log-in ends after this time
FRESH_S = 300.0  # time after entering the password in which it is not asked for again
_USED_EVERY_S = 3600.0  # interval at which the use of a log-in is stored
_MAX_SESSIONS = 50  # for each account; beyond that, the oldest ends
KEY_PREFIX = "passo_"


@dataclass(frozen=True, slots=True)
class Account:
    """A user. `name` is in lower case."""

    name: str
    role: Role
    password: str


@dataclass(frozen=True, slots=True)
class Session:
    """A log-in; its times are in seconds of the wall clock. `confirmed_s` is the last time at which
    the password was entered; 0 if that was before the start of this program."""

    hash: str
    account: str
    started_s: float
    used_s: float
    confirmed_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Key:
    """An API key. Only its hash is stored."""

    hash: str
    id: str
    name: str
    role: Role
    made_s: float


def digest(token: str) -> str:
    """The stored hash of a token. A fast hash is enough, because tokens are random."""
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()


class Accounts:
    """All accounts are in memory; each change is stored before it takes effect. Use it only in the
    web's event loop."""

    def __init__(self, store: Store, *, wall_s: Callable[[], float], now_s: Callable[[], float]):
        """`wall_s` is the wall clock, in seconds since 1970; `now_s` a monotonic one."""
        self._store, self._wall_s = store, wall_s
        self._passwords = Passwords()
        self._changing = asyncio.Lock()  # serialises the changes of accounts
        self.limiter = Limiter(now_s)
        self.pairing = PairingCode(self.limiter, now_s)
        self._accounts = {
            name: Account(name, Role(role), password)
            for name, role, password in store.rows("select name, role, password from accounts")
        }
        self._sessions = {
            row[0]: Session(*row)
            for row in store.rows("select hash, account, started_s, used_s from sessions")
        }
        self._keys = {
            row[0]: Key(row[0], row[1], row[2], Role(row[3]), row[4])
            for row in store.rows("select hash, id, name, role, made_s from keys")
        }
        found = store.rows("select instance from site")
        self.instance: str = found[0][0] if found else secrets.token_hex(4)
        self._unsaved_instance = not found
        self._code = "" if self._accounts else one_time_code()

    @property
    def exist(self) -> bool:
        """Whether there is an administrator."""
        return bool(self._accounts)

    @property
    def kept(self) -> bool:
        """Whether accounts survive a restart of the program."""
        return self._store.kept

    @property
    def code(self) -> str:
        """The one-time code that creates the administrator; empty once there is one."""
        return "" if self._accounts else self._code

    @property
    def cookie(self) -> str:
        """The name of the cookie; it differs for each printer of this host."""
        return f"passo-{self.instance}"

    def close(self) -> None:
        """Closes the store."""
        self._store.close()

    # -- log-ins ----------------------------------------------------------------------------------

    async def create_administrator(
        self, name: str, password: str, address: str, code: str | None
    ) -> str:
        """Creates the first account and logs it in; returns the token. `code` is None if it is not
        needed. Raises WebError."""
        if self._accounts:
            raise WebError.of("web.set-up")
        if code is not None:
            self.limiter.attempt(address)
            if not is_code(code, self._code):
                raise WebError.of("web.code")
            self.limiter.succeeded(address)
        account = Account(name.lower(), Role.ADMIN, await self._passwords.hashed(password))
        async with self._changing:
            if self._accounts:  # another request has created it in the meantime
                raise WebError.of("web.set-up")
            await self._store.write(_insert(account))
            self._accounts[account.name] = account
        return await self._begin(account)

    async def log_in(self, name: str, password: str, address: str) -> str:
        """Starts a session; returns its token. Raises WebError, with the same text and after the
        same time for a wrong account and for a wrong password."""
        account = await self._checked(name, password, address)
        return await self._begin(account)

    async def confirm(self, session: str, password: str, address: str) -> None:
        """Confirms the password of a session. Raises WebError."""
        found = self._sessions[session]
        await self._checked(found.account, password, address)
        if session in self._sessions:
            self._sessions[session] = replace(found, confirmed_s=self._wall_s())

    async def _checked(self, name: str, password: str, address: str) -> Account:
        name = name.lower()
        keys = (address, f"account {name}")
        self.limiter.attempt(*keys)
        account = self._accounts.get(name)
        stored = account.password if account is not None else None
        right = await self._passwords.matches(password, stored)
        account = self._accounts.get(name)
        if not right or account is None or account.password != stored:
            raise WebError.of("web.credentials")
        self.limiter.succeeded(*keys)
        return account

    async def _begin(self, account: Account) -> str:
        token, now = secrets.token_urlsafe(32), self._wall_s()
        session = Session(digest(token), account.name, now, now, now)
        own = sorted(self.sessions(account.name), key=lambda one: one.used_s)
        surplus = [one.hash for one in own[: max(len(own) - _MAX_SESSIONS + 1, 0)]]
        statements = [("delete from sessions where hash = ?", (hash_,)) for hash_ in surplus]
        if self._unsaved_instance:
            statements.append(("insert into site (instance) values (?)", (self.instance,)))
        row = (session.hash, session.account, session.started_s, session.used_s)
        statement = "insert into sessions (hash, account, started_s, used_s) values (?, ?, ?, ?)"
        await self._store.write(*statements, (statement, row))
        self._unsaved_instance = False
        for hash_ in surplus:
            self._sessions.pop(hash_, None)
        self._sessions[session.hash] = session
        return token

    def session(self, hash_: str) -> tuple[Session, Account] | None:
        """A valid session, and its account. Never waits."""
        found = self._sessions.get(hash_)
        account = self._accounts.get(found.account) if found is not None else None
        if found is None or account is None:
            return None
        now = self._wall_s()
        if now >= min(found.used_s + IDLE_S, found.started_s + MAX_AGE_S):
            del self._sessions[hash_]
            return None
        return found, account

    async def use(self, session: Session) -> None:
        """Records that a session is used."""
        now = self._wall_s()
        if now < session.used_s + _USED_EVERY_S:
            return
        self._sessions[session.hash] = replace(session, used_s=now)
        await self._store.write(
            ("update sessions set used_s = ? where hash = ?", (now, session.hash)),
            ("delete from sessions where used_s < ?", (now - IDLE_S,)),
        )

    def fresh(self, hash_: str) -> bool:
        """Whether the password of a session was entered within `FRESH_S`."""
        found = self._sessions.get(hash_)
        return found is not None and self._wall_s() < found.confirmed_s + FRESH_S

    def sessions(self, account: str | None = None) -> list[Session]:
        """The valid sessions of an account, or of all."""
        found = [found for hash_ in list(self._sessions) if (found := self.session(hash_))]
        return [session for session, _ in found if account in (None, session.account)]

    async def end(self, *hashes: str) -> None:
        """Ends these sessions at once."""
        for hash_ in hashes:
            self._sessions.pop(hash_, None)
        await self._store.write(*[("delete from sessions where hash = ?", (h,)) for h in hashes])

    # -- accounts ---------------------------------------------------------------------------------

    @property
    def all(self) -> list[Account]:
        """All accounts, by name."""
        return sorted(self._accounts.values(), key=lambda account: account.name)

    async def add(self, name: str, password: str, role: Role) -> Account:
        """Makes an account. Raises WebError if the name is taken."""
        account = Account(name.lower(), role, await self._passwords.hashed(password))
        async with self._changing:
            if account.name in self._accounts:
                raise WebError.of("web.account-exists", value=account.name)
            await self._store.write(_insert(account))
            self._accounts[account.name] = account
        return account

    async def change(
        self, name: str, *, password: str | None = None, role: Role | None = None, but: str = ""
    ) -> Account:
        """Changes the password or the role of an account, and ends its sessions except `but`.
        Raises WebError."""
        stored = None if password is None else await self._passwords.hashed(password)
        async with self._changing:
            old = self._found(name)
            account = Account(old.name, old.role if role is None else role, stored or old.password)
            if account.role is not Role.ADMIN:
                self._require_another_administrator(old)
            hashes = [one.hash for one in self.sessions(old.name) if one.hash != but]
            ends = [("delete from sessions where hash = ?", (hash_,)) for hash_ in hashes]
            await self._store.write(_insert(account), *ends)
            self._accounts[account.name] = account
            for hash_ in hashes:
                self._sessions.pop(hash_, None)
        return account

    async def change_own_password(self, session: str, old: str, new: str, address: str) -> None:
        """Changes the password of a session's account; `old` must be its present password. Raises
        WebError."""
        found = self._sessions[session]
        await self._checked(found.account, old, address)
        await self.change(found.account, password=new, but=session)

    async def remove(self, name: str) -> None:
        """Removes an account and its sessions. Raises WebError."""
        async with self._changing:
            account = self._found(name)
            self._require_another_administrator(account)
            await self._store.write(
                ("delete from accounts where name = ?", (account.name,)),
                ("delete from sessions where account = ?", (account.name,)),
            )
            del self._accounts[account.name]
            for session in [s for s in self._sessions.values() if s.account == account.name]:
                del self._sessions[session.hash]

    def _found(self, name: str) -> Account:
        account = self._accounts.get(name.lower())
        if account is None:
            raise WebError.of("web.not-found", value=f"account {name}")
        return account

    def _require_another_administrator(self, account: Account) -> None:
        others = [a for a in self._accounts.values() if a.name != account.name]
        if account.role is Role.ADMIN and all(a.role is not Role.ADMIN for a in others):
            raise WebError.of("web.last-administrator", value=account.name)

    # -- keys -------------------------------------------------------------------------------------

    @property
    def keys(self) -> list[Key]:
        """All API keys, oldest first."""
        return sorted(self._keys.values(), key=lambda key: key.made_s)

    def key(self, token: str) -> Key | None:
        """The API key with this token; None for an unknown one. Never waits."""
        return self._keys.get(digest(token))

    async def add_key(self, name: str, role: Role) -> tuple[Key, str]:
        """Makes a key; returns it with its token, which cannot be read later."""
        token = KEY_PREFIX + secrets.token_hex(16)
        key = Key(digest(token), secrets.token_hex(4), name, role, self._wall_s())
        statement = "insert into keys (hash, id, name, role, made_s) values (?, ?, ?, ?, ?)"
        row = (key.hash, key.id, key.name, int(key.role), key.made_s)
        await self._store.write((statement, row))
        self._keys[key.hash] = key
        return key, token

    async def revoke_key(self, id_: str) -> None:
        """Makes a key invalid from now on. Raises WebError."""
        found = next((key for key in self._keys.values() if key.id == id_), None)
        if found is None:
            raise WebError.of("web.not-found", value=f"key {id_}")
        await self._store.write(("delete from keys where hash = ?", (found.hash,)))
        del self._keys[found.hash]


def _insert(account: Account) -> tuple[str, tuple[object, ...]]:
    statement = "insert or replace into accounts (name, role, password) values (?, ?, ?)"
    return statement, (account.name, int(account.role), account.password)
