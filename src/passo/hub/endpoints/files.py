"""The files of the hub."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct
from starlette.responses import Response

from passo.errors import PassoError, WebError
from passo.hub.call import HubCall
from passo.hub.views import FileView
from passo.web.files.body import Body
from passo.web.files.names import program
from passo.web.operation import operation
from passo.web.roles import Role

_KEPT = "private, max-age=31536000, immutable"  # the content of a hash never changes


class NewFile(Struct, forbid_unknown_fields=True):
    """The name of a file, and the SHA-256 that its content must have; any if empty."""

    name: Annotated[str, Meta(min_length=1, max_length=200)]
    sha256: Annotated[str, Meta(pattern=r"^([0-9A-Fa-f]{64})?$")] = ""


@operation("files.list", "GET", "/files", Role.VIEWER)
async def files(call: HubCall) -> list[FileView]:
    """The files of the hub, the newest first."""
    return list(call.farm.files())


@operation(
    "files.add",
    "POST",
    "/files",
    Role.OPERATOR,
    errors=(
        *("card.full", "card.name", "input.empty", "upload.binary", "upload.kind"),
        *("upload.content", "upload.slow", "upload.malformed", "upload.checksum", "hub.store"),
    ),
    consumes="application/octet-stream",
    status=201,
)
async def add(call: HubCall, query: NewFile) -> FileView:
    """Uploads a file to the hub. Its content never changes: another content is another file."""
    body = Body(call.request)
    contents = call.site.contents
    try:
        name = program(query.name).lstrip("/")
        sha256, size = await contents.receive(body.pieces(), body.length, query.sha256)
    except PassoError:
        await body.drain()
        raise
    facts, comments = await contents.facts(sha256), await contents.comments(sha256)
    file = FileView(
        sha256,
        name.rpartition("/")[2],
        size,
        call.site.wall_s(),
        facts.materials,
        facts.nozzle_mm,
        facts.print_s,
        facts.filament_mm,
        has_picture=bool(comments.thumbnails),
    )
    return await call.farm.add_file(file, call.user)


@operation(
    "files.remove",
    "DELETE",
    "/files/{sha256}",
    Role.OPERATOR,
    errors=("web.not-found", "hub.file-used", "hub.store"),
)
async def remove(call: HubCall, sha256: str) -> None:
    """Removes a file that no unfinished job needs."""
    file = call.file(sha256)
    await call.farm.remove_file(file.sha256, call.user)
    await call.site.contents.remove(file.sha256)


@operation(
    "files.picture",
    "GET",
    "/files/{sha256}/picture",
    Role.VIEWER,
    errors=("web.not-found", "card.not-found"),
    produces="image/png",
)
async def picture(call: HubCall, sha256: str) -> Response:
    """The largest picture of a file, as the slicer has made it: PNG, JPEG or QOI."""
    comments = await call.site.contents.comments(call.file(sha256).sha256)
    if not comments.thumbnails:
        raise WebError.of("web.not-found", value=f"picture of file {sha256}")
    largest = comments.thumbnails[-1]
    return Response(largest.data, media_type=largest.kind, headers={"Cache-Control": _KEPT})
