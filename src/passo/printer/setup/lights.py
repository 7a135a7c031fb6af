"""The descriptions of the lights that boards send frames to, from a machine file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.board.description import I2cPins, Light, SpiPins
from passo.config.lights import Dotstar, Led, Neopixel, start_color
from passo.config.pin_names import placed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from passo.config.machine import MachineConfig

_DOTSTAR_HZ = 500_000
_CHIP_HZ = 100_000


def lights_of(machine: MachineConfig, board: str) -> Iterator[Light]:
    """The lights of a board. A chain with a clock wire is an SPI device that nothing selects."""
    for name, light in machine.lights.items():
        if isinstance(light, Led):
            continue
        size = len(light.frame([start_color(light)] * light.count))
        if isinstance(light, Neopixel):
            pin, described = light.pin, Light(name, machine.pin(light.pin), size, light.count)
        elif isinstance(light, Dotstar):
            pin, data = light.data_pin, machine.pin(light.data_pin)
            wire = SpiPins("", machine.pin(light.clock_pin), data, data, 0, _DOTSTAR_HZ)
            described = Light(name, wire, size, light.count)
        else:
            pin = light.scl_pin
            lines = machine.pin(light.scl_pin), machine.pin(light.sda_pin)
            wire = I2cPins(*lines, light.address, _CHIP_HZ)
            described = Light(name, wire, size, setup=light.setup)
        if placed(pin)[0] == board:
            yield described
