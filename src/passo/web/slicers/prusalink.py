"""PrusaLink's interface, for the uploads of PrusaSlicer. Source: PrusaLink's OpenAPI
description."""

from __future__ import annotations

from starlette.responses import Response

from passo.errors import PassoError
from passo.web.answers import json
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.incoming import in_worker_thread
from passo.web.files.names import program
from passo.web.operation import operation
from passo.web.roles import Role
from passo.web.slicers.printing import started


@operation("prusalink.storage", "GET", "/api/v1/storage", Role.VIEWER, root="")
async def storage(call: Call) -> Response:
    """The storages: only the card."""
    card = await call.bridge.card()
    free = await in_worker_thread(lambda: card.free_bytes)
    listed = {"name": "SD card", "path": "/local", "type": "LOCAL", "free_space": free}
    return json({"storage_list": [{**listed, "available": True, "read_only": False, "ro": False}]})


@operation(
    "prusalink.upload",
    "PUT",
    "/api/v1/files/local/{path:path}",
    Role.OPERATOR,
    consumes="text/x.gcode",
    root="",
)
async def upload(call: Call, path: str) -> Response:
    """Stores the body as a file, and prints it if the header `Print-After-Upload` asks for it."""
    headers, body = call.request.headers, Body(call.request)
    try:
        path = program(path)
        async with call.site.uploads.file(path, total=body.length) as incoming:
            async for data in body.pieces():
                await incoming.write(data)
    except PassoError:
        await body.drain()
        raise
    printed = _yes(headers.get("print-after-upload", "")) and await started(call.bridge, path)
    name = path.rpartition("/")[2]
    answer = {"name": name, "display_name": name, "path": f"/local{path}", "type": "PRINT_FILE"}
    return json({**answer, "size": incoming.offset, "print_started": printed}, 201)


def _yes(value: str) -> bool:
    """Whether a header is true: a Boolean of structured headers (RFC 8941), as from PrusaSlicer, or
    another common spelling."""
    return value.strip().lower() in ("?1", "1", "true")
