"""Makes the descriptions of a board's inputs from a machine file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from passo.board.description import AnalogInput, Input
from passo.config.filament_width import FULL_SCALE
from passo.config.inputs import analog_input, button_input, width_inputs
from passo.config.pin_names import placed

if TYPE_CHECKING:
    from passo.config.inputs import FilamentSensor
    from passo.config.machine import MachineConfig

_WIDTH_PERIOD_S = 0.1


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
    for sensor, config in machine.filament_sensors.items():
        pins = width_inputs(sensor, config)
        for name, pin in pins.items():
            if placed(pin)[0] == board:
                yield AnalogInput(
                    name, machine.pin(pin), period_s=_WIDTH_PERIOD_S, rest=width_share(config)
                )


def width_share(sensor: FilamentSensor, diameter_mm: float | None = None) -> float:
    """The reading of each analog input of a width sensor at a diameter, by default the nominal one,
    as a fraction of full scale."""
    width = sensor.width
    assert width is not None
    reading = width.reading(width.nominal_mm if diameter_mm is None else diameter_mm)
    return reading / FULL_SCALE / (1 if width.second_pin is None else 2)
