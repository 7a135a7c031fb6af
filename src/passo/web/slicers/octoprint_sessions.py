"""Sessions of OctoPrint's interface: a log-in with a key gives one, and the WebSocket takes it."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.operation import Caller

VALID_S = 600.0  # time between log-in and WebSocket
_MAX = 64


class LoginSessions:
    """The callers of the last log-ins, by their tokens. `now_s` returns monotonic time in
    seconds."""

    def __init__(self, now_s: Callable[[], float] = monotonic) -> None:
        self._now_s = now_s
        self._found: dict[str, tuple[Caller, float]] = {}

    def begin(self, caller: Caller) -> str:
        """Returns a new token of the caller."""
        token = secrets.token_urlsafe(24)
        self._found[token] = caller, self._now_s()
        while len(self._found) > _MAX:
            del self._found[next(iter(self._found))]
        return token

    def caller(self, token: str) -> Caller | None:
        """The caller with this token; None for an unknown or an old one. The caller may have lost
        its rights since: see `Access.holds`."""
        caller, begun_s = self._found.get(token, (None, 0.0))
        return caller if self._now_s() - begun_s <= VALID_S else None
