"""The words of thermocouple converters, with the examples of their datasheets."""

from __future__ import annotations

import pytest
from tests.heat.tables import celsius_at

from passo import _core
from passo.heat.sensors import Table, sensor_table

MAX31855, MAX6675 = _core.Converter.MAX31855, _core.Converter.MAX6675
FAULT = _core.ConverterFault


@pytest.mark.parametrize(
    ("bits", "celsius"),
    [
        ("01100100000000", 1600.0), ("00111110100000", 1000.0), ("00000110010011", 100.75),
        ("00000001100100", 25.0), ("00000000000000", 0.0), ("11111111111111", -0.25),
        ("11111111111100", -1.0), ("11110000011000", -250.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("internal", [0, 25 << 8, 0xFFF << 4])
def test_max31855_thermocouple(bits, celsius, internal):
    assert _core.read_converter(MAX31855, int(bits, 2) << 18 | internal) == (celsius, FAULT.NONE)


@pytest.mark.parametrize(
    ("word", "fault"),
    [
        (0x0001_1901, FAULT.OPEN),
        (0x0001_1902, FAULT.SHORT_CIRCUIT),
        (0x0001_1904, FAULT.SHORT_CIRCUIT),
    ],
)
def test_max31855_faults(word, fault):
    assert _core.read_converter(MAX31855, word)[1] == fault


def test_max6675():
    assert _core.read_converter(MAX6675, 0) == (0.0, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0x7FF8) == (1023.75, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0b0000_0011_0010_0000) == (25.0, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0b0000_0011_0010_0100)[1] == FAULT.OPEN


def test_a_bus_on_which_nobody_answers():
    assert _core.read_converter(MAX31855, 0xFFFF_FFFF)[1] == FAULT.NO_ANSWER
    assert _core.read_converter(MAX6675, 0xFFFF)[1] == FAULT.NO_ANSWER


@pytest.mark.parametrize("kind", ["max31855", "max6675"])
def test_a_share_of_full_scale_is_a_quarter_of_a_degree(kind):
    from passo.config.sensors import ThermocoupleConverter

    pins = {"clock_pin": "D52", "miso_pin": "D50", "mosi_pin": "D51"}
    table: Table = sensor_table(ThermocoupleConverter(kind=kind, **pins))
    for quarters in (0, 1, 100, 800, 4000):
        share = (quarters + 8192) / _core.CONVERTER_FULL
        assert celsius_at(table, share) == pytest.approx(quarters / 4, abs=1e-9)
