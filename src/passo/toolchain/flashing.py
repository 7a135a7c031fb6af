"""Flashes an image onto a board: step by step, with manual steps in between."""

from __future__ import annotations

import asyncio
import os
import shutil
import stat
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from passo.config.board import Board
from passo.errors import FirmwareError, Problem
from passo.serial_line import open_serial_line
from passo.toolchain.build import check_buildable, image_name
from passo.toolchain.carried import Carried
from passo.toolchain.flash_plan import SUFFIXES, Copy, Hands, Run, Step, Touch, plan
from passo.toolchain.images import Checked, about_path, check_image
from passo.toolchain.readback import identify
from passo.toolchain.targets import Target

_LOADER_STARTS_S = 0.5
_TOUCH_BAUD = 1200
_DRIVE_MARK = "INFO_UF2.TXT"


@dataclass(frozen=True, slots=True)
class User:
    """The interface to the user: `tell` shows a line; `wait` shows a manual step and returns when
    the user has done it."""

    tell: Callable[[str], None]
    wait: Callable[[str], None]


async def flash(name: str, board: Board, port: str | None, image: Path, user: User) -> None:
    """Flashes `image` onto the board called `name` at `port`, and verifies the board's identity
    after that.

    Raises FirmwareError: before the first step if the image, the port or the program is wrong or
    missing, later if a step fails.
    """
    port = port or None
    steps = plan(name, board, port, image)
    checked = _check_image(name, board, image)
    _check_tools(name, steps)
    _check_port(port, partial(_check_serial, name), name, steps)
    _tell_doubts(image, checked.unknown, user)
    touched = False  # opening the port at 1200 baud again would restart the boot loader
    for step in steps:
        match step:
            case Hands():
                user.wait(str(step))
            case Touch():
                await _touch(name, step)
                touched = True
            case Run():
                if port is not None and not touched:
                    _check_serial(name, port)
                user.tell(str(step))
                await _run(name, step)
            case Copy():
                user.tell(str(step))
                _copy(name, step)
    await _read_back(name, board, port, checked.carried, user)


def show_steps(target: Target, port: str | None, image: Path | None, user: User) -> None:
    """Shows the steps of a flash, and what would make them fail now: a missing compiler or program,
    problems of the port. Builds and writes nothing; without `image` a build is the first step.

    Raises FirmwareError if the board cannot be flashed, the port is not given, or the image is
    wrong.
    """
    name, board, port = target.name, target.board, port or None
    steps = plan(name, board, port, image or Path(image_name(target)))
    lines = [str(step) for step in steps]
    if image is None:
        lines.insert(0, f"build {image_name(target)}")
        _tell_obstacle(partial(check_buildable, target), user)
    else:
        _tell_doubts(image, _check_image(name, board, image).unknown, user)
    _tell_obstacles(name, port, steps, user)
    for number, line in enumerate(lines, 1):
        user.tell(f"{number}. {line}")


def _check_image(name: str, board: Board, image: Path) -> Checked:
    suffixes = SUFFIXES.get(board.flash.method, ()) if board.flash else ()
    return check_image(image, name, board, suffixes)


def _tell_doubts(image: Path, unknown: tuple[str, ...], user: User) -> None:
    if unknown:
        beside, what = about_path(image).name, " and ".join(unknown)
        user.tell(f"{image}: without the {beside} of its build nobody knows that it {what}.")


def _tell_obstacles(name: str, port: str | None, steps: list[Step], user: User) -> None:
    """Reports the obstacles that would make the steps fail now."""
    if port is not None and not Path(port).exists():
        user.tell(f"{port}: nothing is there now.")

    def look(path: str) -> None:
        # the port is not opened, because that would reset many boards
        if not stat.S_ISCHR(Path(path).stat().st_mode):
            raise _problem("firmware.port", axis=name, value=path, limit="a serial port")

    for check in (_check_tools, partial(_check_port, port, look)):
        _tell_obstacle(partial(check, name, steps), user)


def _tell_obstacle(check: Callable[[], None], user: User) -> None:
    try:
        check()
    except FirmwareError as error:
        user.tell(f"As things are, {error}")


