"""The summary of the printer."""

from __future__ import annotations

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role
from passo.web.summary import Summary


@operation("summary.get", "GET", "/summary", Role.VIEWER)
async def get(call: Call) -> Summary:
    """The printer at a glance, for a page over many printers. The WebSocket `/api/v1/summary/feed`
    sends it at each change."""
    return call.site.summary()
