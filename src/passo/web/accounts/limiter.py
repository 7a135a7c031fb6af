"""The limits of failed log-ins: 3 a minute, 5 in 10 minutes, 10 in an hour."""

from __future__ import annotations

from collections.abc import Callable
from ipaddress import IPv6Address, ip_address
from math import ceil

from passo.errors import WebError

LIMITS = ((60.0, 3), (600.0, 5), (3600.0, 10))  # seconds, attempts within them
_MAX_KEYS = 4096


class Limiter:
    """Counts attempts by key; a key is an address or an account."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._attempts: dict[str, list[float]] = {}

    def attempt(self, *keys: str) -> None:
        """Counts an attempt for each key. Raises WebError `web.too-many` if a key has too many
        attempts; then the attempt is not counted."""
        now = self._now_s()
        wait_s = max(self._wait_s(key, now) for key in keys)
        if wait_s > 0:
            raise WebError.of("web.too-many", limit=ceil(wait_s))
        for key in keys:
            self._attempts.setdefault(key, []).append(now)
        self._forget(now)

    def succeeded(self, *keys: str) -> None:
        """Removes the last attempt of each key, because it succeeded."""
        for key in keys:
            if attempts := self._attempts.get(key):
                attempts.pop()

    def _wait_s(self, key: str, now: float) -> float:
        attempts = self._attempts.get(key, [])
        waits = [attempts[-most] + span - now for span, most in LIMITS if len(attempts) >= most]
        return max([0.0, *waits])

    def _forget(self, now: float) -> None:
        if len(self._attempts) <= _MAX_KEYS:
            return
        span = LIMITS[-1][0]
        old = [key for key, times in self._attempts.items() if not times or times[-1] + span <= now]
        for key in old or [next(iter(self._attempts))]:
            del self._attempts[key]


def address_key(host: str) -> str:
    """The key of an address; for IPv6, the 64-bit network, which is usually one computer's."""
    try:
        address = ip_address(host)
    except ValueError:
        return f"address {host}"
    if isinstance(address, IPv6Address) and address.ipv4_mapped is None:
        return f"address {int(address) >> 64:x}"
    return f"address {host}"
