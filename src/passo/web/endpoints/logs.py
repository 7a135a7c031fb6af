"""The log of the server and the reports of halts, without secrets."""

from __future__ import annotations

import asyncio

from msgspec import Struct
from starlette.responses import Response

from passo.web.call import Call
from passo.web.operation import operation
from passo.web.roles import Role

_TEXT = "text/plain"


class LogRecord(Struct):
    """A file for download: its size in bytes, and the time of its last change, in seconds since
    1970."""

    name: str
    size: int
    changed_s: float


@operation("logs.list", "GET", "/logs", Role.OPERATOR)
async def logs(call: Call) -> list[LogRecord]:
    """The log (`--log`), and the reports of halts."""
    found = await asyncio.to_thread(call.site.logs.found)
    return [LogRecord(log.name, log.size, log.changed_s) for log in found]


@operation(
    "logs.get", "GET", "/logs/{name}", Role.OPERATOR, errors=("web.not-found",), produces=_TEXT
)
async def log(call: Call, name: str) -> Response:
    """One of these files, without passwords and keys."""
    text = await asyncio.to_thread(call.site.logs.text, name)
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(text, headers=headers, media_type=_TEXT)
