"""A simulated board at the other end of a serial line, in real time, for any host."""

from __future__ import annotations

import os
import select
import time
import tty
from contextlib import suppress
from pathlib import Path

from passo.simulator.board import SimulatedBoard

_SLICE_S = 0.001
_STALL_S = 0.01


class SerialBoard:
    """A board behind a pseudo-terminal. Its clock runs with the computer's but stands still while
    the computer does not let it run, as a chip's would that is stopped."""

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
        self._seen_s = time.monotonic()
        self._now_s = board.device.now / board.board.clock_hz
        self._unsent = b""

    def run(self, seconds: float) -> None:
        """Serves the line for so long."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            select.select([self._fd], [], [], min(left, _SLICE_S))
            self.pass_bytes()

    def pass_bytes(self) -> None:
        """Lets the board take what came and say what it has to say, now."""
        seen_s, self._seen_s = self._seen_s, time.monotonic()
        self._now_s += min(self._seen_s - seen_s, _STALL_S)
        now = int(self._now_s * self.board.board.clock_hz)
        with suppress(BlockingIOError):  # nothing came
            self.board.device.feed(os.read(self._fd, 4096), now)
        self._unsent += self.board.device.poll(now)
        with suppress(BlockingIOError):  # nobody reads: the line is full
            self._unsent = self._unsent[os.write(self._fd, self._unsent) :]

    def close(self) -> None:
        """Takes the line away."""
        os.close(self._fd)
        os.close(self._host_end)
        self._link.unlink(missing_ok=True)
