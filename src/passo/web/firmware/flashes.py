"""Flashing of boards, one at a time, each in a separate process."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from msgspec import Struct

from passo.errors import FirmwareError

_COMMAND = (sys.executable, "-m", "passo.toolchain.flash_job")
_MAX_LINES = 2000  # of the log
_MAX_LINE = 1 << 20  # bytes of a line: progress of a program that never ends its line


class Flash(Struct):
    """The current or the last flashing of a board; its state is `idle` before the first one. The
    state is `waiting` while the user has to do the manual step in `asks`. `log` has the lines so
    far, including those of the flash program."""

    image: str
    port: str
    state: Literal["idle", "running", "waiting", "done", "failed", "cancelled"]
    asks: str
    log: list[str]


class Flashes:
    """The boards that one printer's computer flashes; use it only in the web's event loop."""

    def __init__(self) -> None:
        self.last = Flash("", "", "idle", "", [])
        self._task: asyncio.Task[None] | None = None
        self._process: asyncio.subprocess.Process | None = None

    @property
    def busy(self) -> bool:
        """Whether a board is being flashed."""
        return self._task is not None and not self._task.done()

    def start(self, order: Mapping[str, str], image: Path, port: str | None) -> Flash:
        """Starts to flash `image`, which was built by `order`. Raises FirmwareError
        `firmware.busy`."""
        if self.busy:
            raise FirmwareError.of("firmware.busy")
        self.last = flash = Flash(image.name, port or "", "running", "", [])
        line = json.dumps({**order, "image": str(image), "port": port})
        self._task = asyncio.get_running_loop().create_task(self._run(flash, line))
        return flash

    def confirm(self) -> None:
        """Confirms that the manual step is done. Does nothing if there is none."""
        if self.last.state == "waiting":
            self.last.state, self.last.asks = "running", ""
            self._write(b"\n")

    async def cancel(self) -> None:
        """Cancels flashing while it waits for a manual step. Has no effect while a program writes,
        because a board with half an image does not start."""
        if self.last.state == "waiting" and self._task is not None:
            self.last.state = "cancelled"
            self._write(None)
            await asyncio.wait([self._task])

    def _write(self, answer: bytes | None) -> None:
        """Answers the job; None ends its input."""
        process = self._process
        if process is None or process.stdin is None:
            return
        if answer is None:
            process.stdin.close()
        else:
            process.stdin.write(answer)

    async def _run(self, flash: Flash, order: str) -> None:
        from passo.toolchain.flash_job import ASKS

        try:
            self._process = process = await asyncio.create_subprocess_exec(
                *_COMMAND,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.STDOUT,
                limit=_MAX_LINE,
            )
        except OSError as error:
            flash.log.append(f"Flashing cannot be started: {error.strerror}.")
            flash.state = "failed"
            return
        assert process.stdout is not None
        self._write(f"{order}\n".encode())
        async for line in process.stdout:
            text = line.decode("utf-8", "replace").rstrip()
            if text.startswith(ASKS):
                flash.asks = text.removeprefix(ASKS)
                flash.state = "waiting"
                text = flash.asks
            if text and len(flash.log) < _MAX_LINES:
                flash.log.append(text)
        status = await process.wait()
        if flash.state != "cancelled":
            flash.state = "done" if status == 0 else "failed"
        flash.asks = ""
