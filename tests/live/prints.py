"""What tests of boards on cables share: moves, the end of them, and Passo as a process."""

from __future__ import annotations

import ctypes
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from tests.hosts.served import free_port
from tests.live.cable import Cable
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.machine import MachineConfig

MACHINE = config.load("i3")
RUNS_FIRMWARE = MACHINE.model_copy(
    update={"board": MACHINE.board.model_copy(update={"firmware": "passo"})}
)
STALL_US = 500_000
ZIGZAG = [f"G1 X{10 if i % 2 else 0} Y{i / 4} E{i / 20} F3000" for i in range(16)]
ZIGZAG_STEPS = {"x": 800, "y": 300, "z": 0, "e": round(0.75 * 95.5)}


def stall() -> None:
    """Nothing in Python runs for half a second: whoever sleeps here holds the interpreter lock."""
    ctypes.PyDLL(None).usleep(STALL_US)


def on(link: str, port: str, runs: str = "passo") -> MachineConfig:
    """The machine with its board at such a place, which runs Passo's firmware or Klipper's."""
    board = MACHINE.board.model_copy(update={"link": link, "port": port, "firmware": runs})
    return MACHINE.model_copy(update={"board": board})


def machine_file(folder: Path, port: str) -> Path:
    """The same on a serial device, as a file."""
    text = Path(config.__file__).with_name("machines").joinpath("i3.toml").read_text()
    link = f'base = "ramps"\nlink = "serial"\nport = "{port}"'
    file = folder / "mine.toml"
    file.write_text(text.replace('base = "ramps"', link))
    return file


def zigzag(host: Host) -> None:
    """Moves that end after `ZIGZAG_STEPS`."""
    host.ok("G92 X0 Y0 Z0")
    host.ok("M302 P1")
    host.send(*ZIGZAG)


def ends(scenario: Scenario, within: float = 10.0) -> None:
    """All moves are made, and nothing has gone wrong."""
    scenario.host.send("M400", "M118 done")
    scenario.host.expect("done", within)
    assert scenario.printer.state.halted == ""


def wait_for(cable: Cable, at: Callable[[], bool], within: float = 60.0) -> None:
    """Until a function of the board is true; fails after so many seconds."""
    end = time.monotonic() + within
    while not cable.look(at):
        assert time.monotonic() < end
        time.sleep(0.01)


def net_steps(cables: Iterable[Cable]) -> dict[str, int]:
    """The net steps of all motors, with the boards unplugged; none has shut down."""
    found: dict[str, int] = {}
    for cable in cables:
        cable.cut()
        assert cable.board.device.fault == ""
        found |= {s.name: cable.board.net_steps(s.name) for s in cable.board.board.steppers}
    return found


class Program:
    """`passo serve` as a process, and a console of it."""

    def __init__(self, machine: Path, *more: str) -> None:
        place = f"127.0.0.1:{free_port()}"
        words = [sys.executable, "-m", "passo", "serve", "--machine", str(machine), "--tcp", place]
        words += ["--http", "none"]
        self.process = subprocess.Popen([*words, *more], stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        assert self.process.stderr.readline().startswith("Serving")
        host, _, port = place.partition(":")
        self._socket = socket.create_connection((host, int(port)), timeout=30.0)
        self._lines = self._socket.makefile("r", encoding="ascii", newline="\n")
        self.heard: list[str] = []

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        self._lines.close()
        self._socket.close()
        self.process.kill()
        self.process.communicate()

    def send(self, *lines: str) -> None:
        self._socket.sendall("".join(f"{line}\n" for line in lines).encode())

    def until(self, part: str) -> None:
        """Reads on to a line with this in it."""
        while not self.heard or part not in self.heard[-1]:
            self.heard.append(self._lines.readline())
            assert self.heard[-1], self.heard
