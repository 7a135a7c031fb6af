"""The notes of `passo check` about a valid machine file: skipped checks, assumptions, and the notes
of a board's file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.config.board_files import known_pins
from passo.config.findings import key_text
from passo.config.heater_numbers import number_of
from passo.config.pin_names import section

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_PINS = {"mcu", "dictionary", "pins"}
_ASSUMED = {"hotend": "a hotend of 40 W", "bed": "a bed of 200 W", "chamber": "a chamber of 300 W"}


def unchecked_boards(machine: MachineConfig) -> list[str]:
    """The tables of boards with unknown pins, because neither their chip nor their dictionary is
    known."""
    return [
        key_text(section(name))
        for name, board in machine.all_boards.items()
        if not known_pins(board.model_dump(include=_PINS, exclude_none=True))
    ]


def notes(machine: MachineConfig) -> Iterator[str]:
    """One or two sentences for each note."""
    for board in unchecked_boards(machine):
        yield (
            f"the pins on {board} are not checked: its firmware's dictionary is not known. Give"
            f' {board} the key dictionary = "klipper.dict", the file of the firmware\'s build'
        )
    for name, heater in machine.heaters.items():
        if not heater.known_model:
            number = number_of(machine, name)
            tune = "" if number is None else f". M303 H{number} R5 finds the model of this one"
            yield (
                f"heaters.{name} is taken to be {_ASSUMED[heater.kind]}, and its readings are not"
                f" compared with a model{tune}"
            )
    for board in machine.all_boards.values():
        yield from board.notes
