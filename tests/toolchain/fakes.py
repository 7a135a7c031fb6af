"""A board's end of a serial port, and flashing programs that only note how they were called."""

from __future__ import annotations

import asyncio
import os
import struct
import sys
import threading
import tty
from pathlib import Path

from passo import _core
from passo.toolchain.tables import compress

DICTIONARY = {
    "version": "0.1.0-test",
    "commands": {"identify offset=%u count=%c": 1, "get_uptime": 2},
    "responses": {"identify_response offset=%u data=%.*s": 0},
    "enumerations": {},
    "config": {"CLOCK_FREQ": 16_000_000},
}


def packed(**changes: object) -> bytes:
    return compress(DICTIONARY | changes)


class Board:
    """Answers `identify`, as a sans-IO engine: bytes in, bytes out. `sequence` is the number of the
    frame that it expects first; the first `deaf` frames are lost."""

    def __init__(self, dictionary: bytes, sequence: int = 0, deaf: int = 0) -> None:
        self.dictionary, self.sequence, self.deaf = dictionary, sequence, deaf
        self.questions = 0
        self._scanner = _core.FrameScanner()
        self._commands = _core.Formats([(1, "identify offset=%u count=%c")])
        self._reports = _core.Formats([(0, "identify_response offset=%u data=%.*s")])

    def answer(self, data: bytes) -> bytes:
        out = b""
        for frame in self._scanner.feed(data):
            if self.deaf:
                self.deaf -= 1
                continue
            if frame is None or frame[0] != self.sequence:
                out += _core.make_frame(b"", self.sequence)
                continue
            self.sequence = (self.sequence + 1) % 16
            out += _core.make_frame(b"", self.sequence)
            for _, values in self._commands.decode(frame[1]):
                self.questions += 1
                at, count = int(values["offset"]), int(values["count"])
                part = self.dictionary[at : at + count]
                payload = self._reports.encode("identify_response", [at, part])
                out += _core.make_frame(payload, self.sequence)
        return out


class Port:
    """A pty whose other end is a board, served by the running loop or by a thread."""

    def __init__(self, board: Board | None) -> None:
        self.board = board
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)

    def serve(self, loop: asyncio.AbstractEventLoop) -> None:
        loop.add_reader(self.master, self._once)

    def serve_in_thread(self) -> None:
        def work() -> None:
            while self._once():
                pass

        threading.Thread(target=work, daemon=True).start()

    def _once(self) -> bool:
        try:
            data = os.read(self.master, 4096)
        except OSError:
            return False
        if self.board:
            os.write(self.master, self.board.answer(data))
        return bool(data)

    def close(self) -> None:
        os.close(self.slave)
        os.close(self.master)


class Unplugged(Port):
    """One whose cable is drawn at the first question."""

    def serve(self, loop: asyncio.AbstractEventLoop) -> None:
        def drawn() -> None:
            loop.remove_reader(self.master)
            os.close(self.master)

        loop.add_reader(self.master, drawn)

    def close(self) -> None:
        os.close(self.slave)


def program(folder: Path, name: str, status: int = 0, *, then: str = "") -> Path:
    """Puts a program of that name into a folder; returns the file where it notes its words. `then`
    is what it does besides."""
    folder.mkdir(exist_ok=True)
    notes = folder / f"{name}.called"
    script = folder / name
    script.write_text(
        f"#!{sys.executable}\nimport json, pathlib, sys\n"
        f"pathlib.Path({str(notes)!r}).write_text(json.dumps(sys.argv[1:]))\n"
        f"{then}\nsys.exit({status})\n"
    )
    script.chmod(0o755)
    return notes


# How images begin: with a jump; with the end of a stack in the RAM and a start in the flash of a
# SAM3X8E, and of an MK20DX256.
AVR_CODE = b"\x0c\x94" + bytes(14)
SAM_CODE = struct.pack("<2I", 0x2008_8000, 0x8_0009).ljust(16, b"\0")
TEENSY_CODE = struct.pack("<2I", 0x2000_8000, 9).ljust(16, b"\0")


def intel_hex(data: bytes = AVR_CODE) -> str:
    """A hex file of one record."""
    record = bytes([len(data), 0, 0, 0]) + data
    total = -sum(record) % 256
    return f":{(record + bytes([total])).hex().upper()}\n:00000001FF\n"
