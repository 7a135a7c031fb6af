"""The firmware of boards: what each board needs, and its images."""

from __future__ import annotations

import asyncio
from typing import Annotated

from msgspec import Meta, Struct
from starlette.responses import Response

from passo import config
from passo.catalogue import codes_of
from passo.config.board import Board
from passo.errors import ConfigError, FirmwareError, WebError
from passo.toolchain.targets import state
from passo.web.call import Call
from passo.web.firmware.builds import Build
from passo.web.machine import file
from passo.web.operation import operation
from passo.web.roles import Role

_ZIP = "application/zip"
_CONFIG_ERRORS = codes_of("config")


class BoardOfList(Struct):
    """A board: its description, the program that flashes it (`flash`, null if there is none), and
    the manual steps before and after. `state` is `ready`, or names what is missing."""

    name: str
    description: str
    mcu: str
    console: str
    flash: str | None
    before: list[str]
    after: list[str]
    notes: list[str]
    state: str


class Boards(Struct):
    """`machine` are the boards of the machine by name; the name of the main board is empty.
    `shipped` are all boards that come with Passo."""

    machine: dict[str, BoardOfList]
    shipped: list[BoardOfList]


class BuildOrder(Struct, forbid_unknown_fields=True):
    """The images to build: for the shipped board `board`; or for all boards of the machine file
    `text`; or for those of the printer's machine file if both are null. `board` has priority over
    `text`."""

    board: Annotated[str, Meta(max_length=100)] | None = None
    text: Annotated[str, Meta(max_length=500_000)] | None = None


@operation("firmware.boards", "GET", "/firmware/boards", Role.VIEWER)
async def boards(call: Call) -> Boards:
    """The boards of the machine, and all boards that come with Passo, with the steps that each
    needs."""
    machine = call.bridge.machine

    def found() -> Boards:
        shipped = [_row(name, config.load_board(name)) for name in config.shipped_boards()]
        own = {name: _row(board.name, board) for name, board in machine.all_boards.items()}
        return Boards(own, shipped)

    return await asyncio.to_thread(found)


@operation(
    "firmware.build",
    "POST",
    "/firmware/build",
    Role.ADMIN,
    errors=("firmware.busy", "firmware.board", "machine.no-file", *_CONFIG_ERRORS),
    status=202,
)
async def build(call: Call, body: BuildOrder) -> Build:
    """Starts a build of images in a separate process, one build at a time. The feed sends each line
    of the log; `firmware.last` has the whole log."""
    if body.board is not None:
        if body.board not in config.shipped_boards():
            raise FirmwareError.of("firmware.board", value=body.board)
        return call.site.builds.start(body.board, {"board": body.board})
    source, machine = call.bridge.machine_source, call.bridge.machine
    text = body.text
    if text is None:
        if not source:
            raise ConfigError.of("machine.no-file", value=machine.name)
        text = await asyncio.to_thread(file.read, source, machine)
    loaded = await asyncio.to_thread(file.loaded, source, text)
    order = {"text": text, "name": file.name_of_text(source)}
    return call.site.builds.start(loaded.machine.name, order)


@operation("firmware.last", "GET", "/firmware/build", Role.VIEWER, errors=("web.not-found",))
async def last(call: Call) -> Build:
    """The current or the last build, with its log and the sizes of its images."""
    return _last(call)


@operation("firmware.cancel", "DELETE", "/firmware/build", Role.ADMIN)
async def cancel(call: Call) -> None:
    """Ends the build that is running, if there is one."""
    await call.site.builds.cancel()


@operation(
    "firmware.download",
    "GET",
    "/firmware/build/zip",
    Role.OPERATOR,
    errors=("web.not-found",),
    produces=_ZIP,
)
async def download(call: Call) -> Response:
    """The images of the last build with their descriptions (JSON) and its log, as one zip."""
    of = _last(call).of
    content = await asyncio.to_thread(call.site.builds.zipped)
    headers = {"Content-Disposition": f'attachment; filename="firmware-{of}.zip"'}
    return Response(content, headers=headers, media_type=_ZIP)


def _last(call: Call) -> Build:
    if (last := call.site.builds.last) is None:
        raise WebError.of("web.not-found", value="build yet")
    return last


def _row(name: str, board: Board) -> BoardOfList:
    console = board.console
    uart = f"{console.uart} " if console and console.uart else ""
    return BoardOfList(
        name=name,
        description=board.description,
        mcu=board.mcu,
        console=f"{uart}{console.baud} baud" if console else "",
        flash=board.flash.method if board.flash else None,
        before=board.flash.before if board.flash else [],
        after=board.flash.after if board.flash else [],
        notes=list(board.notes),
        state=state(board),
    )
