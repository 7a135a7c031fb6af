"""A request, in the form for the handlers of operations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.gcode.command import Command, Given

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.web.access import Access
    from passo.web.accounts.accounts import Accounts
    from passo.web.bridge import Bridge
    from passo.web.operation import Caller
    from passo.web.site import Site


@dataclass(frozen=True, slots=True)
class ServerCall:
    """One request to a server with accounts: its caller, and how callers are found."""

    access: Access
    caller: Caller
    request: Request

    @property
    def accounts(self) -> Accounts:
        """The accounts of the server."""
        return self.access.accounts


@dataclass(frozen=True, slots=True)
class Call(ServerCall):
    """One request to a printer."""

    site: Site

    @property
    def bridge(self) -> Bridge:
        """The printer."""
        return self.site.bridge

    async def run(self, script: str) -> tuple[str, ...]:
        """Executes lines of G-code for the caller, as `Bridge.run`."""
        return await self.site.bridge.run(script, sender=self.caller.name)

    async def command(self, code: str, **given: Given) -> tuple[str, ...]:
        """Executes a command with these values for the caller; see `Command.call`."""
        return await self.commands(Command.call(code, **given))

    async def commands(self, *commands: Command) -> tuple[str, ...]:
        """Executes commands for the caller, one after the other, as `Bridge.call`."""
        return await self.site.bridge.call(*commands, sender=self.caller.name)
