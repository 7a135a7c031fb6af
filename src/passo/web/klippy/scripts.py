"""Scripts of clients, and the lines that all clients receive."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from passo.errors import PassoError
from passo.web.klippy.arguments import RequestError
from passo.web.klippy.output import failed, shown

if TYPE_CHECKING:
    from passo.web.bridge import Bridge

_RESTARTS = ("RESTART", "FIRMWARE_RESTART")  # clients expect that these commands end the connection


class Scripts:
    """Executes the scripts of all clients of one printer. `broadcast` sends a line to each client
    that listens."""

    def __init__(self, bridge: Bridge, broadcast: Callable[[str], None]) -> None:
        self._bridge, self._broadcast = bridge, broadcast

    async def run(self, script: str) -> str:
        """Executes lines of G-code. When they are done, returns the command with which the caller
        must restart the printer, or an empty text. The first line that fails ends the script with
        RequestError."""
        before, restart = _up_to_restart(script.splitlines())
        if before.strip():
            try:
                await self._bridge.run(before, self.hear, sender="Klipper's socket")
            except PassoError as error:
                self._broadcast(failed(str(error)))
                raise RequestError(str(error)) from None
        return restart

    def hear(self, line: str) -> None:
        """Called with each answer of the printer, and with each line to all consoles."""
        self._broadcast(shown(line))


def _up_to_restart(lines: Iterable[str]) -> tuple[str, str]:
    before: list[str] = []
    for line in lines:
        if (command := line.strip().upper().split(";")[0].strip()) in _RESTARTS:
            return "\n".join(before), command
        before.append(line)
    return "\n".join(before), ""
