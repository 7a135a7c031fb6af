"""The pins of SPI units, by their names in Klipper's firmware."""

from __future__ import annotations

import re

# The receive, send and clock pins of units whose names do not contain them.
_UNITS = {
    "spi1": ("PA6", "PA7", "PA5"),
    "spi1a": ("PB4", "PB5", "PB3"),
    "spi2": ("PB14", "PB15", "PB13"),
    "spi2a": ("PC2", "PC3", "PB10"),
    "spi3": ("PB4", "PB5", "PB3"),
    "spi3a": ("PC11", "PC12", "PC10"),
    "spi4": ("PE13", "PE14", "PE12"),
    "spi0a": ("gpio0", "gpio3", "gpio2"),
    "spi0b": ("gpio4", "gpio7", "gpio6"),
    "spi0c": ("gpio16", "gpio19", "gpio18"),
    "spi0d": ("gpio20", "gpio23", "gpio22"),
}
_WITH_PINS = re.compile(r"spi\d_([A-Za-z]+\d+)_([A-Za-z]+\d+)_([A-Za-z]+\d+)")


def wires_of_bus(name: str) -> tuple[str, str, str] | None:
    """The pins MISO, MOSI and SCK of a unit; None if they are not known."""
    found = _WITH_PINS.fullmatch(name)
    return (found[1], found[2], found[3]) if found else _UNITS.get(name)
