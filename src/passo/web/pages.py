"""The page as static files, built by `make web`."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.responses import Response
from starlette.routing import Route

if TYPE_CHECKING:
    from starlette.requests import Request

_BUILT = Path(__file__).with_name("static")
PRINTER, FARM = "index.html", "farm.html"
"""The pages of `passo serve` and of `passo hub`. They share all other files."""
_HASHED = "assets/"  # names in it contain a hash of the content
_NOT_BUILT = b"""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Passo</title>
<h1>The page is not built</h1>
<p>This is Passo, and its <a href="api/v1/openapi.json">API</a> works. The page is not built yet:
run <code>make web</code> in the sources, then start Passo again.</p>
"""


# Not from the tables of the computer, which differ and are large.
_KINDS = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".ico": "image/vnd.microsoft.icon",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json; charset=utf-8",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".woff2": "font/woff2",
}


@dataclass(frozen=True, slots=True)
class _File:
    """A file of the page. Only the compressed form is kept if there is one."""

    data: bytes
    packed: bool  # compressed by gzip
    headers: Mapping[str, str]

    def answer(self, request: Request) -> Response:
        """The file, compressed if the client accepts it."""
        headers = dict(self.headers)
        if headers["ETag"] == request.headers.get("if-none-match"):
            return Response(status_code=304, headers=headers)
        if not self.packed:
            return Response(self.data, headers=headers)
        headers["Vary"] = "Accept-Encoding"
        if "gzip" not in request.headers.get("accept-encoding", ""):
            return Response(gzip.decompress(self.data), headers=headers)
        headers["Content-Encoding"] = "gzip"
        return Response(self.data, headers=headers)


def page_routes(built: Path = _BUILT, page: str = PRINTER) -> list[Route]:
    """A route for each file of a page, which is read once. Without a built page, a route that
    explains how to build it."""
    files = {
        path.relative_to(built).as_posix(): path
        for path in built.rglob("*")
        if path.is_file() and path.suffix != ".gz" and not path.name.startswith(".")
    }
    files = {name: path for name, path in files.items() if name not in {PRINTER, FARM} - {page}}
    if page not in files:
        missing = _File(_NOT_BUILT, False, _headers("text/html; charset=utf-8", "no-store", ""))
        return [_route("/", missing)]
    routes = [_route(f"/{name}", _read(name, path)) for name, path in files.items()]
    return [_route("/", _read(page, files[page])), *routes]


def _read(name: str, path: Path) -> _File:
    packed = path.with_name(path.name + ".gz")
    kind = _KINDS.get(path.suffix, "application/octet-stream")
    kept = "public, max-age=31536000, immutable" if name.startswith(_HASHED) else "no-cache"
    stat = path.stat()
    headers = _headers(kind, kept, f'"{stat.st_mtime_ns:x}-{stat.st_size:x}"')
    is_packed = packed.exists()
    return _File((packed if is_packed else path).read_bytes(), is_packed, headers)


def _headers(kind: str, kept: str, tag: str) -> dict[str, str]:
    return {"Content-Type": kind, "Cache-Control": kept, "ETag": tag}


def _route(path: str, file: _File) -> Route:
    async def answer(request: Request) -> Response:
        return file.answer(request)

    return Route(path, answer)
