"""The description of a printer: typed machine files in TOML, checked as a whole.

`load` takes the name of a shipped machine or a path and returns a `MachineConfig`.
"""

from passo.config.board_files import load_board, shipped_boards
from passo.config.load import (
    load,
    load_and_question,
    load_text,
    load_text_and_question,
    machine_file_text,
    machine_path,
    shipped_machines,
    shipped_text,
)
from passo.config.machine import MachineConfig
from passo.config.simulated_boards import on_simulated_boards

__all__ = [
    "MachineConfig",
    "load",
    "load_and_question",
    "load_board",
    "load_text",
    "load_text_and_question",
    "machine_file_text",
    "machine_path",
    "on_simulated_boards",
    "shipped_boards",
    "shipped_machines",
    "shipped_text",
]
