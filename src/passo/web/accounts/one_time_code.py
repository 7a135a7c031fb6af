"""One-time codes: random texts that a person copies, and the code with which a program pairs."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable
from typing import TYPE_CHECKING

from passo.errors import WebError

if TYPE_CHECKING:
    from passo.web.accounts.limiter import Limiter

_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789"  # without letters and digits that look alike
LASTS_S = 600.0
_MOST_WRONG = 5


def one_time_code() -> str:
    """A new code."""
    letters = "".join(secrets.choice(_LETTERS) for _ in range(10))
    return f"{letters[:5]}-{letters[5:]}"


def is_code(given: str, code: str) -> bool:
    """Whether a person means this code; the time for that does not depend on the code."""
    return hmac.compare_digest(given.strip().upper().encode(), code.encode())


class PairingCode:
    """The code that pairs one program with the printer, at most once, within `LASTS_S`. There is at
    most one; it ends after `_MOST_WRONG` wrong attempts."""

    def __init__(self, limiter: Limiter, now_s: Callable[[], float]) -> None:
        self._limiter, self._now_s = limiter, now_s
        self._code = ""
        self._until_s = 0.0
        self._wrong = 0

    def make(self) -> str:
        """Makes a code, in place of an earlier one."""
        self._code, self._until_s, self._wrong = one_time_code(), self._now_s() + LASTS_S, 0
        return self._code

    def use(self, code: str, address: str) -> None:
        """Ends the code if it is this one. `address` is where attempts are counted. Raises WebError
        for a wrong code, and after too many attempts."""
        self._limiter.attempt(address)
        known = self._code and self._now_s() < self._until_s
        if not known or not is_code(code, self._code):
            self._wrong += 1
            if self._wrong >= _MOST_WRONG:
                self._code = ""
            raise WebError.of("web.pairing", limit=f"{LASTS_S / 60:g}")
        self._limiter.succeeded(address)
        self._code = ""