def _check_tools(name: str, steps: list[Step]) -> None:
    for step in steps:
        if isinstance(step, Run) and shutil.which(step.words[0]) is None:
            raise _problem("firmware.tool", value=step.words[0], axis=name)


def _check_port(
    port: str | None, check_serial: Callable[[str], None], name: str, steps: list[Step]
) -> None:
    """Checks the port. A missing port may appear after a manual step; a wrong one must not destroy
    the firmware."""
    if port is None or not Path(port).exists():
        return
    if not any(isinstance(it, Copy) for it in steps):
        check_serial(port)
    elif not _may_become_drive(Path(port)):
        raise _no_drive(name, Path(port))


def _check_serial(name: str, port: str) -> None:
    try:
        line = os.open(port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        expected = f"a serial port that opens ({error.strerror})"
        raise _problem("firmware.port", axis=name, value=port, limit=expected) from None
    is_terminal = os.isatty(line)
    os.close(line)
    if not is_terminal:
        raise _problem("firmware.port", axis=name, value=port, limit="a serial port")


async def _touch(name: str, step: Touch) -> None:
    try:
        os.close(open_serial_line(step.port, _TOUCH_BAUD))
    except OSError as error:
        expected = f"a serial port that opens ({error.strerror})"
        raise _problem("firmware.port", axis=name, value=step.port, limit=expected) from None
    await asyncio.sleep(_LOADER_STARTS_S)


async def _run(name: str, step: Run) -> None:
    tool = await asyncio.create_subprocess_exec(*step.words)
    status = await tool.wait()
    if status != 0:
        why = f"{step.words[0]} ended with status {status}"
        raise _problem("firmware.flash", axis=name, value=why)


def _may_become_drive(folder: Path) -> bool:
    """Whether the folder is the drive, or is empty so that the drive may be mounted on it later."""
    if not folder.is_dir():
        return False
    try:
        return (folder / _DRIVE_MARK).is_file() or not any(folder.iterdir())
    except OSError:  # the folder may become readable when the drive is mounted
        return True


def _no_drive(name: str, folder: Path) -> FirmwareError:
    expected = f"the folder of its drive, which holds {_DRIVE_MARK}"
    return _problem("firmware.port", axis=name, value=str(folder), limit=expected)


def _copy(name: str, step: Copy) -> None:
    if not (step.folder / _DRIVE_MARK).is_file():
        raise _no_drive(name, step.folder)
    try:
        with (step.folder / step.image.name).open("wb") as target:
            target.write(step.image.read_bytes())
            target.flush()
            os.fsync(target.fileno())
    except OSError as error:
        why = f"the image cannot be copied ({error.strerror})"
        raise _problem("firmware.flash", axis=name, value=why) from None


async def _read_back(
    name: str, board: Board, port: str | None, carried: Carried | None, user: User
) -> None:
    console = board.console
    if console is None or console.connector != "serial" or port is None:
        user.tell(f"{name}: written. It speaks on {_console(board)}, so it was not asked.")
        return
    try:
        found = await identify(port, console.baud)
    except OSError as error:
        why = f"{port}: the image was written, but the port cannot be read ({error.strerror})"
        raise _problem("firmware.silent", axis=name, value=why) from None
    if found is None or found.dictionary is None:
        raise _problem("firmware.silent", axis=name, value=f"{port}, {console.baud} baud")
    if carried is not None and found.compressed != carried.compressed:
        versions = f"{found.dictionary.version!r}, not {carried.dictionary.version!r}"
        why = f"its dictionary is of version {versions}"
        raise _problem("firmware.other", axis=name, value=why)
    version, count = found.dictionary.version, len(found.dictionary.commands)
    user.tell(f"{name}: written, and it answers: version {version}, {count} commands.")


def _console(board: Board) -> str:
    if board.console is None or not board.console.pins:
        return "no port that is known here"
    receive, transmit = board.console.pins
    return f"{board.console.uart} (receives on {receive}, sends on {transmit})"


def _problem(code: str, **values: str) -> FirmwareError:
    return FirmwareError([Problem(code, values=values)])
