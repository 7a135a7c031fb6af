"""A request, as the handlers of operations get it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.web.bridge import Bridge
    from passo.web.operation import Caller
    from passo.web.site import Site


@dataclass(frozen=True, slots=True)
class Call:
    """A request, as a handler gets it."""

    site: Site
    caller: Caller
    request: Request

    @property
    def bridge(self) -> Bridge:
        """The printer."""
        return self.site.bridge

    async def run(self, script: str) -> tuple[str, ...]:
        """Carries out lines of G-code in the name of the caller, as `Bridge.run`."""
        return await self.site.bridge.run(script, sender=self.caller.name)
