"""Scripts of clients, and the lines that all of them hear."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from passo.errors import PassoError
from passo.web.klippy.arguments import RequestError
from passo.web.klippy.output import failed, shown

if TYPE_CHECKING:
    from passo.web.bridge import Bridge

RESTARTS = ("RESTART", "FIRMWARE_RESTART")  # clients expect that these end the connection


class Scripts:
    """Carries out the scripts of all clients of one printer. `broadcast` sends a line to each
    client that listens."""

    def __init__(self, bridge: Bridge, broadcast: Callable[[str], None]) -> None:
        self._bridge, self._broadcast = bridge, broadcast

    async def run(self, script: str) -> bool:
        """Carries out lines of G-code, and returns when they are done; True if the printer is to
        be restarted then. The first line that fails ends the script: raises RequestError."""
        before, restarts = _up_to_restart(script.splitlines())
        if before.strip():
            try:
                await self._bridge.run(before, self.hear, sender="Klipper's socket")
            except PassoError as error:
                self._broadcast(failed(str(error)))
                raise RequestError(str(error)) from None
        return restarts

    def hear(self, line: str) -> None:
        """A line that the printer answers, or tells everyone."""
        self._broadcast(shown(line))


def _up_to_restart(lines: Iterable[str]) -> tuple[str, bool]:
    before: list[str] = []
    for line in lines:
        if line.strip().upper().split(";")[0].strip() in RESTARTS:
            return "\n".join(before), True
        before.append(line)
    return "\n".join(before), False
