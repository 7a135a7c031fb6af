"""A real OctoPrint without a browser: its own folder, its REST interface, its serial layer."""

from __future__ import annotations

import http.client
import json
import re
import subprocess
import time
import urllib.error
import urllib.request
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.hosts.served import free_port

START_S = 60.0
WAIT_S = 60.0
_KEY = "0123456789ABCDEF" * 2
# OctoPrint opens serial devices. This plugin of it opens URLs as pyserial does, and names the
# ports of the test, which change while it runs.
_PLUGIN = """
import pathlib

import serial
from octoprint.util.comm import BufferedReadlineWrapper

__plugin_name__ = "ports"
__plugin_version__ = "1"
__plugin_pythoncompat__ = ">=3"


def opened(comm, port, baudrate, timeout, *args, **kwargs):
    if "://" in str(port):
        return BufferedReadlineWrapper(
            serial.serial_for_url(port, baudrate=baudrate, timeout=timeout, write_timeout=0)
        )


def names(*args, **kwargs):
    return pathlib.Path({ports!r}).read_text().split()


__plugin_hooks__ = {{
    "octoprint.comm.transport.serial.factory": opened,
    "octoprint.comm.transport.serial.additional_port_names": names,
}}
"""
_UNUSED = """
    achievements action_command_notification announcements backup classicwebcam discovery
    errortracking file_check firmware_check gcodeviewer health_check pi_support pluginmanager
    softwareupdate tracking
"""


class Refused(Exception):
    """The server has answered, but not done what it was asked."""


class OctoPrint:
    """One server; `connect` and `disconnect` as often as needed."""

    def __init__(self, program: Path, folder: Path) -> None:
        self._folder = folder
        self._ports = folder / "ports"
        self._url = f"http://127.0.0.1:{free_port()}"
        self._furnish()
        self._log = (folder / "stdout.log").open("w")
        words = [str(program), "serve", "--iknowwhatimdoing", "--host", "127.0.0.1"]
        words += ["--port", self._url.rpartition(":")[2], "--basedir", str(folder)]
        self._process = subprocess.Popen(words, stdout=self._log, stderr=subprocess.STDOUT)
        try:
            self.wait(self._answers, START_S)
        except BaseException:
            self.close()
            raise

    def _furnish(self) -> None:
        for name in ("plugins", "users"):
            (self._folder / name).mkdir(exist_ok=True)
        self._ports.write_text("")
        (self._folder / "plugins" / "ports.py").write_text(_PLUGIN.format(ports=str(self._ports)))
        config = {
            "accessControl": {"salt": "salt", "autologinLocal": False},
            "gcodeAnalysis": {"runAt": "never"},
            "plugins": {"_disabled": _UNUSED.split()},
            "serial": {"autoconnect": False, "log": True},
            "server": {
                "firstRun": False,
                "secretKey": _KEY,
                "onlineCheck": {"enabled": False},
                "pluginBlacklist": {"enabled": False},
            },
        }
        (self._folder / "config.yaml").write_text(json.dumps(config))  # JSON is YAML
        user = {"active": True, "apikey": _KEY, "groups": ["admins", "users"], "permissions": []}
        user |= {"password": "-", "settings": {}}
        (self._folder / "users.yaml").write_text(json.dumps({"admin": user}))

    def close(self) -> None:
        """Ends the server."""
        self._process.terminate()
        try:
            self._process.wait(timeout=15)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._log.close()

    # -- its interface ----------------------------------------------------------------------------

    def get(self, path: str) -> Any:
        """What the server answers."""
        return self._request(path, None, "")

    def post(self, path: str, **values: object) -> Any:
        """Lets the server do something."""
        return self._request(path, json.dumps(values).encode(), "application/json")

    def upload(self, file: Path, to: str) -> Any:
        """Uploads to `local` or `sdcard`."""
        border = uuid.uuid4().hex
        head = (
            f'--{border}\r\nContent-Disposition: form-data; name="file"; filename="{file.name}"\r\n'
            "Content-Type: application/octet-stream\r\n\r\n"
        )
        body = head.encode() + file.read_bytes() + f"\r\n--{border}--\r\n".encode()
        return self._request(f"files/{to}", body, f"multipart/form-data; boundary={border}")

    def _request(self, path: str, body: bytes | None, kind: str) -> Any:
        request = urllib.request.Request(f"{self._url}/api/{path}", body)
        request.add_header("X-Api-Key", _KEY)
        if body is not None:
            request.add_header("Content-Type", kind)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                text = answer.read()
        except urllib.error.HTTPError as error:
            raise Refused(f"{path}: {error.code} {error.read()[:200]!r}") from None
        return json.loads(text) if text else None

    def _answers(self) -> bool:
        assert self._process.poll() is None, (self._folder / "stdout.log").read_text()[-2000:]
        try:
            self.get("version")
        except (OSError, http.client.HTTPException, Refused):
            return False
        return True

    def received(self, command: str) -> list[str]:
        """Sends a command from the terminal tab and waits for its `ok`. Returns the lines that the
        printer sent from then on, by the serial log, the `ok` last."""
        log = self._folder / "logs" / "serial.log"
        begin = log.stat().st_size
        self.post("printer/command", commands=[command])
        answer = re.compile(
            rf"Send: (?:N\d+ )?{re.escape(command)}(?:\*\d+)?\n(.*?Recv: ok)", re.DOTALL
        )
        found: list[re.Match[str]] = []

        def ended() -> bool:
            found[:] = answer.finditer(log.read_bytes()[begin:].decode())
            return bool(found)

        self.wait(ended)
        return re.findall(r"Recv: (.*)", found[0][1])

    # -- printing ---------------------------------------------------------------------------------

    @property
    def state(self) -> str:
        """As its users read it: Operational, Printing, Pausing, Paused, ..."""
        return self.get("connection")["current"]["state"]

    @property
    def sent(self) -> float:
        """Per cent of the file that have been sent."""
        return self.get("job")["progress"]["completion"] or 0.0

    def wait(self, condition: Callable[[], bool], within_s: float = WAIT_S) -> None:
        """Until the condition holds."""
        end = time.monotonic() + within_s
        while not condition():
            assert time.monotonic() < end, (self._folder / "stdout.log").read_text()[-2000:]
            time.sleep(0.02)

    def connect(self, port: str) -> None:
        """Connects to a pty or a URL."""
        self._ports.write_text(port)
        self.post("connection", command="connect", port=port, baudrate=250000)
        self.wait(lambda: self.state == "Operational")

    def disconnect(self) -> None:
        """Lets go of the printer, whatever it does."""
        self.post("connection", command="disconnect")
        self.wait(lambda: self.state.startswith(("Closed", "Offline")))

    def print(self, file: Path) -> None:
        """Uploads a file and starts it."""
        self.upload(file, "local")
        self.post(f"files/local/{file.name}", command="select", print=True)

    def finished(self) -> None:
        """Waits for the end of a print that has been started; all of it was sent."""
        self.wait(lambda: self.sent == 100 and self.state == "Operational")

    def job(self, **command: str) -> None:
        """Pauses, resumes, cancels."""
        self.post("job", **command)
