"""The chips that Klipper's firmware runs on: their clocks, and the commands that fit in their
memory."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple


class ChipOfKlipper(NamedTuple):
    """A chip by a part of its name, which is in comments and in the names of USB ports. `clock_hz`
    is the clock that the firmware reports; `moves` is the capacity of its move queue, 1024 at
    most."""

    name: str
    clock_hz: int
    moves: int


# The first name of the table that is in a text counts. An RP2040 counts its oscillator.
CHIPS = tuple(
    ChipOfKlipper(*row)
    for row in (
        ("rp2040", 12_000_000, 1024),
        ("rp2350", 12_000_000, 1024),
        ("stm32f042", 48_000_000, 128),
        ("stm32f0", 48_000_000, 256),
        ("stm32g0", 64_000_000, 1024),
        ("stm32f103", 72_000_000, 512),
        ("stm32f2", 120_000_000, 1024),
        ("stm32f401", 84_000_000, 1024),
        ("stm32f405", 168_000_000, 1024),
        ("stm32f407", 168_000_000, 1024),
        ("stm32f429", 168_000_000, 1024),
        ("stm32f446", 180_000_000, 1024),
        ("stm32f765", 216_000_000, 1024),
        ("stm32g4", 170_000_000, 1024),
        ("stm32h723", 400_000_000, 1024),
        ("stm32h743", 400_000_000, 1024),
        ("stm32h7", 400_000_000, 1024),
        ("lpc1768", 100_000_000, 1024),
        ("lpc1769", 120_000_000, 1024),
        ("lpc176", 100_000_000, 1024),
        ("samd21", 48_000_000, 1024),
        ("samd51", 120_000_000, 1024),
        ("same54", 120_000_000, 1024),
        ("sam3x", 84_000_000, 1024),
        ("arduino due", 84_000_000, 1024),
        ("sam4e", 120_000_000, 1024),
        ("same70", 300_000_000, 1024),
        ("beaglebone", 200_000_000, 256),
        ("klipper_host_mcu", 50_000_000, 1024),
        ("at90usb1286", 16_000_000, 256),
        ("atmega644", 20_000_000, 128),
        ("atmega", 16_000_000, 256),
        ("avr", 16_000_000, 256),
    )
)
_OF_PINS = {  # chips by the form of their pin names
    "rp2040": re.compile(r"gpio\d+"),
}
LINUX = "klipper_host_mcu"  # the port of Klipper's process on a Linux computer


def chips_of_pins(pins: Collection[str]) -> list[ChipOfKlipper]:
    """The chip that alone has pins of these names. LPC1768 and LPC1769, whose names are the same,
    have different clocks."""
    names = [name for name, form in _OF_PINS.items() if pins and all(map(form.fullmatch, pins))]
    return [chip for chip in CHIPS if chip.name in names]


def chips_in(text: str) -> list[ChipOfKlipper]:
    """The chips that a text names, in the order of `CHIPS`; those with special names before those
    with general ones."""
    text = re.sub(r"\s+", " ", text.lower())
    return [chip for chip in CHIPS if chip.name in text]
