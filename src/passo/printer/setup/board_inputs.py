"""Makes the descriptions of a board's inputs from a machine file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.board.description import AnalogInput, Input
from passo.config.inputs import analog_input, button_input
from passo.config.pin_names import placed

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def inputs_of(machine: MachineConfig, board: str) -> Iterator[Input]:
    """The inputs of a board whose levels it reports when they change."""
    for name, pin in machine.input_pins.items():
        if placed(pin)[0] == board and pin not in machine.analog_buttons:
            yield Input(name, machine.pin(pin))


def analog_inputs_of(machine: MachineConfig, board: str) -> Iterator[AnalogInput]:
    """The analog inputs of a board that are not temperature sensors."""
    for pin, buttons in machine.analog_buttons.items():
        if placed(pin)[0] == board:
            ranges = ((button_input(name), *machine.buttons[name].shares) for name in buttons)
            yield AnalogInput(analog_input(pin), machine.pin(pin), tuple(ranges))
