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
SPI = 'cs_pin = "D40"\nclock_pin = "D42"\nmosi_pin = "D59"\nmiso_pin = "D64"\n'


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
        ('spi_bus = "spi1"', "accelerometer.spi_bus", "a simulated board has no buses"),
        (f'{SPI}axes_map = ["x", "-x", "z"]', "accelerometer.axes_map", "x, y and z once each"),
        (f'{SPI}chip = "lis2dw"\nrate_hz = 3200', "accelerometer.rate_hz", "800 or 1600"),
        (f'{SPI}chip = "bmi160"', "accelerometer.chip", "adxl345"),
    ],
)
def test_what_is_wrong_is_named(table: str, key: str, says: str) -> None:
    found = problems(table)
    assert any(key in text and says in text for text in found), found


def test_a_real_avr_is_too_slow() -> None:
    (text,) = problems(SPI, REAL)
    assert "accelerometer.cs_pin" in text and "ATmega2560 is too slow" in text
    text, *_ = problems('spi_bus = "spi1"', REAL)
    assert "accelerometer.spi_bus" in text and "Passo's firmware has no buses" in text


def test_a_raspberry_pi_has_a_bus_of_its_own() -> None:
    """The words for Klipper's firmware."""
    tables = """
[boards.rpi]
base = "klipper"
clock_hz = 50_000_000
link = "serial"
port = "/tmp/klipper_host_mcu"
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


def test_a_machine_without_the_table_has_none() -> None:
    assert config.load("i3").accelerometer is None
