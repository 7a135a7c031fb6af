"""The words of converters, with the examples of their datasheets."""

from __future__ import annotations

import pytest
from tests.heat.tables import celsius_at

from passo import _core
from passo.config.sensor_tables import Table, converter_setup, sensor_table
from passo.config.sensors import PlatinumConverter, UniversalConverter

MAX31855, MAX6675 = _core.Converter.MAX31855, _core.Converter.MAX6675
MAX31856, MAX31865 = _core.Converter.MAX31856, _core.Converter.MAX31865
PINS = {"clock_pin": "D52", "miso_pin": "D50", "mosi_pin": "D51"}
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


def test_max6675_readings_and_faults():
    assert _core.read_converter(MAX6675, 0) == (0.0, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0x7FF8) == (1023.75, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0b0000_0011_0010_0000) == (25.0, FAULT.NONE)
    assert _core.read_converter(MAX6675, 0b0000_0011_0010_0100)[1] == FAULT.OPEN


def test_a_bus_on_which_no_device_answers():
    assert _core.read_converter(MAX31855, 0xFFFF_FFFF)[1] == FAULT.NO_ANSWER
    assert _core.read_converter(MAX6675, 0xFFFF)[1] == FAULT.NO_ANSWER


@pytest.mark.parametrize("kind", ["max31855", "max6675"])
def test_max31855_steps_are_a_quarter_degree(kind):
    from passo.config.sensors import ThermocoupleConverter

    table: Table = sensor_table(ThermocoupleConverter(kind=kind, **PINS))
    for quarters in (0, 1, 100, 800, 4000):
        share = _core.converter_share(_core.Converter.MAX31855, quarters / 4)
        assert share == (quarters + 8192) / 16384
        assert celsius_at(table, share) == pytest.approx(quarters / 4, abs=1e-9)


@pytest.mark.parametrize(
    ("word", "celsius"),
    [
        (0x640000, 1600.0), (0x3E8000, 1000.0), (0x064F00, 100.9375), (0x019000, 25.0),
        (0x000100, 0.0625), (0x000020, 0.0078125), (0, 0.0), (0xFFFF00, -0.0625),
        (0xFFFC00, -0.25), (0xFFF000, -1.0), (0xF06000, -250.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("unused", [0, 0x1F])
def test_max31856_thermocouple(word, celsius, unused):
    assert _core.read_converter(MAX31856, word | unused) == (celsius, FAULT.NONE)
    table = sensor_table(UniversalConverter(kind="max31856", **PINS))
    if table[0][0] <= celsius <= table[-1][0]:
        share = _core.converter_share(MAX31856, celsius)
        assert celsius_at(table, share) == pytest.approx(celsius, abs=1e-9)


@pytest.mark.parametrize(
    ("faults", "fault"),
    [
        (0x01, FAULT.OPEN), (0x41, FAULT.OPEN), (0x02, FAULT.SHORT_CIRCUIT),
        *((1 << bit, FAULT.OUT_OF_RANGE) for bit in range(2, 8)), (0xFF, FAULT.NO_ANSWER),
    ],
)  # fmt: skip
def test_max31856_faults(faults, fault):
    assert _core.read_converter(MAX31856, 0x019000, faults) == (25.0, fault)


# °C, ohm of a PT100 (IEC 60751) and what a MAX31865 counts of it against 400 ohm.
RTD = [
    (-50.0, 80.31, 6578), (0.0, 100.0, 8192), (30.0, 111.67, 9148), (100.0, 138.51, 11346),
    (250.0, 194.10, 15900), (400.0, 247.09, 20241), (550.0, 297.49, 24370),
]  # fmt: skip


@pytest.mark.parametrize(("celsius", "ohm", "count"), RTD)
@pytest.mark.parametrize("r0", [100, 1000])
def test_max31865_platinum(celsius, ohm, count, r0):
    assert _core.read_converter(MAX31865, count << 1) == (count / 32768, FAULT.NONE)
    assert count == int(ohm / 400 * 32768)
    sensor = PlatinumConverter(kind="max31865", r0_ohm=r0, reference_ohm=4 * r0, **PINS)
    # A count is 1/32 °C, or a little more where it is hot.
    assert celsius_at(sensor_table(sensor), count / 32768) == pytest.approx(celsius, abs=0.045)


@pytest.mark.parametrize(
    ("faults", "fault"),
    [
        (0x80, FAULT.OPEN), (0x20, FAULT.OPEN), (0x40, FAULT.SHORT_CIRCUIT),
        (0x10, FAULT.SHORT_CIRCUIT), (0x08, FAULT.SHORT_CIRCUIT), (0x04, FAULT.SHORT_CIRCUIT),
        (0xFF, FAULT.NO_ANSWER),
    ],
)  # fmt: skip
def test_max31865_faults(faults, fault):
    assert _core.read_converter(MAX31865, 8192 << 1 | 1, faults) == (0.25, fault)


@pytest.mark.parametrize(
    ("converter", "low", "high", "words"),
    [
        (MAX31855, 5.0, 280.0, (20 << 18, 1120 << 18 | 0x3FFFF)),
        (MAX31855, -20.0, 280.0, (0, 1120 << 18 | 0x3FFFF)),
        (MAX6675, 5.0, 280.0, (20 << 3, 1120 << 3 | 7)),
        (MAX31856, 5.0, 280.0, (640 << 5, 35840 << 5 | 31)),
        (MAX31865, 0.25, 0.5, (8192 << 1, 16384 << 1 | 1)),
    ],
)
def test_the_range_of_words_that_the_board_watches(converter, low, high, words):
    shares = (_core.converter_share(converter, value) for value in (low, high))
    assert _core.converter_words(converter, *shares) == words


@pytest.mark.parametrize(("kind", "number"), [(k, i) for i, k in enumerate("BEJKNRST")])
@pytest.mark.parametrize(("mains", "bit"), [(50, 1), (60, 0)])
def test_max31856_gets_its_settings(kind, number, mains, bit):
    sensor = UniversalConverter(kind="max31856", thermocouple=kind, mains_hz=mains, **PINS)
    setup = converter_setup(sensor)
    assert setup.words == (bytes([0x81, number]), bytes([0x80, 0x10 | bit]),
                           bytes([0x80, 0x90 | bit]))  # fmt: skip
    assert setup.clears_faults == b""


@pytest.mark.parametrize(("wires", "bits"), [(2, 0), (3, 0x10), (4, 0)])
def test_max31865_setup(wires, bits):
    setup = converter_setup(PlatinumConverter(kind="max31865", wires=wires, mains_hz=60, **PINS))
    assert setup.words == (bytes([0x80, 0]), bytes([0x80, 0xC2 | bits]))
    assert setup.clears_faults == setup.words[-1]
