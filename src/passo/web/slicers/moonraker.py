"""Moonraker's interface, for the uploads of slicers to a printer without a Moonraker. Source:
Moonraker's documentation of its API."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from starlette.responses import Response

from passo.errors import InputError, PassoError
from passo.printer.klipper.machine import webhooks
from passo.version import __version__
from passo.web.answers import json
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.form_upload import receive_form
from passo.web.files.incoming import in_worker_thread
from passo.web.files.names import cleaned, program
from passo.web.operation import operation
from passo.web.roles import Role
from passo.web.slicers.printing import posted, started

_ROOT = "gcodes"  # Moonraker's name of the folder for G-code


@operation("moonraker.info", "GET", "/server/info", Role.VIEWER, root="")
async def info(call: Call) -> Response:
    """The state. Slicers take a server for Moonraker if it has these names."""
    state = webhooks(call.bridge.latest().status)["state"]
    return _result(
        {
            "klippy_connected": True,
            "klippy_state": state,
            "components": ["file_manager"],
            "failed_components": [],
            "registered_directories": [_ROOT],
            "warnings": [],
            "websocket_count": 0,
            "moonraker_version": f"passo-{__version__}",
            "api_version": [1, 5, 0],
            "api_version_string": "1.5.0",
        }
    )


@operation("moonraker.roots", "GET", "/server/files/roots", Role.VIEWER, root="")
async def roots(_: Call) -> Response:
    """The folders for files: only the card."""
    return _result([{"name": _ROOT, "path": "/", "permissions": "rw"}])


@operation(
    "moonraker.upload",
    "POST",
    "/server/files/upload",
    Role.OPERATOR,
    consumes="multipart/form-data",
    root="",
)
async def upload(call: Call) -> Response:
    """Stores a file, and prints it if the form asks for it. If the printer cannot print it now, the
    file stays and `print_started` is false."""
    body = Body(call.request)
    try:
        form = await receive_form(body, call.site.uploads, _target)
        if not form.path:
            raise InputError.of("upload.malformed", value="it has no file")
    except PassoError:
        await body.drain()
        raise
    printed = form.fields.get("print", "") == "true" and await started(call.bridge, form.path)
    card = await call.bridge.card()
    entry = await in_worker_thread(lambda: card.find(form.path))
    answer: dict[str, Any] = {
        "action": "create_file",
        "item": {
            "path": form.path.removeprefix("/"),
            "root": _ROOT,
            "modified": entry.modified.timestamp(),
            "size": form.size,
            "permissions": "rw",
        },
        "print_started": printed,
        "print_queued": False,
    }
    # Moonraker answers uploads without `result`; OrcaSlicer reads it all the same.
    return json({**answer, "result": answer}, 201)


@operation("moonraker.start", "POST", "/printer/print/start", Role.OPERATOR, root="")
async def start(call: Call) -> Response:
    """Prints a file of the card."""
    name = (await posted(call)).get("filename") or call.request.query_params.get("filename")
    if not name or not isinstance(name, str):
        raise InputError.of("job.no-file")
    await call.bridge.start_print(cleaned(name))
    return _result("ok")


def _target(fields: Mapping[str, str], name: str) -> str:
    if (root := fields.get("root", _ROOT)) != _ROOT:
        raise InputError.of("upload.malformed", value=f"root is {root}: expected {_ROOT}")
    return program(f"{fields.get('path', '')}/{name}")


def _result(found: object) -> Response:
    return json({"result": found})
