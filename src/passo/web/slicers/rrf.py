"""RepRapFirmware's `rr_*` requests, for slicers and scripts, and the requests of APrinter, which
have the same names. Source: RepRapFirmware's description of its HTTP requests."""

from __future__ import annotations

import re
import zlib
from collections.abc import AsyncGenerator
from typing import Any

from starlette.responses import Response, StreamingResponse

from passo.errors import CardError, InputError, PassoError
from passo.web.answers import json, refusal
from passo.web.call import Call
from passo.web.files.body import Body
from passo.web.files.download import download
from passo.web.files.incoming import in_worker_thread
from passo.web.files.names import cleaned, confined, program
from passo.web.operation import operation
from passo.web.requests import limited
from passo.web.roles import Role
from passo.web.slicers.printing import run_soon, sentence
from passo.web.slicers.rrf_status import aprinter_status, rrf_status

_MAX_GCODE = 1 << 16  # maximum bytes of lines in one request
_PREFIX = re.compile(r"^(?:\d:)?/?(?:(?:gcodes|sdcard)(?:/|$))?", re.IGNORECASE)
_FILE_COMMAND = re.compile(r"\s*(M23|M32)\s+\"?([^\"]+?)\"?\s*", re.IGNORECASE)
_BUFFER = 255  # reported size of the command buffer in bytes, as in RepRapFirmware


def on_card(path: str) -> str:
    """The path on the card for `0:/gcodes/…` or `/sdcard/…`. Raises CardError."""
    return confined(_without_prefix(path))


def _without_prefix(path: str) -> str:
    return _PREFIX.sub("", path, count=1)


@operation("rrf.connect", "GET", "/rr_connect", Role.PUBLIC, root="")
async def connect(call: Call) -> Response:
    """Starts a session. The password is an API key, if there are accounts."""
    password = call.request.query_params.get("password", "")
    if call.caller.role is Role.PUBLIC and not call.access.connect(call.request, password):
        return json({"err": 1})
    return json({"err": 0, "sessionTimeout": 8000, "boardType": "passo", "apiLevel": 0})


@operation("rrf.disconnect", "GET", "/rr_disconnect", Role.VIEWER, root="")
async def disconnect(call: Call) -> Response:
    """Ends the session."""
    call.access.connected.end(_address(call))
    return json({"err": 0})


@operation("rrf.status", "GET", "/rr_status", Role.VIEWER, root="")
async def status(call: Call) -> Response:
    """The status: with `type` (1 to 3) in RepRapFirmware's format, without it in APrinter's."""
    kind = call.request.query_params.get("type")
    if kind is None:
        return json(aprinter_status(call.bridge))
    return json(rrf_status(call.bridge, int(kind) if kind in ("1", "2", "3") else 1))


@operation("rrf.config", "GET", "/rr_config", Role.VIEWER, root="")
async def config(_: Call) -> Response:
    """APrinter's stored options; always empty."""
    return json({"options": []})


@operation("rrf.gcode", "GET", "/rr_gcode", Role.OPERATOR, root="")
async def gcode(call: Call) -> Response:
    """Executes a line; `rr_reply` returns its answer."""
    line = call.request.query_params.get("gcode", "")
    try:
        if file := _FILE_COMMAND.fullmatch(line):
            path = cleaned(_without_prefix(file[2]))  # as the upload has named it
            act = call.bridge.start_print if file[1].upper() == "M32" else call.bridge.select_file
            await act(path)
        else:
            call.site.rrf_replies.extend(await run_soon(call, line))
    except PassoError as error:
        call.site.rrf_replies.append(f"Error: {sentence(error)}")
    return json({"buff": _BUFFER})


@operation("rrf.reply", "GET", "/rr_reply", Role.VIEWER, root="")
async def reply(call: Call) -> Response:
    """The answers to lines since the last call."""
    text = "".join(f"{line}\n" for line in call.site.rrf_replies)
    call.site.rrf_replies.clear()
    return Response(text, media_type="text/plain")


@operation("rrf.console", "POST", "/rr_gcode", Role.OPERATOR, consumes="text/plain", root="")
async def console(call: Call) -> Response:
    """APrinter's console: executes the lines of the body one after the other, and returns their
    answers, each with `ok`."""
    lines = (await limited(call.request, _MAX_GCODE)).decode("utf-8", "replace").splitlines()

    async def answers() -> AsyncGenerator[str]:
        for line in lines:
            if not line.strip():
                continue
            try:
                for text in await call.run(line):
                    yield f"{text}\n"
            except PassoError as error:
                yield f"Error:{sentence(error)}\n"
            yield "ok\n"

    headers = {"X-Content-Type-Options": "nosniff"}
    return StreamingResponse(answers(), headers=headers, media_type="text/plain")


@operation(
    "rrf.upload",
    "POST",
    "/rr_upload",
    Role.OPERATOR,
    consumes="application/octet-stream",
    root="",
)
async def upload(call: Call) -> Response:
    """Stores the body as a file, if its CRC matches the given one."""
    body, query = Body(call.request), call.request.query_params
    try:
        path = program(_without_prefix(query.get("name", "")))
        crc = 0
        async with call.site.uploads.file(path, total=body.length) as incoming:
            async for data in body.pieces():
                crc = zlib.crc32(data, crc)
                await incoming.write(data)
            wanted = query.get("crc32")
            if wanted is not None and wanted.lower().lstrip("0") != f"{crc:x}".lstrip("0"):
                text = f"its CRC-32 is {crc:08x}, not {wanted}"
                raise InputError.of("upload.malformed", value=text)
    except PassoError as error:
        await body.drain()
        return _failed(error)
    call.access.connected.renew(_address(call), call.caller)
    return json({"err": 0})


