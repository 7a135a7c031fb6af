"""OctoPrint's interface, for the requests with which slicers and hubs upload, start and watch.
Source: OctoPrint's REST API documentation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from starlette.responses import Response

from passo.errors import InputError, PassoError, WebError
from passo.web.answers import json
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.download import download
from passo.web.files.form_upload import receive_form
from passo.web.files.incoming import in_worker_thread
from passo.web.files.names import cleaned, confined, program
from passo.web.operation import operation
from passo.web.roles import Role
from passo.web.slicers.octoprint_status import job_state, printer_profile, printer_state, state_text
from passo.web.slicers.printing import posted, run_soon, started

if TYPE_CHECKING:
    from starlette.requests import Request

    from passo.card import Card, Entry

_DONE = 204
_DEPTH = 8  # of folders in a listing


@operation("octoprint.settings", "GET", "/api/settings", Role.VIEWER, root="")
async def settings(_: Call) -> Response:
    """The settings: no camera, no plug-ins."""
    feature = {"sdSupport": False, "temperatureGraph": False}
    return json({"plugins": {}, "feature": feature, "webcam": {"webcamEnabled": False}})


@operation("octoprint.profiles", "GET", "/api/printerprofiles", Role.VIEWER, root="")
async def profiles(call: Call) -> Response:
    """The profile of the machine."""
    return json({"profiles": {"_default": printer_profile(call.bridge.machine)}})


@operation("octoprint.printer", "GET", "/api/printer", Role.VIEWER, root="")
async def printer(call: Call) -> Response:
    """Temperatures and state."""
    return json(printer_state(call.bridge))


@operation("octoprint.job", "GET", "/api/job", Role.VIEWER, root="")
async def job(call: Call) -> Response:
    """The file that is printed, or selected, and its progress."""
    return json(job_state(call.bridge))


@operation("octoprint.order", "POST", "/api/job", Role.OPERATOR, root="")
async def order(call: Call) -> Response:
    """Starts, pauses, resumes or cancels the print."""
    wanted, bridge = await posted(call), call.bridge
    command, action = wanted.get("command"), wanted.get("action", "toggle")
    paused = bridge.latest().status.state.value == "A"
    if command in ("start", "restart"):
        path = bridge.latest().status.files.selected
        if not path:
            raise InputError.of("job.no-file")
        await bridge.start_print(path)
    elif command == "cancel":
        await bridge.cancel_print()
    elif command == "pause" and action in ("toggle", "pause", "resume"):
        if action == "resume" or (action == "toggle" and paused):
            await bridge.resume_print()
        else:
            await bridge.pause_print()
    else:
        raise _unknown(command)
    return Response(status_code=_DONE)


@operation("octoprint.connection", "GET", "/api/connection", Role.VIEWER, root="")
async def connection(call: Call) -> Response:
    """The state of the connection; the printer is always connected to this server."""
    text = state_text(call.bridge.latest().status)
    port = {"port": "passo", "baudrate": 250000, "printerProfile": "_default"}
    profile = {"id": "_default", "name": call.bridge.machine.name}
    options = {"ports": ["passo"], "baudrates": [250000], "printerProfiles": [profile]}
    return json({"current": {"state": text, **port}, "options": options})


@operation("octoprint.connect", "POST", "/api/connection", Role.OPERATOR, root="")
async def connect(call: Call) -> Response:
    """Connects to a halted printer by restarting it; does nothing otherwise."""
    wanted = await posted(call)
    if wanted.get("command") == "connect" and call.bridge.latest().status.halted:
        await call.bridge.restart()
    return Response(status_code=_DONE)


@operation("octoprint.command", "POST", "/api/printer/command", Role.OPERATOR, root="")
async def command(call: Call) -> Response:
    """Executes lines of G-code, in order."""
    wanted = await posted(call)
    lines: object = wanted.get("commands", [wanted.get("command")])
    if not isinstance(lines, list):
        raise _unknown(lines)
    texts: list[str] = []
    for line in lines:  # pyright: ignore[reportUnknownVariableType]
        if not isinstance(line, str):
            raise _unknown(line)  # pyright: ignore[reportUnknownArgumentType]
        texts.append(line)
    await run_soon(call, "\n".join(texts))
    return Response(status_code=_DONE)


@operation("octoprint.files", "GET", "/api/files", Role.VIEWER, root="")
async def all_files(call: Call) -> Response:
    """The files of the card's root, with those of its folders if `recursive` is true."""
    return await _listing(call)


@operation("octoprint.local", "GET", "/api/files/local", Role.VIEWER, root="")
async def local_files(call: Call) -> Response:
    """Like `all_files`, because there is no other storage."""
    return await _listing(call)


