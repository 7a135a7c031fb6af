"""`passo serve` in a process of its own, and a console beside the host's to ask it how it is."""

from __future__ import annotations

import re
import socket
import subprocess
import sys
from pathlib import Path

START_S = 30.0
ANSWER_S = 60.0


def free_port() -> int:
    """A TCP port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Served:
    """A printer on a pty, on TCP, with a card, and with a web interface and Klipper's socket if the
    test wants them. Its print time passes as fast as it goes, or so many times as fast as real."""

    def __init__(
        self,
        folder: Path,
        machine: str = "i3",
        *,
        clock: str = "fast",
        web: bool = False,
        klippy: bool = False,
    ) -> None:
        self.pty = str(folder / "printer")
        self.tcp = f"127.0.0.1:{free_port()}"
        self.card = folder / "card"
        self.card.mkdir()
        words = [sys.executable, "-m", "passo", "serve", "--machine", machine, "--clock", clock]
        self.http = f"127.0.0.1:{free_port()}" if web else "none"
        words += ["--http", self.http]
        words += ["--pty", self.pty, "--tcp", self.tcp, "--sd", str(self.card)]
        self.klippy = str(folder / "klippy.sock")
        words += ["--klippy-socket", self.klippy] if klippy else []
        self._process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        assert self._process.stderr is not None
        said: list[str] = []  # the web interface may have something to say first
        for line in self._process.stderr:
            said.append(line)
            if line.startswith("Serving"):
                break
        assert said and said[-1].startswith("Serving"), "".join(said)
        host, _, port = self.tcp.rpartition(":")
        self._socket = socket.create_connection((host, int(port)), timeout=ANSWER_S)
        self._lines = self._socket.makefile("r", encoding="ascii", newline="\n")

    def ask(self, command: str) -> list[str]:
        """Sends a command and returns what came with its `ok`, the `ok` line last."""
        self._socket.sendall(f"{command}\n".encode())
        answer: list[str] = []
        while not answer or not answer[-1].startswith("ok"):
            line = self._lines.readline().strip()
            assert line, f"the printer has hung up on {command}"
            answer.append(line)
        return answer

    def wait_for(self, text: str) -> None:
        """Reads on until a line begins with the text."""
        while not self._lines.readline().startswith(text):
            pass

    def position(self) -> dict[str, float]:
        """Where the program is (x, y, z in mm, e in mm of filament since G92) and, as `steps_*`,
        where the motors are, when all moves are done."""
        self.ask("M400")
        report = next(line for line in self.ask("M114") if " Count " in line)
        program, _, motors = report.partition(" Count ")
        found = {k.lower(): float(v) for k, v in re.findall(r"(\w):(\S+)", program)}
        found |= {f"steps_{k.lower()}": float(v) for k, v in re.findall(r"(\w+):(\S+)", motors)}
        return found

    def close(self) -> None:
        """Ends the printer; fails if it had died or complained."""
        died = self._process.poll()
        self._lines.close()
        self._socket.close()
        self._process.terminate()
        _, complaints = self._process.communicate(timeout=10)
        assert died is None, f"the printer died: {complaints}"
        assert "Traceback" not in complaints, complaints
