"""Files and folders of the card."""

from __future__ import annotations

import re
from typing import Annotated

from msgspec import Meta, Struct
from starlette.responses import FileResponse, Response

from passo.errors import InputError, PassoError, WebError
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.download import download
from passo.web.files.incoming import in_worker_thread
from passo.web.files.metadata import Metadata, comments_of
from passo.web.files.names import cleaned, confined, program
from passo.web.operation import operation
from passo.web.roles import Role

_RANGE = re.compile(r"bytes (\d{1,19})-(\d{1,19})/(\d{1,19})")
_CARD = ("card.absent", "card.name", "card.not-found", "card.removed")
_CHANGE = (*_CARD, "card.busy", "card.read-only", "job.printing")
_UPLOAD = (
    *(
        "card.full",
        "card.directory",
        "card.not-directory",
        "card.exists",
        "input.empty",
        "upload.binary",
        "upload.kind",
    ),
    *(
        "upload.checksum",
        "upload.content",
        "upload.slow",
        "upload.too-many",
        "upload.malformed",
        "upload.offset",
    ),
)
_MOST_MACHINES = 4
_Path = Annotated[str, Meta(min_length=1, max_length=1024)]


class FilePath(Struct, forbid_unknown_fields=True):
    """The path of a file or folder from the root of the card; `/` separates names."""

    path: _Path


class FileToStore(Struct, forbid_unknown_fields=True):
    """The path of a file to upload. `sha256` is the SHA-256 of the whole file, in hexadecimal
    digits: a file that does not match is refused and not stored."""

    path: _Path
    sha256: Annotated[str, Meta(pattern=r"^([0-9A-Fa-f]{64})?$")] = ""


class FolderQuery(Struct, forbid_unknown_fields=True):
    """A folder of the card; its root by default."""

    folder: Annotated[str, Meta(max_length=1024)] = "/"


class PictureQuery(Struct, forbid_unknown_fields=True):
    """A file, and the number of a thumbnail of it."""

    path: _Path
    number: Annotated[int, Meta(ge=0, le=100)] = 0


class NewName(Struct, forbid_unknown_fields=True):
    """The file or folder to rename, and its new path, which may be in another folder."""

    path: _Path
    to: _Path


class FileEntry(Struct):
    """A file or folder. `size` is in bytes, 0 of a folder; `modified_s` is the time of its last
    change, in seconds since 1970."""

    name: str
    path: str
    folder: bool
    size: int
    modified_s: float


class Folder(Struct):
    """A folder of the card and its content, by name; the free bytes of the card."""

    path: str
    free_bytes: int
    entries: list[FileEntry]


class FittingMachines(Struct):
    """The names of the first shipped machines that print a file, the smallest first."""

    machines: list[str]


class StoredFile(Struct):
    """The number of received bytes of a file, and whether the file is on the card."""

    path: str
    size: int
    complete: bool


class KeptUpload(Struct):
    """An interrupted upload: the client may send the bytes from `offset` on within ten minutes."""

    path: str
    offset: int
    total: int


@operation("files.list", "GET", "/files", Role.VIEWER, errors=(*_CARD, "card.not-directory"))
async def files(call: Call, query: FolderQuery) -> Folder:
    """The files and folders in a folder of the card."""
    card, path = await call.bridge.card(), confined(query.folder)
    entries = await in_worker_thread(lambda: card.list(path))
    free = await in_worker_thread(lambda: card.free_bytes)
    inner = path.rstrip("/")
    listed = [
        FileEntry(e.name, f"{inner}/{e.name}", e.is_directory, e.size, e.modified.timestamp())
        for e in entries
    ]
    return Folder(path, free, listed)


@operation(
    "files.metadata", "GET", "/files/metadata", Role.VIEWER, errors=(*_CARD, "card.directory")
)
async def metadata(call: Call, query: FilePath) -> Metadata:
    """Facts about a file: slicer, objects, thumbnails, and the plan of this printer, as by `passo
    estimate`. Planning takes some seconds for a long file; until then `state` is `pending`."""
    return await call.site.metadata.get(confined(query.path))


@operation("files.fits", "GET", "/files/fits", Role.VIEWER, errors=(*_CARD, "card.directory"))
async def fits(call: Call, query: FilePath) -> FittingMachines:
    """Shipped machines that print a file, for one that this printer refuses. Planning takes some
    seconds for each, of a long file."""
    path = confined(query.path)
    return FittingMachines(await call.bridge.fitting_machines(path, _MOST_MACHINES))


@operation(
    "files.toolpath",
    "GET",
    "/files/toolpath",
    Role.VIEWER,
    errors=(*_CARD, "card.directory", "web.not-found"),
    produces="application/octet-stream",
)
async def toolpath(call: Call, query: FilePath) -> Response:
    """The toolpath of a file, move by move, as this printer would print it; its format is in
    docs/reference/toolpath.md. The answer comes when the file is planned. A file that cannot be
    printed has no toolpath: `files.metadata` says why."""
    path = confined(query.path)
    place = await call.site.metadata.toolpath(path)
    if place is None:
        raise WebError.of("web.not-found", value=f"toolpath of {path}")
    headers = {"ETag": f'"{place.stem}"', "Cache-Control": "no-cache"}
    if headers["ETag"] == call.request.headers.get("if-none-match"):
        return Response(status_code=304, headers=headers)
    return FileResponse(place, headers=headers, media_type="application/octet-stream")


