"""`passo hub` in a process, as its page and its users see it."""

from __future__ import annotations

import json
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.hosts.served import free_port
from tests.support.served_printer import ServedPrinter

WAIT_S = 60.0
_PROGRAM = """
import sys
from passo.hub import contact, printer_task
from passo.hub.links import http
silent_s, lost_s = map(float, sys.argv[1:3])
http.SILENT_S, contact.LOST_S, printer_task.LOST_S = silent_s, lost_s, lost_s
from passo.cli.main import main
sys.exit(main(sys.argv[3:]))
"""


class ServedHub:
    """A farm whose hub can be killed and started again. `silent_s` and `lost_s` replace its limits
    until a printer counts as unreachable."""

    def __init__(self, folder: Path, silent_s: float = 30.0, lost_s: float = 30.0) -> None:
        self._port = free_port()
        self._folder, self._limits = folder, [str(silent_s), str(lost_s)]
        self.begin()

    def begin(self) -> None:
        """Starts the process; returns when it answers."""
        words = ["hub", "--http", f"127.0.0.1:{self._port}", "--state", str(self._folder)]
        command = [sys.executable, "-c", _PROGRAM, *self._limits, *words]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        said: list[str] = []
        for line in self.process.stderr:
            said.append(line)
            if line.startswith("Serving"):
                return
        raise AssertionError("".join(said))

    def kill(self) -> None:
        """Ends the process at once (kill -9)."""
        self.process.kill()
        self.process.wait(timeout=20)
        assert self.process.stderr is not None
        self.process.stderr.close()

    def ask(self, method: str, path: str, body: object = None) -> Any:
        """The answer to a request; bytes are sent as they are."""
        headers = {"Content-Type": "application/json", "X-Passo-Request": "1"}
        data = None
        if isinstance(body, bytes):
            data, headers["Content-Type"] = body, "application/octet-stream"
        elif body is not None:
            data = json.dumps(body).encode()
        url = f"http://127.0.0.1:{self._port}/api/v1{path}"
        request = urllib.request.Request(url, data, headers, method=method)
        with urllib.request.urlopen(request, timeout=WAIT_S) as answer:
            content = answer.read()
        return json.loads(content) if content else None

    def printers(self) -> dict[str, Any]:
        """The printers of the farm, by name."""
        return {printer["name"]: printer for printer in self.ask("GET", "/printers")}

    def add(self, printers: list[ServedPrinter]) -> None:
        """Adds printers, named by their number, and waits until the hub follows them."""
        for number, printer in enumerate(printers):
            body = {"url": printer.url, "name": f"p{number}"}
            self.ask("POST", "/printers", body)
        self.wait(lambda: all(p["condition"] != "connecting" for p in self.printers().values()))

    def job(self, name: str, content: bytes, **fields: Any) -> str:
        """Uploads a file and adds a job for it; returns its id."""
        file = self.ask("POST", f"/files?name={name}", content)
        return str(self.ask("POST", "/jobs", {"file": file["sha256"], **fields})["id"])

    def clear_beds(self) -> None:
        """A user clears each printer that has ended its print, except those that need attention."""
        for printer in self.printers().values():
            if printer["condition"] != "idle" or printer["run"] or printer["attention"]:
                continue
            if not printer["bed_clear"]:
                self.ask("POST", f"/printers/{printer['id']}/clear", {"bed_clear": True})

    def wait(self, condition: Callable[[], object], within_s: float = WAIT_S) -> None:
        """Until the condition holds."""
        end = time.monotonic() + within_s
        while not condition():
            assert time.monotonic() < end, self.ask("GET", "/farm")
            time.sleep(0.2)
