"""OctoPrint's interface, as far as slicers use it to test a printer, upload and start."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING
from urllib.parse import quote

from starlette.routing import Route

from passo.errors import CommandError, InputError, PassoError
from passo.version import __version__
from passo.web.answers import json, refusal
from passo.web.files.body import Body
from passo.web.files.form_upload import receive_form
from passo.web.files.names import program

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from passo.web.bridge import Bridge
    from passo.web.files.uploads import Uploads


class OctoPrint:
    """Handlers for one printer. Source: OctoPrint's REST API documentation."""

    def __init__(self, bridge: Bridge, uploads: Uploads) -> None:
        self._bridge, self._uploads = bridge, uploads

    @property
    def routes(self) -> list[Route]:
        """Where the handlers are found."""
        return [
            Route("/api/version", self.version),
            Route("/api/files/local", self.upload, methods=["POST"]),
        ]

    async def version(self, _: Request) -> Response:
        """What a slicer tests: `text` begins with OctoPrint for those that ask."""
        return json({"api": "0.1", "server": "1.5.0", "text": f"OctoPrint (Passo {__version__})"})

    async def upload(self, request: Request) -> Response:
        """Takes a file, then selects or prints it if the form says so. A printer that cannot print
        it now keeps it all the same: `effectivePrint` is false then, as OctoPrint has it."""
        body = Body(request)
        try:
            form = await receive_form(body, self._uploads, _target)
            if not form.path:
                raise InputError.of("upload.malformed", value="it has no file")
        except PassoError as error:
            await body.drain()
            return refusal(error)
        printed = form.fields.get("print", "") == "true" and await self._start(form.path)
        answer = {
            "done": True,
            "effectivePrint": printed,
            "effectiveSelect": printed,
            "files": {"local": _file(request, form.path)},
        }
        resource = f"{request.base_url}api/files/local{quote(form.path)}"
        return json(answer, 201, {"Location": resource})

    async def _start(self, path: str) -> bool:
        try:
            await self._bridge.start_print(path)
        except CommandError:
            return False
        return True


def _target(fields: Mapping[str, str], name: str) -> str:
    return program(f"{fields.get('path', '')}/{name}")


def _file(request: Request, path: str) -> dict[str, object]:
    name = path.rpartition("/")[2]
    at = quote(path)
    return {
        "name": name,
        "display": name,
        "path": path.removeprefix("/"),
        "origin": "local",
        "refs": {
            "resource": f"{request.base_url}api/files/local{at}",
            "download": f"{request.base_url}api/v1/files/content?path={at}",
        },
    }
