"""`passo serve --simulated` in a process, at one HTTP address, as a hub sees it."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

from tests.hosts.served import free_port

END_S = 20.0


class ServedPrinter:
    """A printer with a card and a state folder; it can be killed, stopped for a while, and started
    again at its address."""

    def __init__(self, folder: Path, *, clock: str = "fast", card: Path | None = None) -> None:
        self.card = card or folder / "card"
        if card is None:
            self.card.mkdir(parents=True)
        self._port, self._folder, self._clock = free_port(), folder, clock
        self.url = f"http://127.0.0.1:{self._port}"
        self.begin()

    def begin(self) -> None:
        """Starts the process; `serving` waits for it."""
        words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--simulated"]
        words += ["--http", f"127.0.0.1:{self._port}", "--tcp", "127.0.0.1:0"]
        words += ["--clock", self._clock, "--sd", str(self.card)]
        words += ["--state", str(self._folder / "state")]
        self.process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)

    def serving(self) -> ServedPrinter:
        """Returns when the printer answers."""
        said: list[str] = []
        assert self.process.stderr is not None
        for line in self.process.stderr:
            said.append(line)
            if line.startswith("Serving"):
                return self
        raise AssertionError("".join(said))

    def signal(self, number: signal.Signals) -> None:
        """Sends a signal to the process."""
        self.process.send_signal(number)

    def restart(self) -> None:
        """Kills the process, and starts it again."""
        self.kill()
        self.begin()
        self.serving()

    def kill(self) -> None:
        """Ends the process at once."""
        self.process.kill()
        self.process.wait(timeout=END_S)
        assert self.process.stderr is not None
        self.process.stderr.close()
