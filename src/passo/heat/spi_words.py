"""What thermocouple converters with an SPI say: the words of MAX6675 and MAX31855."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

WordFault: TypeAlias = Literal["open", "short to ground", "short to supply", "no answer"]


@dataclass(frozen=True, slots=True)
class Word:
    """A converter's answer. `celsius` and `internal_c` (its own temperature, if it tells it) are
    None where `fault` says that they mean nothing."""

    celsius: float | None = None
    internal_c: float | None = None
    fault: WordFault | None = None


def max6675(word: int) -> Word:
    """16 bits, as in its datasheet (Maxim 19-2235): D15 0, D14-D3 unsigned quarters of a °C, D2 set
    if the thermocouple is open, D1 0, D0 high impedance. Set where it must be 0: nobody answers."""
    if word & 0x8002:
        return Word(fault="no answer")
    if word & 0x0004:
        return Word(fault="open")
    return Word(celsius=(word >> 3 & 0xFFF) / 4)


def max31855(word: int) -> Word:
    """32 bits, as in its datasheet (Maxim 19-5793): D31-D18 signed quarters of a °C, D17 0, D16 set
    with any fault, D15-D4 its own temperature as signed sixteenths of a °C, D3 0, D2 short to the
    supply, D1 short to ground, D0 open. Set where it must be 0: nobody answers."""
    if word & 0x0002_0008:
        return Word(fault="no answer")
    internal_c = _signed(word >> 4, 12) / 16
    if word & 0x0001_0007:
        if word & 1:
            return Word(internal_c=internal_c, fault="open")
        ground = word & 2
        return Word(internal_c=internal_c, fault="short to ground" if ground else "short to supply")
    return Word(_signed(word >> 18, 14) / 4, internal_c)


def _signed(bits: int, width: int) -> int:
    """Two's complement in the lowest `width` bits."""
    value = bits & (1 << width) - 1
    return value - (1 << width) if value >> width - 1 else value