@operation("rrf.files", "GET", "/rr_filelist", Role.VIEWER, root="")
async def filelist(call: Call) -> Response:
    """The content of a folder, with sizes and dates."""
    folder = call.request.query_params.get("dir", "")
    try:
        card, path = await call.bridge.card(), on_card(folder)
        entries = await in_worker_thread(lambda: card.list(path))
    except PassoError as error:
        return json({"dir": folder, "err": 2 if _is_missing(error) else 1})
    listed = [
        {
            "type": "d" if entry.is_directory else "f",
            "name": entry.name,
            "size": entry.size,
            "date": f"{entry.modified:%Y-%m-%dT%H:%M:%S}",
        }
        for entry in entries
    ]
    return json({"dir": folder, "first": 0, "files": listed, "next": 0})


@operation("rrf.names", "GET", "/rr_files", Role.VIEWER, root="")
async def names(call: Call) -> Response:
    """The names in a folder; those of folders begin with * if `flagDirs` is 1."""
    query = call.request.query_params
    folder = query.get("dir")
    if folder is None:
        return Response("Unprocessable Entity\n", 422, media_type="text/plain")
    flag = "*" if query.get("flagDirs") == "1" else ""
    card, path = await call.bridge.card(), on_card(folder)
    entries = await in_worker_thread(lambda: card.list(path))
    listed = [
        f"{flag if entry.is_directory else ''}{entry.name}"
        for entry in entries
        if not entry.name.startswith(".")
    ]
    return json({"dir": folder, "files": listed})


@operation("rrf.info", "GET", "/rr_fileinfo", Role.VIEWER, root="")
async def fileinfo(call: Call) -> Response:
    """The facts about a file, or about the file that is being printed."""
    name, job = call.request.query_params.get("name"), call.bridge.latest().status.job
    if name is None and job is None:
        return json({"err": 1})
    try:
        path = on_card(name) if name is not None else confined(job.path if job else "")
        card = await call.bridge.card()
        entry = await in_worker_thread(lambda: card.find(path))
        known = await call.site.metadata.get(path)
    except PassoError:
        return json({"err": 1})
    found: dict[str, Any] = {
        "err": 0,
        "fileName": entry.name,
        "size": entry.size,
        "lastModified": f"{entry.modified:%Y-%m-%dT%H:%M:%S}",
        "generatedBy": known.slicer,
    }
    if known.plan is not None:
        found["printTime"] = round(known.plan.total_s)
        found["numLayers"] = known.plan.layers
        found["filament"] = list(known.plan.filament_mm.values())
    if name is None and job is not None:
        found["printDuration"] = round(job.printed_s)
    return json(found)


@operation("rrf.mkdir", "GET", "/rr_mkdir", Role.OPERATOR, root="")
async def mkdir(call: Call) -> Response:
    """Makes a folder."""
    try:
        path = cleaned(_without_prefix(call.request.query_params.get("dir", "")))
        card = await call.bridge.card()
        await in_worker_thread(lambda: card.make_directory(path))
    except PassoError as error:
        return _failed(error)
    return json({"err": 0})


@operation("rrf.move", "GET", "/rr_move", Role.OPERATOR, root="")
async def move(call: Call) -> Response:
    """Renames or moves a file or folder."""
    query = call.request.query_params
    try:
        old, new = on_card(query.get("old", "")), on_card(query.get("new", ""))
        if query.get("deleteexisting") == "yes":
            await _remove(call, new, missing=True)
        await call.bridge.rename(old, new)
    except PassoError as error:
        return _failed(error)
    return json({"err": 0})


@operation("rrf.delete", "GET", "/rr_delete", Role.OPERATOR, root="")
async def delete(call: Call) -> Response:
    """Deletes a file, or an empty folder."""
    try:
        await _remove(call, on_card(call.request.query_params.get("name", "")))
    except PassoError as error:
        return _failed(error)
    return json({"err": 0})


@operation("rrf.download", "GET", "/rr_download", Role.VIEWER, root="")
async def download_file(call: Call) -> Response:
    """The bytes of a file."""
    path = on_card(call.request.query_params.get("name", ""))
    return await download(call.request, await call.bridge.card(), path)


def _address(call: Call) -> str:
    return "" if call.request.client is None else call.request.client.host


async def _remove(call: Call, path: str, *, missing: bool = False) -> None:
    card = await call.bridge.card()
    try:
        entry = await in_worker_thread(lambda: card.find(path))
    except CardError as error:
        if missing and _is_missing(error):
            return
        raise
    if entry.is_directory:
        await in_worker_thread(lambda: card.remove_directory(path))
    else:
        await call.bridge.remove_file(path)


def _failed(error: PassoError) -> Response:
    """The answer for an error: the HTTP status for clients that check it, and `err` for others."""
    return json({"err": 1, "error": sentence(error)}, refusal(error).status_code)


def _is_missing(error: PassoError) -> bool:
    return error.problems[0].code == "card.not-found"
