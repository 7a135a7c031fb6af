"""Sends a file of the card to a client, whole or in part (RFC 9110, section 14)."""

from __future__ import annotations

import re
from collections.abc import AsyncGenerator
from typing import TYPE_CHECKING
from urllib.parse import quote

from starlette.responses import Response, StreamingResponse

from passo.card.unheld import Unheld
from passo.errors import CardError
from passo.web.files.incoming import in_worker_thread

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.card import Card

_PIECE = 1 << 18
_RANGE = re.compile(r"bytes=(\d{0,19})-(\d{0,19})")


async def download(request: Request, card: Card, path: str) -> Response:
    """The file at a confined path. The file is not locked while a slow client reads it; if it is
    replaced, the answer ends early. Raises CardError."""
    entry = await in_worker_thread(lambda: card.find(path))
    if entry.is_directory:
        raise CardError.of("card.directory", path)
    file = await in_worker_thread(lambda: Unheld(card, path))
    tag = f'"{entry.size:x}-{int(entry.modified.timestamp()):x}"'
    headers = {
        "Accept-Ranges": "bytes",
        "ETag": tag,
        "Content-Disposition": f"attachment; filename*=UTF-8''{quote(entry.name, safe='')}",
        "X-Content-Type-Options": "nosniff",
    }
    begin, end, status = 0, file.size, 200
    wanted = _RANGE.fullmatch(request.headers.get("range", ""))
    if wanted and any(wanted.groups()) and request.headers.get("if-range", tag) == tag:
        begin, end = _part(wanted[1], wanted[2], file.size)
        if begin >= end:
            return Response(None, 416, {**headers, "Content-Range": f"bytes */{file.size}"})
        headers["Content-Range"] = f"bytes {begin}-{end - 1}/{file.size}"
        status = 206
    headers["Content-Length"] = str(end - begin)
    return StreamingResponse(_pieces(file, begin, end), status, headers, "text/x.gcode")


def _part(first: str, last: str, size: int) -> tuple[int, int]:
    """The first byte of a range, and the byte after its last one."""
    if not first:
        return max(size - int(last), 0), size
    return int(first), min(int(last) + 1, size) if last else size


async def _pieces(file: Unheld, begin: int, end: int) -> AsyncGenerator[bytes]:
    file.seek(begin)
    while begin < end:
        count = min(_PIECE, end - begin)
        data = await in_worker_thread(lambda count=count: file.read(count))
        begin += len(data)
        yield data
