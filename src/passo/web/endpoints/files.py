"""Files of the card."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from passo.errors import PassoError
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.names import program
from passo.web.operation import operation
from passo.web.roles import Role


class FilePath(Struct, forbid_unknown_fields=True):
    """Where a file is on the card, from its root."""

    path: Annotated[str, Meta(min_length=1, max_length=1024)]


class StoredFile(Struct):
    """A file of the card, and its bytes."""

    path: str
    size: int


@operation(
    "files.upload",
    "PUT",
    "/files/content",
    Role.OPERATOR,
    errors=(
        *("card.absent", "card.name", "card.full", "card.busy", "card.directory", "job.printing"),
        *("upload.kind", "upload.content", "upload.slow", "upload.too-many", "upload.malformed"),
    ),
    consumes="application/octet-stream",
    status=201,
)
async def upload(call: Call, query: FilePath) -> StoredFile:
    """Puts a file onto the card, in place of one of that path."""
    body = Body(call.request)
    try:
        path = program(query.path)
        uploads = call.site.uploads
        async with uploads.file(path, total=body.length, resumable=True) as incoming:
            async for data in body.pieces():
                await incoming.write(data)
    except PassoError:
        await body.drain()
        raise
    return StoredFile(path, incoming.offset)
