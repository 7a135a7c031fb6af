"""The words of thermocouple converters, with the examples of their datasheets."""

from __future__ import annotations

import pytest

from passo.heat.spi_words import Word, max6675, max31855


@pytest.mark.parametrize(
    ("bits", "celsius"),
    [
        ("01100100000000", 1600.0), ("00111110100000", 1000.0), ("00000110010011", 100.75),
        ("00000001100100", 25.0), ("00000000000000", 0.0), ("11111111111111", -0.25),
        ("11111111111100", -1.0), ("11110000011000", -250.0),
    ],
)  # fmt: skip
def test_max31855_thermocouple(bits, celsius):
    assert max31855(int(bits, 2) << 18) == Word(celsius, 0.0)


@pytest.mark.parametrize(
    ("bits", "celsius"),
    [
        ("011111110000", 127.0), ("011001001001", 100.5625), ("000110010000", 25.0),
        ("000000000000", 0.0), ("111111111111", -0.0625), ("111111110000", -1.0),
        ("111011000000", -20.0), ("110010010000", -55.0),
    ],
)  # fmt: skip
def test_max31855_internal(bits, celsius):
    assert max31855(int(bits, 2) << 4) == Word(0.0, celsius)


@pytest.mark.parametrize(
    ("word", "fault"),
    [(0x0001_1901, "open"), (0x0001_1902, "short to ground"), (0x0001_1904, "short to supply")],
)
def test_max31855_faults(word, fault):
    assert max31855(word) == Word(None, 25.0, fault)


def test_max6675():
    assert max6675(0) == Word(0.0)
    assert max6675(0x7FF8) == Word(1023.75)
    assert max6675(0b0000_0011_0010_0000) == Word(25.0)
    assert max6675(0b0000_0011_0010_0100) == Word(fault="open")


def test_a_bus_on_which_nobody_answers():
    assert max31855(0xFFFF_FFFF) == Word(fault="no answer")
    assert max6675(0xFFFF) == Word(fault="no answer")
