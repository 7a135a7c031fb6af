"""The table [accelerometer]: its bus, its board, its directions."""

from __future__ import annotations

import pytest
from tests.support.edited_machine import edited

from passo import config
from passo.board.configuration import commands
from passo.board.dictionary import Dictionary
from passo.errors import ConfigError
from passo.printer.setup.boards import board_descriptions

REAL = ('base = "ramps"', 'base = "ramps"\nlink = "serial"\nport = "/dev/ttyUSB0"')
I2C = 'chip = "lis2dw"\nscl_pin = "D40"\nsda_pin = "D42"\n'
SPI = 'cs_pin = "D40"\nclock_pin = "D42"\nmosi_pin = "D59"\nmiso_pin = "D64"\n'
RPI = """
[boards.rpi]
base = "klipper"
clock_hz = 50_000_000
link = "serial"
port = "/tmp/klipper_host_mcu"
"""


def problems(table: str, *changes: tuple[str, str]) -> list[str]:
    with pytest.raises(ConfigError) as error:
        edited("i3", *changes, more=f"[accelerometer]\n{table}")
    return [problem.sentence for problem in error.value.problems]


@pytest.mark.parametrize(
    ("table", "key", "says"),
    [
        ("", "accelerometer.cs_pin", "a pin, or the key spi_bus"),
        (SPI.replace("D42", "D54"), "accelerometer.clock_pin", "belongs to"),
        (SPI.replace("D42", "!D42"), "accelerometer.clock_pin", "it does nothing here"),
        (f'{SPI}spi_bus = "spi1"', "accelerometer.clock_pin", "spi_bus has the pins"),
        ('spi_bus = "spi1"', "accelerometer.spi_bus", "Passo's firmware has no buses"),
        (f'{SPI}axes_map = ["x", "-x", "z"]', "accelerometer.axes_map", "x, y and z once each"),
        (f'{SPI}chip = "lis2dw"\nrate_hz = 3200', "accelerometer.rate_hz", "800 or 1600"),
        (f'{SPI}chip = "bmi160"', "accelerometer.chip", "adxl345"),
        (f"{SPI}i2c_hz = 100000", "accelerometer.i2c_hz", "the accelerometer is on SPI"),
        (f'{I2C}cs_pin = "D59"', "accelerometer.cs_pin", "the accelerometer is on I2C"),
        (I2C.replace("lis2dw", "adxl345"), "accelerometer.chip", "lis2dw, because it is on I2C"),
        (I2C.replace("D42", "D54"), "accelerometer.sda_pin", "belongs to"),
        (I2C.replace("sda_pin", "i2c_bus"), "accelerometer.scl_pin", "i2c_bus has the pins"),
        (f"{I2C}i2c_address = 0x1a", "accelerometer.i2c_address", "24 or 25"),
        ('chip = "lis2dw"\nscl_pin = "D40"', "accelerometer.sda_pin", "or the key i2c_bus"),
        ('chip = "lis2dw"\ni2c_bus = "i2c1"', "accelerometer.i2c_bus", "give scl_pin, sda_pin"),
    ],
)
def test_accelerometer_errors_name_the_key(table: str, key: str, says: str) -> None:
    found = problems(table)
    assert any(key in text and says in text for text in found), found


def test_accelerometer_on_an_avr_is_refused() -> None:
    (text,) = problems(SPI, REAL)
    assert "accelerometer.cs_pin" in text and "ATmega2560 is too slow" in text
    text, *_ = problems('spi_bus = "spi1"', REAL)
    assert "accelerometer.spi_bus" in text and "Passo's firmware has no buses" in text
    (text,) = problems(I2C, REAL)
    assert "accelerometer.scl_pin" in text and "ATmega2560 is too slow" in text


def test_accelerometer_may_be_on_a_raspberry_pi() -> None:
    """The words for Klipper's firmware."""
    tables = f"""{RPI}
[accelerometer]
spi_bus = "rpi:spidev0.0"
axes_map = ["-y", "x", "z"]
"""
    machine = edited("i3", REAL, more=tables)
    assert machine.accelerometer is not None
    board = board_descriptions(machine)["rpi"]
    (part,) = board.accelerometers
    assert part.axes == ((1, -1), (0, 1), (2, 1))
    lines = commands(board, Dictionary((), (), {}, {}))
    assert [line for line in lines if "spi" in line] == [
        "config_spi_without_cs oid=0",
        "spi_set_bus oid=0 spi_bus=spidev0.0 mode=3 rate=5000000",
        "config_adxl345 oid=1 spi_oid=0",
    ]


@pytest.mark.parametrize(
    ("keys", "words", "bus"),
    [
        (
            'i2c_bus = "rpi:i2c.1"\ni2c_hz = 100000',
            [],
            "i2c_set_bus oid=0 i2c_bus=i2c.1 rate=100000 address=25",
        ),
        (
            'scl_pin = "rpi:gpio3"\nsda_pin = "rpi:gpio2"\ni2c_address = 0x18',
            ["i2c_set_sw_bus oid=%c scl_pin=%u sda_pin=%u pulse_ticks=%u address=%u"],
            "i2c_set_sw_bus oid=0 scl_pin=gpio3 sda_pin=gpio2 pulse_ticks=62 address=24",
        ),
        (
            'scl_pin = "rpi:gpio3"\nsda_pin = "rpi:gpio2"',
            [],
            "i2c_set_software_bus oid=0 scl_pin=gpio3 sda_pin=gpio2 rate=400000 address=25",
        ),
    ],
)
def test_accelerometer_i2c_uses_klippers_messages(keys: str, words: list[str], bus: str) -> None:
    """As its host sends them: the pins' words are newer than those of a bus."""
    board = f'{RPI}[accelerometer]\nchip = "lis2dw"\n{keys}\n'
    described = board_descriptions(edited("i3", REAL, more=board))["rpi"]
    known = Dictionary(tuple(enumerate(words)), (), {}, {})
    assert [line for line in commands(described, known) if "allocate" not in line] == [
        "config_i2c oid=0",
        bus,
        "config_lis2dw oid=1 bus_oid=0 bus_oid_type=i2c lis_chip_type=LIS2DW",
    ]


def test_machine_without_the_table_has_no_accelerometer() -> None:
    assert config.load("i3").accelerometer is None
