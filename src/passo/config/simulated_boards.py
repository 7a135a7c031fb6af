"""A machine with a simulated board in place of each of its boards."""

from __future__ import annotations

from math import isfinite

from passo.config.board import Board
from passo.config.machine import MachineConfig


def on_simulated_boards(machine: MachineConfig) -> MachineConfig:
    """The same machine with simulated boards, whatever their links are. A plan has the same limits
    as on the real boards: a simulated board gets the rate of the link in its budget, and the kind
    of firmware of the real one."""
    boards = {name: _simulated(board) for name, board in machine.boards.items()}
    return machine.model_copy(update={"board": _simulated(machine.board), "boards": boards})


def _simulated(board: Board) -> Board:
    if board.link == "simulated":
        return board
    budget, rate = board.budget, board.link_bytes_s
    if budget is not None and isfinite(rate):
        budget = budget.model_copy(update={"link_bytes_s": rate})
    runs = "passo" if board.survives else board.firmware
    return board.model_copy(
        update={"link": "simulated", "port": None, "firmware": runs, "budget": budget}
    )
