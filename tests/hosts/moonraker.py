"""A real Moonraker without a page: its own folders, its HTTP interface."""

from __future__ import annotations

import json
import subprocess
import time
import urllib.error
import urllib.request
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.hosts.served import free_port

WAIT_S = 30.0


class Refused(Exception):
    """The server has answered, but not done what it was asked."""


class Moonraker:
    """One server for a printer's socket and the folder of its files; `more` is configuration."""

    def __init__(
        self, program: Path, folder: Path, socket: str, card: Path, more: str = ""
    ) -> None:
        self._log = folder / "moonraker.log"
        self._output = self._log.open("w")
        port = free_port()
        self.url = f"http://127.0.0.1:{port}"
        for name in ("config", "logs"):
            (folder / name).mkdir()
        (folder / "gcodes").symlink_to(card)
        settings = folder / "config" / "moonraker.conf"
        settings.write_text(
            f"[server]\nhost: 127.0.0.1\nport: {port}\nklippy_uds_address: {socket}\n"
            "[machine]\nprovider: none\nvalidate_service: False\n"
            "[authorization]\ntrusted_clients:\n  127.0.0.1\n[octoprint_compat]\n" + more
        )
        self._process = subprocess.Popen(
            [str(program), "-d", str(folder), "-c", str(settings)],
            stdout=self._output,
            stderr=subprocess.STDOUT,
        )
        try:
            self.wait(lambda: self.state == "ready")
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Ends the server."""
        self._process.terminate()
        try:
            self._process.wait(timeout=15)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._output.close()

    @property
    def state(self) -> str:
        """Of the printer: ready, shutdown, ...; disconnected, too, as long as nothing answers."""
        try:
            return str(self.get("/server/info")["klippy_state"])
        except OSError:
            return "disconnected"

    def wait(self, condition: Callable[[], object], within_s: float = WAIT_S) -> None:
        """Until the condition holds."""
        end = time.monotonic() + within_s
        while not condition():
            assert self._process.poll() is None and time.monotonic() < end, self._log.read_text()[
                -3000:
            ]
            time.sleep(0.05)

    def get(self, path: str) -> Any:
        """What the server answers. Raises Refused."""
        return self._request(path, None, "")

    def post(self, request: str, /, **values: object) -> Any:
        """Lets the server do something. Raises Refused."""
        return self._request(request, json.dumps(values).encode(), "application/json")

    def script(self, text: str) -> Any:
        """Lets the printer carry out lines, and waits for them."""
        return self.post("/printer/gcode/script", script=text)

    def query(self, name: str) -> dict[str, Any]:
        """An object of the printer."""
        return self.get(f"/printer/objects/query?{name}")["status"][name]

    @property
    def print_state(self) -> str:
        """Of the file: printing, paused, complete, ..."""
        return str(self.query("print_stats")["state"])

    def upload(self, path: str, file: Path, **fields: str) -> Any:
        """Sends a file, with the fields before it."""
        border = uuid.uuid4().hex
        parts = [f'name="{key}"\r\n\r\n{value}' for key, value in fields.items()]
        parts.append(f'name="file"; filename="{file.name}"\r\n\r\n{file.read_text()}')
        head = f"--{border}\r\nContent-Disposition: form-data; "
        body = "\r\n".join(head + part for part in parts) + f"\r\n--{border}--\r\n"
        return self._request(path, body.encode(), f"multipart/form-data; boundary={border}")

    def _request(self, path: str, body: bytes | None, kind: str) -> Any:
        request = urllib.request.Request(f"{self.url}{path}", body)
        if body is not None:
            request.add_header("Content-Type", kind)
        try:
            with urllib.request.urlopen(request, timeout=WAIT_S) as answer:
                found = json.loads(answer.read())
        except urllib.error.HTTPError as error:
            raise Refused(f"{path}: {error.code} {error.read()[:300]!r}") from None
        return found.get("result", found)
