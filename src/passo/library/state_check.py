"""Finds the changes that a state folder makes to a machine, without a board: for `passo check
--state`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from passo.clock import new_loop
from passo.console.aprinter_options import OptionCommands
from passo.console.settings_commands import SettingsCommands
from passo.job.settings_store import Store
from passo.printer.printer import Printer

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def stored_overrides(machine: MachineConfig, state: Path) -> list[str]:
    """The messages with which a printer would start from this folder: each stored value that
    overrides the machine file, and each refused one. Changes nothing in the folder. Raises
    CommandError if the stored settings must not be used."""
    loop = new_loop(None)
    try:
        return loop.run_until_complete(_overrides(_simulated(machine), state))
    finally:
        loop.close()


async def _overrides(machine: MachineConfig, state: Path) -> list[str]:
    printer = Printer(machine)
    try:
        store = Store(state / "settings.json", machine.uuid)
        options = OptionCommands(printer.dispatch, printer.settings)
        commands = SettingsCommands(printer.control, printer.parts, store, options)
        return commands.name_stored()
    finally:
        printer.close()


def _simulated(machine: MachineConfig) -> MachineConfig:
    simulated = {"link": "simulated", "port": None, "firmware": "virtual"}
    boards = {n: board.model_copy(update=simulated) for n, board in machine.boards.items()}
    board = machine.board.model_copy(update=simulated)
    return machine.model_copy(update={"board": board, "boards": boards})
