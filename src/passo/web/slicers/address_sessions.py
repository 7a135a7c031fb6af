"""Sessions of RepRapFirmware's interface, whose clients send the password once and are then
identified by their address."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.web.operation import Caller

IDLE_S = 60.0  # a session ends after this time without use
_MAX = 32


class AddressSessions:
    """The callers that have connected with an API key, by address. `now_s` returns monotonic time
    in seconds."""

    def __init__(self, now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._found: dict[str, tuple[Caller, float]] = {}

    def begin(self, address: str, caller: Caller) -> None:
        """Starts a session: from now on, requests from this address are the caller's."""
        self._found.pop(address, None)
        self._found[address] = (replace(caller, address=address), self._now_s())
        while len(self._found) > _MAX:
            del self._found[next(iter(self._found))]

    def use(self, address: str) -> Caller | None:
        """The caller with a session from this address, or None; extends the session."""
        caller, used_s = self._found.pop(address, (None, 0.0))
        if caller is None or self._now_s() - used_s > IDLE_S:
            return None
        self._found[address] = (caller, self._now_s())
        return caller

    def renew(self, address: str, caller: Caller) -> None:
        """Call this after a long request: extends the session of this caller, if it has one."""
        if (found := self._found.get(address)) is not None and found[0].key == caller.key:
            self._found[address] = (found[0], self._now_s())

    def end(self, address: str) -> None:
        """Ends the session of this address."""
        self._found.pop(address, None)
