"""A simulated board at the other end of a serial line, in real time: for hosts that are not Passo."""

from __future__ import annotations

import os
import select
import time
import tty
from pathlib import Path

from passo.simulator.board import SimulatedBoard

_SLICE_S = 0.001


class SerialBoard:
    """A board behind a pseudo-terminal. Its clock runs with the computer's; it is late by what the
    computer is late, a millisecond as a rule, and the reports and edges carry the true clocks."""

    def __init__(self, board: SimulatedBoard, link: Path) -> None:
        """Makes `link` a symbolic link to the terminal that a host opens. Raises OSError."""
        self.board = board
        self._fd, host_end = os.openpty()
        tty.setraw(self._fd)
        tty.setraw(host_end)
        os.set_blocking(self._fd, False)
        self._host_end = host_end  # kept open: hosts come and go
        self._link = link
        link.unlink(missing_ok=True)
        link.symlink_to(os.ttyname(host_end))
        self._begin_s = time.monotonic()
        self._start_clock = board.device.now
        self._unsent = b""

    def run(self, seconds: float) -> None:
        """Serves the line for so long."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            select.select([self._fd], [], [], min(left, _SLICE_S))
            self.pass_bytes()

    def pass_bytes(self) -> None:
        """Lets the board take what came and say what it has to say, now."""
        hz = self.board.board.clock_hz
        now = self._start_clock + int((time.monotonic() - self._begin_s) * hz)
        try:
            self.board.device.feed(os.read(self._fd, 4096), now)
        except BlockingIOError:
            pass
        self._unsent += self.board.device.poll(now)
        try:
            self._unsent = self._unsent[os.write(self._fd, self._unsent) :]
        except BlockingIOError:
            pass  # nobody reads: the line is full

    def close(self) -> None:
        """Takes the line away."""
        os.close(self._fd)
        os.close(self._host_end)
        self._link.unlink(missing_ok=True)