@operation(
    "files.thumbnail",
    "GET",
    "/files/thumbnail",
    Role.VIEWER,
    errors=(*_CARD, "web.not-found"),
    produces="image/png",
)
async def thumbnail(call: Call, query: PictureQuery) -> Response:
    """A thumbnail of a file, as the slicer has made it: PNG, JPEG or QOI."""
    comments = await comments_of(await call.bridge.card(), confined(query.path))
    if query.number >= len(comments.thumbnails):
        raise WebError.of("web.not-found", value=f"thumbnail {query.number}")
    picture = comments.thumbnails[query.number]
    headers = {"X-Content-Type-Options": "nosniff", "Cache-Control": "no-cache"}
    return Response(picture.data, headers=headers, media_type=picture.kind)


@operation(
    "files.download",
    "GET",
    "/files/content",
    Role.VIEWER,
    errors=(*_CARD, "card.directory"),
    produces="text/x.gcode",
)
async def content(call: Call, query: FilePath) -> Response:
    """The bytes of a file, or the part that a `Range` header names."""
    return await download(call.request, await call.bridge.card(), confined(query.path))


@operation(
    "files.upload",
    "PUT",
    "/files/content",
    Role.OPERATOR,
    errors=(*_CHANGE, *_UPLOAD),
    consumes="application/octet-stream",
    status=201,
)
async def upload(call: Call, query: FileToStore) -> StoredFile:
    """Uploads a file to the card, and makes its folders. Once it is complete, it replaces a file of
    the same path. Characters that no name may have become `_`: the answer has the new path. If the
    connection is lost, the received bytes are kept for ten minutes: `files.kept` reports their
    number, and the client sends the rest with `Content-Range: bytes FIRST-LAST/TOTAL`. A client may
    send any file in such parts."""
    body = Body(call.request)
    try:
        path = program(query.path)
        offset, total = _part(call.request.headers.get("content-range"), body.length)
        async with call.site.uploads.file(
            path, offset=offset, total=total, resumable=True
        ) as incoming:
            incoming.sha256 = query.sha256 or incoming.sha256
            async for data in body.pieces():
                await incoming.write(data)
    except PassoError:
        await body.drain()
        raise
    return StoredFile(path, incoming.offset, total is None or incoming.offset == total)


@operation(
    "files.kept", "GET", "/files/upload", Role.OPERATOR, errors=("card.name", "web.not-found")
)
async def kept(call: Call, query: FilePath) -> KeptUpload:
    """The offset from which an interrupted upload of a file continues."""
    path = cleaned(query.path)
    found = call.site.uploads.kept(path)
    if found is None or found.total is None:
        raise WebError.of("web.not-found", value=f"interrupted upload of {path}")
    return KeptUpload(path, found.offset, found.total)


@operation("files.forget", "DELETE", "/files/upload", Role.OPERATOR, errors=("card.name",))
async def forget(call: Call, query: FilePath) -> None:
    """Discards an interrupted upload."""
    await call.site.uploads.forget(cleaned(query.path))


@operation("files.remove", "DELETE", "/files", Role.OPERATOR, errors=(*_CHANGE, "card.directory"))
async def remove(call: Call, query: FilePath) -> None:
    """Deletes a file, unless it is being printed."""
    await call.bridge.remove_file(confined(query.path))


@operation(
    "files.rename",
    "POST",
    "/files/rename",
    Role.OPERATOR,
    errors=(*_CHANGE, "card.exists", "card.into-itself", "card.no-slots", "card.full"),
)
async def rename(call: Call, body: NewName) -> None:
    """Renames or moves a file or folder, unless it is, or contains, the file that is being
    printed."""
    await call.bridge.rename(confined(body.path), confined(body.to))


@operation(
    "folders.make", "POST", "/folders", Role.OPERATOR, errors=(*_CHANGE, "card.exists", "card.full")
)
async def make_folder(call: Call, body: FilePath) -> None:
    """Makes a folder."""
    card, path = await call.bridge.card(), confined(body.path)
    await in_worker_thread(lambda: card.make_directory(path))


@operation(
    "folders.remove",
    "DELETE",
    "/folders",
    Role.OPERATOR,
    errors=(*_CHANGE, "card.not-empty", "card.not-directory"),
)
async def remove_folder(call: Call, query: FilePath) -> None:
    """Deletes an empty folder."""
    card, path = await call.bridge.card(), confined(query.path)
    await in_worker_thread(lambda: card.remove_directory(path))


def _part(content_range: str | None, length: int | None) -> tuple[int, int | None]:
    """The offset of the sent bytes, and the size of the whole file."""
    if content_range is None:
        return 0, length
    found = _RANGE.fullmatch(content_range.strip())
    if found is None:
        raise InputError.of("upload.malformed", value=f"Content-Range is {content_range!r}")
    first, last, total = (int(digits) for digits in found.groups())
    if not first <= last < total or length not in (None, last - first + 1):
        raise InputError.of("upload.malformed", value=f"Content-Range is {content_range!r}")
    return first, total
