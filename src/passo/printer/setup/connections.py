"""Connects to the boards that a machine file names: real or simulated ones."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import TYPE_CHECKING

from passo.board.boards import Boards
from passo.board.connection import Connection
from passo.board.description import BoardDescription
from passo.board.firmware_identity import reported_clock_hz
from passo.board.ports import Port, in_process, serial_port, tcp_port
from passo.config.pin_names import MAIN
from passo.printer.setup.boards import board_descriptions
from passo.printer.setup.simulated_world import simulated_machine

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.machine import MachineConfig
    from passo.simulator import Cable, SimulatedMachine

_log = logging.getLogger(__name__)


def connect_simulated(
    machine: MachineConfig, cable: Cable | None = None
) -> tuple[Boards, SimulatedMachine]:
    """Connections to simulated boards for the machine, identified and configured, and the boards
    themselves, for tests. Only boards with a `cable`, even a perfect one, can have faults of the
    link. Raises MachineError."""
    from passo.simulator import without_buses

    boards = {name: without_buses(b) for name, b in board_descriptions(machine).items()}
    simulated = simulated_machine(machine, boards, cable)
    ports = in_process([simulated.devices[name] for name in boards])
    connected = _connected(boards, ports)
    if cable is not None:
        from passo.simulator import SimulatedFaults

        connected.injector = SimulatedFaults(simulated)
    return connected, simulated


def connect(machine: MachineConfig) -> tuple[Boards, SimulatedMachine | None]:
    """Connections to the boards that the machine file names, identified and configured, and the
    boards themselves if they are simulated. A board that has survived the loss of another host is
    adopted. Raises MachineError."""
    if machine.board.link == "simulated":
        from passo.simulator import Cable

        return connect_simulated(machine, Cable())
    ports = [_port(board) for board in machine.all_boards.values()]
    return _connected(board_descriptions(machine), ports, adopt=True), None


def with_reported_clocks(machine: MachineConfig) -> MachineConfig:
    """The machine with the clock of each real board whose file does not give it, as its firmware
    reports. Raises MachineError."""
    if machine.board.link == "simulated":
        return machine
    boards = {
        name: board
        if board.knows_clock
        else board.with_clock(reported_clock_hz(_port(board), name))
        for name, board in machine.all_boards.items()
    }
    main = boards.pop(MAIN)
    return machine.model_copy(update={"board": main, "boards": boards})


def _port(board: Board) -> Port:
    place = board.port or ""
    if board.link == "serial":
        paced = board.console is not None and board.console.connector == "serial"
        return serial_port(place, board.baud, paced=paced)
    host, _, number = place.rpartition(":")
    return tcp_port(host.strip("[]"), int(number))


def reconnected(old: Boards) -> Boards:
    """New connections to the boards of `old`, which are reset. Raises MachineError."""
    ports = [connection.port for connection in old.connections]
    connected = _connected({c.name: c.board for c in old.connections}, ports)
    connected.injector = old.injector
    return connected


def _connected(
    boards: dict[str, BoardDescription], ports: Sequence[Port], *, adopt: bool = False
) -> Boards:
    named = zip(boards.items(), ports, strict=True)
    connected = Boards([Connection(board, port, name) for (name, board), port in named])
    connected.connect(adopt=adopt)
    for connection in connected.connections:
        _log.info(
            "Board %s connected: firmware %s, %g MHz, %d move commands%s",
            *(connection.name or "main", connection.dictionary.version or "unknown"),
            *(connection.board.clock_hz / 1e6, connection.move_count),
            ", as another host left it" if connection.adopted else "",
        )
    return connected
