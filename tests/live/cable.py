"""A simulated board at one end of a pty, in real time."""

from __future__ import annotations

import os
import socket
import tempfile
import threading
import tty
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from passo import _core
from passo.config.machine import MachineConfig
from passo.printer.setup.boards import board_description
from passo.printer.setup.simulated_world import simulated_board
from passo.simulator import SimulatedBoard

T = TypeVar("T")


class Cable:
    """A board of a machine, the main one unless named; hosts open the serial device `path`."""

    def __init__(self, machine: MachineConfig, name: str = "") -> None:
        self.board: SimulatedBoard = simulated_board(
            machine, board_description(machine, name), name
        )
        own = machine.all_boards[name].firmware
        self.runs = "passo" if own == "passo" else "klipper"  # for the machine of who connects
        self._hz = float(self.board.board.clock_hz)
        self._begin()

    def _begin(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._link = Path(self._folder.name) / "board"
        self.path = str(self._link)
        self._slave = -1
        self._live = _core.LiveBoard(self.board.device, self._open(), self._hz)

    def _open(self) -> int:
        """Makes the device; returns the board's end of it."""
        master, self._slave = os.openpty()  # the host's end stays open: hosts come and go
        tty.setraw(self._slave)
        self._link.symlink_to(os.ttyname(self._slave))
        return master

    def look(self, at: Callable[[], T]) -> T:
        """What a function of the board returns, while the board stands still."""
        return self._live.look(at)

    def unplug(self) -> None:
        """The device is gone, and the board lives on."""
        self._live.stop()
        self._link.unlink()
        os.close(self._slave)
        nowhere, self._nobody = socket.socketpair()
        self._move_to(nowhere.detach())

    def plug(self) -> None:
        """The device is back."""
        self._live.stop()
        self._nobody.close()
        self._move_to(self._open())

    def _move_to(self, fd: int) -> None:
        device = self.board.device
        self._live = _core.LiveBoard(device, fd, self._hz, device.now)

    def cut(self) -> None:
        """The board is unplugged and stands still; it may be looked at now."""
        self._live.stop()

    def close(self) -> None:
        """Takes the device away."""
        self._live.stop()
        os.close(self._slave)
        self._folder.cleanup()


class TcpCable(Cable):
    """The same at the network address `path`, for one host."""

    def _begin(self) -> None:
        self._server = socket.create_server(("127.0.0.1", 0))
        self.path = f"127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        caller, _ = self._server.accept()
        self._live = _core.LiveBoard(self.board.device, caller.detach(), self._hz)

    def close(self) -> None:
        """Hangs up."""
        self._live.stop()
        self._server.close()
