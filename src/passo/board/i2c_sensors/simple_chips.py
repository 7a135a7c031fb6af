"""Chips that give a temperature, and perhaps the humidity, for a command: one row each."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from functools import partial
from typing import NamedTuple

from passo.board.i2c_sensors.exchanges import ChipError, Measured, Steps, Transfer

_POLYNOMIAL = 0x31  # x⁸ + x⁵ + x⁴ + 1


class Command(NamedTuple):
    """Bytes for the chip, the time that it needs then, and the number of bytes of its answer."""

    write: bytes
    seconds: float
    answers: int = 0


class SimpleChip(NamedTuple):
    """The commands after the start, the commands of a measurement, and how their answers, one
    after the other, give it."""

    setup: tuple[Command, ...]
    measure: tuple[Command, ...]
    decode: Callable[[bytes], Measured]


def read_simple(chip: SimpleChip) -> Steps:
    """Reads such a chip."""
    for command in chip.setup:
        yield from _carry_out(command)
    while True:
        data = b""
        for command in chip.measure:
            data += yield from _carry_out(command)
        yield chip.decode(data)


def _carry_out(command: Command) -> Generator[Transfer | float, bytes, bytes]:
    """Sends a command, and returns its answer."""
    if command.seconds == 0:
        return (yield Transfer(command.write, command.answers))
    if command.write:
        yield Transfer(command.write)
    yield command.seconds
    return (yield Transfer(b"", command.answers)) if command.answers else b""


def crc8(data: bytes, start: int) -> int:
    """The checksum of these chips, whose register begins with `start`."""
    crc = start
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (_POLYNOMIAL if crc & 0x80 else 0)) & 0xFF
    return crc


def _checked(data: bytes, crc: int, start: int) -> None:
    expected = crc8(data, start)
    if crc != expected:
        raise ChipError("garbled", f"the checksum 0x{crc:02x} in place of 0x{expected:02x}")


def _words(data: bytes, start: int) -> tuple[int, int]:
    """Two words of 16 bits, each with a checksum."""
    for i in (0, 3):
        _checked(data[i : i + 2], data[i + 2], start)
    return int.from_bytes(data[0:2], "big"), int.from_bytes(data[3:5], "big")


def _percent(value: float) -> float:
    return min(max(value, 0.0), 100.0)


def _lm75(data: bytes) -> Measured:
    return Measured(int.from_bytes(data, "big", signed=True) / 256)


def _htu21d(data: bytes, per_c: float) -> Measured:
    """The lower two bits of a word are its status. The humidity deviates by `per_c` % for each °C
    below 25 °C."""
    words = (word & ~3 for word in _words(data, 0))
    warm, damp = (word / 65536 for word in words)
    celsius = 175.72 * warm - 46.85
    return Measured(celsius, _percent(125 * damp - 6 + (25 - celsius) * per_c))


def _sht3x(data: bytes) -> Measured:
    warm, damp = (word / 65535 for word in _words(data, 0xFF))
    return Measured(175 * warm - 45, _percent(100 * damp))


def _aht(data: bytes, *, checked: bool) -> Measured:
    """A status, then 20 bits of humidity and 20 of temperature. Newer chips add a checksum."""
    if checked:
        _checked(data[:6], data[6], 0xFF)
    if data[0] & 0x80:
        raise ChipError("silent", "a measurement that does not end")
    bits = int.from_bytes(data[1:6], "big")
    damp, warm = bits >> 20, bits & 0xFFFFF
    return Measured(200 * warm / 2**20 - 50, _percent(100 * damp / 2**20))


def _htu(per_c: float = 0.0) -> SimpleChip:
    """Soft reset; then temperature and humidity, without holding the clock low. The longest
    conversion is that of an SHT21 with 14 bits."""
    return SimpleChip(
        (Command(b"\xfe", 0.02),),
        (Command(b"\xf3", 0.1, 3), Command(b"\xf5", 0.05, 3)),
        partial(_htu21d, per_c=per_c),
    )


def _aht_of(*setup: Command, checked: bool) -> SimpleChip:
    measure = Command(b"\xac\x33\x00", 0.11, 7 if checked else 6)
    return SimpleChip(setup, (measure,), partial(_aht, checked=checked))


# LM75: National Semiconductor, DS012658. HTU21D: Measurement Specialties, HPC199. SHT21: Sensirion,
# version 4. Si7021: Silicon Labs, rev. 1.2. SHT3x: Sensirion, version 7; a measurement of high
# repeatability without clock stretching. AHT10, AHT20, AHT30: Aosong.
CHIPS: Mapping[str, SimpleChip] = {
    "lm75": SimpleChip((), (Command(b"\x00", 0.0, 2),), _lm75),
    "htu21d": _htu(-0.15),
    "sht21": _htu(),
    "si7013": _htu(),
    "si7020": _htu(),
    "si7021": _htu(),
    "sht3x": SimpleChip((Command(b"\x30\xa2", 0.02),), (Command(b"\x24\x00", 0.02, 6),), _sht3x),
    "aht1x": _aht_of(Command(b"\xe1\x08\x00", 0.05), checked=False),
    "aht2x": _aht_of(Command(b"\xbe\x08\x00", 0.1), checked=True),
    "aht3x": _aht_of(checked=True),
}
