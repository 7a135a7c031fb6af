"""The buses of chips: the pins of SPI units, by their names in Klipper's firmware, and I2C."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.config.pin_names import MAIN, bare, named_on, placed

if TYPE_CHECKING:
    from passo.config.importing.draft import Place
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

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
    "spi": ("PB3", "PB2", "PB1"),
}
# The units that Klipper takes without `spi_bus`, by pins that only these chips have: the ATmega2560
# and 1280, an STM32.
_FIRST_UNITS = {
    "spi": re.compile(r"P[JKL][0-7]"),
    "spi2": re.compile(r"P[A-E](8|9|1[0-5])"),
}
_NAMES = re.compile(r"\bP[A-L]\d+\b")
_WITH_PINS = re.compile(r"spi\d_([A-Za-z]+\d+)_([A-Za-z]+\d+)_([A-Za-z]+\d+)")


_SPI = {
    "spi_software_miso_pin": "miso_pin",
    "spi_software_mosi_pin": "mosi_pin",
    "spi_software_sclk_pin": "clock_pin",
}


_I2C = {"i2c_software_scl_pin": "scl_pin", "i2c_software_sda_pin": "sda_pin"}


def i2c_bus_of(job: Import, section: Section) -> dict[str, tuple[str, Place]]:
    """The pins of a chip's I2C bus by key, or its `i2c_bus`, with their places. Raises ConfigError
    if the section has neither."""
    pins = {option: job.pins.of(section, option) for option in _I2C}
    mcu, bus = section.text("i2c_mcu"), section.text("i2c_bus")
    given = {_I2C[o]: (pin, section.at(o)) for o, pin in pins.items() if pin is not None}
    if len(given) == len(_I2C):
        return given
    if not bus:
        raise section.missing("i2c_bus", "a bus, or i2c_software_scl_pin and i2c_software_sda_pin")
    board = job.pins.further.get(mcu, MAIN)
    return {"i2c_bus": (named_on(board, bus), section.at("i2c_bus"))}


def wires_of(job: Import, section: Section, select: str) -> dict[str, str]:
    """The pins of a chip's bus by key: those in the section, or those of a unit of the board on
    which the option `select` is. Passo drives them in software. Empty if they are not known."""
    section.used |= {"spi_speed", "spi_bus"}
    pins = {key: job.pins.of(section, option) for option, key in _SPI.items()}
    given = {key: pin for key, pin in pins.items() if pin is not None}
    bus = section.text("spi_bus") or _first_unit(job, section, select)
    found = _WITH_PINS.fullmatch(bus)
    wires = (found[1], found[2], found[3]) if found else _UNITS.get(bus)
    if len(given) == len(pins) or wires is None:
        return given if len(given) == len(pins) else {}
    board = placed(job.pins.of(section, select) or "")[0]
    named = {key: named_on(board, pin) for key, pin in zip(_SPI.values(), wires, strict=True)}
    text = f"its pins are {', '.join(named.values())}, which Passo drives in software"
    job.draft.changed(section.at("spi_bus"), f"[{section.name}] spi_bus {bus}", text)
    return named


def _first_unit(job: Import, section: Section, select: str) -> str:
    """The unit that the firmware takes for a chip without `spi_bus`; empty if it is not known."""
    board = placed(section.text(select))[0]
    pins = [
        bare(pin)
        for other in job.config.sections.values()
        for option in other.options
        if option.endswith("_pin")
        for name, pin in [placed(other.text(option))]
        if name == board
    ]
    if board == MAIN:
        pins += [p for s in job.config.of("board_pins") for p in _NAMES.findall(s.text("aliases"))]
    return next((u for u, form in _FIRST_UNITS.items() if any(map(form.fullmatch, pins))), "")
