"""Builds of firmware, one at a time, each in a separate process."""

from __future__ import annotations

import asyncio
import io
import json
import os
import shutil
import signal
import sys
import time
import weakref
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from passo.errors import FirmwareError

if TYPE_CHECKING:
    from passo.toolchain.images import About

MAX_S = 300.0  # a build that takes longer is ended
_MAX_LINES = 2000  # of the log
_MAX_LINE = 1 << 20  # bytes of a line, far beyond what compilers print
_COMMAND = (sys.executable, "-m", "passo.toolchain.build_job")


class Image(Struct):
    """A built image: its file name in the zip, its sizes in bytes, and the memory sizes of the
    chip."""

    file: str
    board: str
    mcu: str
    flash_bytes: int
    flash_size: int
    ram_bytes: int
    ram_size: int
    sha256: str


class Build(Struct):
    """A build. `of` is the name of the machine or board; `log` has its lines so far; `seconds` is
    its duration so far."""

    number: int
    of: str
    state: Literal["running", "done", "failed", "cancelled"]
    log: list[str]
    images: list[Image]
    seconds: float


class Builds:
    """The builds of one printer. Use it only in the web's event loop. `listeners` are called with
    each line of the log, and at the end of a build."""

    def __init__(self) -> None:
        self._folder: Path | None = None
        self._order: Mapping[str, str] = {}
        self._task: asyncio.Task[None] | None = None
        self._started_s = 0.0
        self._last: Build | None = None
        self.listeners: list[Callable[[int, str, str], None]] = []

    @property
    def last(self) -> Build | None:
        """The current or the last build; None before the first."""
        if self._last is not None and self._last.state == "running":
            self._last.seconds = time.monotonic() - self._started_s
        return self._last

    def start(self, of: str, order: Mapping[str, str]) -> Build:
        """Starts a build. `order` is the JSON object for `passo.toolchain.build_job`, without the
        folder. Raises FirmwareError `firmware.busy`."""
        if self._task is not None and not self._task.done():
            raise FirmwareError.of("firmware.busy")
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
        self._folder = folder = Path(mkdtemp(prefix="passo-firmware-"))
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self._order = order
        number = self._last.number + 1 if self._last else 1
        self._last = build = Build(number, of, "running", [], [], 0.0)
        self._started_s = time.monotonic()
        text = json.dumps({**order, "output": str(folder)})
        self._task = asyncio.get_running_loop().create_task(self._run(build, text, folder))
        return build

    async def cancel(self) -> None:
        """Ends the current build, if there is one."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.wait([self._task])

    def image(self, file: str) -> tuple[Mapping[str, str], Path] | None:
        """The order of the last build, and the path of its image of that name, if it has one."""
        known = self._last is not None and any(image.file == file for image in self._last.images)
        return (self._order, self._folder / file) if known and self._folder else None

    def zipped(self) -> bytes:
        """The images of the last build with their descriptions, and its log; a build that has
        failed has only the log. Blocks during access to the disk."""
        import zipfile

        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            if self._folder is not None and self._last and self._last.images:
                for path in sorted(self._folder.iterdir()):
                    archive.write(path, path.name)
            archive.writestr("build.log", "".join(f"{line}\n" for line in self._last_log))
        return packed.getvalue()

    @property
    def _last_log(self) -> list[str]:
        return self._last.log if self._last else []

    async def _run(self, build: Build, order: str, folder: Path) -> None:
        try:
            async with asyncio.timeout(MAX_S):
                await self._carry_out(build, order, folder)
        except TimeoutError:
            self._end(build, "failed", f"The build was ended: it took longer than {MAX_S:g} s.")
        except asyncio.CancelledError:
            self._end(build, "cancelled", "Cancelled.")
        except OSError as error:
            self._end(build, "failed", f"The build cannot be started: {error.strerror}.")

    async def _carry_out(self, build: Build, order: str, folder: Path) -> None:
        process = await asyncio.create_subprocess_exec(
            *_COMMAND,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            start_new_session=True,  # so that its compilers can be ended with it
            limit=_MAX_LINE,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        end = weakref.finalize(self, _kill, process.pid)
        try:
            process.stdin.write(order.encode())
            process.stdin.close()
            async for line in process.stdout:
                self._tell(build, line.decode("utf-8", "replace").rstrip())
            status = await process.wait()
        finally:
            end()
            await process.stdout.read()
            await process.wait()
        if status == 0:
            build.images = await asyncio.to_thread(_images, folder)
        self._end(build, "done" if status == 0 else "failed")

    def _tell(self, build: Build, line: str) -> None:
        if len(build.log) < _MAX_LINES:
            build.log.append(line)
            self._call(build, line)

    def _end(
        self, build: Build, state: Literal["done", "failed", "cancelled"], why: str = ""
    ) -> None:
        build.state, build.seconds = state, time.monotonic() - self._started_s
        if why:
            build.log.append(why)
        self._call(build, why)

    def _call(self, build: Build, line: str) -> None:
        for listener in list(self.listeners):
            listener(build.number, build.state, line)


def _kill(group: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(group, signal.SIGKILL)


def _images(folder: Path) -> list[Image]:
    from passo.toolchain.images import read_about

    abouts = (read_about(path) for path in sorted(folder.glob("*.json")))
    return [_image(about) for about in abouts if about is not None]


def _image(about: About) -> Image:
    return Image(
        about.image,
        about.board,
        about.mcu,
        about.flash_bytes,
        about.flash_size,
        about.ram_bytes,
        about.ram_size,
        about.sha256,
    )
