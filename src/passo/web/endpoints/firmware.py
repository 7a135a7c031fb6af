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
from passo.printer.status import Status
from passo.web.call import Call
from passo.web.firmware.builds import Build
from passo.web.firmware.flashes import Flash
from passo.web.firmware.ports import Port, ports
from passo.web.machine import file
from passo.web.operation import operation
from passo.web.roles import Role

_ZIP = "application/zip"
_CONFIG_ERRORS = codes_of("config")


class BoardOfList(Struct):
    """A board: its description, the program that flashes it (`flash`, null without one), and
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


class FlashOrder(Struct, forbid_unknown_fields=True):
    """An image of the last build by its file, and the port of the board, one of `firmware.ports`.
    Boards that are flashed through a programmer need none."""

    image: Annotated[str, Meta(max_length=200)]
    port: Annotated[str, Meta(max_length=200)] | None = None


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
    """Starts a build of images in a separate process, one build at a time, while no board is being
    flashed. The feed sends each line of the log; `firmware.last` has the whole log."""
    if call.site.flashes.busy:
        raise FirmwareError.of("firmware.busy")
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


@operation("firmware.ports", "GET", "/firmware/ports", Role.ADMIN)
async def list_ports(call: Call) -> list[Port]:
    """The ports of the computer of the printer through which a board may be flashed."""
    return await _ports(call)


@operation(
    "firmware.flash",
    "POST",
    "/firmware/flash",
    Role.ADMIN,
    errors=(
        *("web.not-found", "web.password", "firmware.busy", "firmware.not-now"),
        *("firmware.no-port", "firmware.port-used", *_CONFIG_ERRORS),
    ),
    status=202,
)
async def flash(call: Call, body: FlashOrder) -> Flash:
    """Starts to flash an image of the last build onto its board, in a separate process, one board
    at a time. `firmware.flashing` has the log, and the manual steps. If there are accounts, the
    password must have been entered within the last minutes."""
    call.access.require_password(call.caller)
    found = call.site.builds.image(body.image)
    if found is None:
        raise WebError.of("web.not-found", value=f"image {body.image} of the last build")
    if (why := _why_not_now(call.bridge.latest().status)) is not None:
        raise FirmwareError.of("firmware.not-now", value=why)
    if body.port is not None:
        port = next((port for port in await _ports(call) if port.path == body.port), None)
        if port is None:
            raise WebError.of("web.not-found", value=f"port {body.port}")
        if port.used:
            raise FirmwareError.of("firmware.port-used", value=body.port)
    order, image = found
    return call.site.flashes.start(order, image, body.port)


@operation("firmware.flashing", "GET", "/firmware/flash", Role.VIEWER)
async def flashing(call: Call) -> Flash:
    """The board that is being flashed, or the last one, with the log."""
    return call.site.flashes.last


@operation("firmware.confirm", "POST", "/firmware/flash/confirm", Role.ADMIN)
async def confirm(call: Call) -> None:
    """Confirms that the manual step that `firmware.flashing` asks for is done."""
    call.site.flashes.confirm()


@operation("firmware.cancel_flash", "DELETE", "/firmware/flash", Role.ADMIN)
async def cancel_flash(call: Call) -> None:
    """Cancels flashing while it waits for a manual step. Has no effect while the image is being
    written."""
    await call.site.flashes.cancel()


async def _ports(call: Call) -> list[Port]:
    return await asyncio.to_thread(ports, call.bridge.machine, call.bridge.places)


def _why_not_now(status: Status) -> str | None:
    if status.job is not None:
        return f"{status.job.file} is being printed"
    hot = [name for name, heater in status.heaters.items() if heater.target_c > 0]
    return f"heaters are on ({', '.join(hot)})" if hot else None


def _last(call: Call) -> Build:
    if (last := call.site.builds.last) is None:
        raise WebError.of("web.not-found", value="build yet")
    return last


def _row(name: str, board: Board) -> BoardOfList:
    from passo.toolchain.targets import state

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
