"""Hashes of passwords, by scrypt (RFC 7914) in worker threads, two at a time."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import secrets
from base64 import b64decode, b64encode

_N, _R, _P = 1 << 14, 8, 1  # 16 MiB and about 0.1 s
_SALT, _LENGTH = 16, 32  # bytes
_AT_ONCE = 2


def hashed(password: str) -> str:
    """A new hash: `scrypt$N$R$P$SALT$HASH`."""
    salt = secrets.token_bytes(_SALT)
    return _text(salt, _scrypt(password, salt, _N, _R, _P))


def matches(password: str, stored: str) -> bool:
    """Whether a password has this hash."""
    _, n, r, p, salt, expected = stored.split("$")
    found = _scrypt(password, b64decode(salt), int(n), int(r), int(p))
    return hmac.compare_digest(found, b64decode(expected))


def _text(salt: bytes, found: bytes) -> str:
    parts = [b64encode(data).decode() for data in (salt, found)]
    return "$".join(["scrypt", str(_N), str(_R), str(_P), *parts])


def _scrypt(password: str, salt: bytes, n: int, r: int, p: int) -> bytes:
    data = password.encode("utf-8", "surrogatepass")
    return hashlib.scrypt(data, salt=salt, n=n, r=r, p=p, dklen=_LENGTH)


class Passwords:
    """Hashes in worker threads, so that no log-in delays the web's event loop."""

    def __init__(self) -> None:
        self._turns = asyncio.Semaphore(_AT_ONCE)
        self._dummy = _text(secrets.token_bytes(_SALT), secrets.token_bytes(_LENGTH))

    async def hashed(self, password: str) -> str:
        """Like `hashed`."""
        async with self._turns:
            return await asyncio.to_thread(hashed, password)

    async def matches(self, password: str, stored: str | None) -> bool:
        """Whether a password has this hash. For None it returns False after the same time as for a
        hash."""
        async with self._turns:
            same = await asyncio.to_thread(matches, password, stored or self._dummy)
        return same and stored is not None
