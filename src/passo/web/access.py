"""Who makes a request, and whether it may."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import WebError
from passo.web.operation import Caller, Role

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

    from passo.web.operation import Operation


class Access:
    """Finds the caller of each request."""

    def caller(self, connection: HTTPConnection) -> Caller:
        """Who asks. Raises WebError for a request that must not be."""
        return Caller("local", Role.ADMIN)

    def permit(self, caller: Caller, operation: Operation) -> None:
        """Raises WebError unless the caller may do it."""
        if caller.role >= operation.role:
            return
        if caller.role is Role.PUBLIC:
            raise WebError.of("web.log-in")
        raise WebError.of("web.role", value=caller.name, limit=operation.role)
