"""A simulated board at one end of a pty, in real time."""

from __future__ import annotations

import os
import tty
from collections.abc import Callable
from typing import TypeVar

from passo import _core
from passo.config.machine import MachineConfig
from passo.printer.wiring import board_description, simulated_board
from passo.simulator import SimulatedBoard

T = TypeVar("T")


class Cable:
    """A board of a machine, the main one unless named; hosts open the serial device `path`."""

    def __init__(self, machine: MachineConfig, name: str = "") -> None:
        self.board: SimulatedBoard = simulated_board(
            machine, board_description(machine, name), name
        )
        master, self._slave = os.openpty()  # the host's end stays open: hosts come and go
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        self._live = _core.LiveBoard(self.board.device, master, float(self.board.board.clock_hz))

    def look(self, at: Callable[[], T]) -> T:
        """What a function of the board returns, while the board stands still."""
        return self._live.look(at)

    def cut(self) -> None:
        """The board is unplugged; it may be looked at now."""
        self._live.stop()

    def close(self) -> None:
        """Takes the device away."""
        self._live.stop()
        os.close(self._slave)