@operation(
    "octoprint.upload",
    "POST",
    "/api/files/local",
    Role.OPERATOR,
    consumes="multipart/form-data",
    root="",
)
async def upload(call: Call) -> Response:
    """Stores a file, and selects or prints it if the form asks for it. If the printer cannot print
    it now, the file stays and `effectivePrint` is false, as in OctoPrint. A form with a
    `foldername` makes a folder."""
    request, body = call.request, Body(call.request)
    try:
        form = await receive_form(body, call.site.uploads, _target)
    except PassoError:
        await body.drain()
        raise
    path = form.path
    if not path:
        if not (folder := form.fields.get("foldername")):
            raise InputError.of("upload.malformed", value="it has no file")
        path = cleaned(f"{form.fields.get('path', '')}/{folder}")
        card = await call.bridge.card()
        await in_worker_thread(lambda: card.make_directory(path))
        answer = {"done": True, "folder": _named(request, path)}
        return json(answer, 201, {"Location": _resource(request, path)})
    if printed := form.fields.get("print", "") == "true":
        selected = printed = await started(call.bridge, path)
    else:
        selected = form.fields.get("select", "") == "true" and await _selected(call, path)
    answer = {
        "done": True,
        "effectivePrint": printed,
        "effectiveSelect": selected,
        "files": {"local": _named(request, path)},
    }
    return json(answer, 201, {"Location": _resource(request, path)})


@operation("octoprint.file", "GET", "/api/files/local/{path:path}", Role.VIEWER, root="")
async def file(call: Call, path: str) -> Response:
    """One file, or a folder with its files."""
    card, path = await call.bridge.card(), confined(path)
    entry = await in_worker_thread(lambda: card.find(path))
    about = _entry(call.request, path, entry)
    if entry.is_directory:
        about["children"] = await _files(call, card, path)
    return json(about)


@operation("octoprint.download", "GET", "/downloads/files/local/{path:path}", Role.VIEWER, root="")
async def content(call: Call, path: str) -> Response:
    """The content of a file, or a range of it."""
    return await download(call.request, await call.bridge.card(), confined(path))


@operation("octoprint.select", "POST", "/api/files/local/{path:path}", Role.OPERATOR, root="")
async def select(call: Call, path: str) -> Response:
    """Selects a file, and prints it if `print` is true."""
    wanted, path = await posted(call), cleaned(path)
    if wanted.get("command") != "select":
        raise _unknown(wanted.get("command"))
    if wanted.get("print") is True:
        await call.bridge.start_print(path)
    else:
        await call.bridge.select_file(path)
    return Response(status_code=_DONE)


@operation("octoprint.remove", "DELETE", "/api/files/local/{path:path}", Role.OPERATOR, root="")
async def remove(call: Call, path: str) -> Response:
    """Deletes a file."""
    await call.bridge.remove_file(confined(path))
    return Response(status_code=_DONE)


def _unknown(command: object) -> WebError:
    return WebError.of("web.malformed", value=f"{command!r} is not a command")


def _target(fields: Mapping[str, str], name: str) -> str:
    return program(f"{fields.get('path', '')}/{name}")


async def _selected(call: Call, path: str) -> bool:
    try:
        await call.bridge.select_file(path)
    except PassoError:
        return False
    return True


def _resource(request: Request, path: str) -> str:
    return f"{request.base_url}api/files/local{quote(path)}"


def _named(request: Request, path: str) -> dict[str, Any]:
    name = path.rpartition("/")[2]
    download = f"{request.base_url}api/v1/files/content?path={quote(path)}"
    return {
        "name": name,
        "display": name,
        "path": path.removeprefix("/"),
        "origin": "local",
        "refs": {"resource": _resource(request, path), "download": download},
    }


def _entry(request: Request, path: str, entry: Entry) -> dict[str, Any]:
    kind = {"type": "machinecode", "typePath": ["machinecode", "gcode"]}
    about = {"size": entry.size, "date": int(entry.modified.timestamp())}
    if entry.is_directory:
        kind, about = {"type": "folder", "typePath": ["folder"]}, {}
    return {**_named(request, path), **kind, **about}


async def _listing(call: Call) -> Response:
    card = await call.bridge.card()
    files = await _files(call, card, "")
    free = await in_worker_thread(lambda: card.free_bytes)
    return json({"files": files, "free": free})


async def _files(call: Call, card: Card, top: str) -> list[dict[str, Any]]:
    """The files of a folder, with those of its folders if the request is `recursive`."""
    request = call.request
    deep = request.query_params.get("recursive", "").lower() == "true"

    def read(folder: str, depth: int) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        for entry in card.list(folder or "/"):
            path = f"{folder}/{entry.name}"
            about = _entry(request, path, entry)
            if entry.is_directory:
                about["children"] = read(path, depth - 1) if deep and depth else []
            found.append(about)
        return found

    return await in_worker_thread(lambda: read(top.rstrip("/"), _DEPTH))
