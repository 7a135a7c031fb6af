"""OctoPrint's interface, as far as slicers use it to test a printer, upload and start. Source:
OctoPrint's REST API documentation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING
from urllib.parse import quote

from starlette.responses import Response

from passo.errors import CommandError, InputError, PassoError
from passo.version import __version__
from passo.web.answers import json
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.form_upload import receive_form
from passo.web.files.names import program
from passo.web.operation import operation
from passo.web.roles import Role

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.web.bridge import Bridge


@operation("octoprint.version", "GET", "/api/version", Role.VIEWER, root="")
async def version(_: Call) -> Response:
    """What a slicer tests: `text` begins with OctoPrint for those that ask."""
    return json({"api": "0.1", "server": "1.5.0", "text": f"OctoPrint (Passo {__version__})"})


@operation(
    "octoprint.upload",
    "POST",
    "/api/files/local",
    Role.OPERATOR,
    consumes="multipart/form-data",
    root="",
)
async def upload(call: Call) -> Response:
    """Takes a file, then selects or prints it if the form says so. A printer that cannot print it
    now keeps it all the same: `effectivePrint` is false then, as OctoPrint has it."""
    request = call.request
    body = Body(request)
    try:
        form = await receive_form(body, call.site.uploads, _target)
        if not form.path:
            raise InputError.of("upload.malformed", value="it has no file")
    except PassoError:
        await body.drain()
        raise
    printed = form.fields.get("print", "") == "true" and await _start(call.bridge, form.path)
    answer = {
        "done": True,
        "effectivePrint": printed,
        "effectiveSelect": printed,
        "files": {"local": _file(request, form.path)},
    }
    resource = f"{request.base_url}api/files/local{quote(form.path)}"
    return json(answer, 201, {"Location": resource})


async def _start(bridge: Bridge, path: str) -> bool:
    try:
        await bridge.start_print(path)
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
