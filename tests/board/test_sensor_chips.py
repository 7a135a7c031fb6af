"""Sensor chips on I2C: the examples of their data sheets."""

from __future__ import annotations

import pytest

from passo.board.i2c_sensors.bosch_chips import bme280, bmp180
from passo.board.i2c_sensors.exchanges import ChipError, Measured
from passo.board.i2c_sensors.simple_chips import CHIPS, crc8


@pytest.mark.parametrize(
    ("data", "start", "crc"),
    [("beef", 0xFF, 0x92), ("dc", 0, 0x79), ("683a", 0, 0x7C), ("4e85", 0, 0x6B)],
)
def test_checksums_of_sht3x_and_htu21d(data: str, start: int, crc: int) -> None:
    assert crc8(bytes.fromhex(data), start) == crc


def test_bmp180_of_its_data_sheet() -> None:
    dig = (408, -72, -14383, 32741, 32757, 23153, 6190, 4, -32768, -8711, 2868)
    assert bmp180(dig, 27898, 23843, 0) == Measured(15.0, None, 699.64)


def test_bmp280_of_its_data_sheet() -> None:
    dig = (27504, 26435, -1000, 36477, -10685, 3024, 2855, 140, -7, 15500, -14600, 6000)
    found = bme280(dig, (), 519888, 415148, 0)
    assert found.celsius == pytest.approx(25.08, abs=0.005)
    assert found.pressure_hpa == pytest.approx(1006.5327, abs=0.0005)


@pytest.mark.parametrize(
    ("word", "celsius"),
    [("7d00", 125), ("1900", 25), ("0080", 0.5), ("ff80", -0.5), ("e700", -25), ("c900", -55)],
)
def test_lm75_of_its_data_sheet(word: str, celsius: float) -> None:
    assert CHIPS["lm75"].decode(bytes.fromhex(word)).celsius == celsius


def test_htu21d_of_its_data_sheet() -> None:
    found = CHIPS["htu21d"].decode(bytes.fromhex("683a7c4e856b"))
    assert found.celsius == pytest.approx(24.686, abs=0.01)
    assert found.humidity == pytest.approx(32.3, abs=0.1)


@pytest.mark.parametrize(
    ("kind", "data", "celsius", "humidity"),
    [
        ("sht3x", "000081ffffac", -45.0, 100.0),
        ("aht1x", "1c8000080000", 50.0, 50.0),
        ("aht1x", "1c0000080000", 50.0, 0.0),
    ],
)
def test_ends_and_middles_of_the_ranges(
    kind: str, data: str, celsius: float, humidity: float
) -> None:
    assert CHIPS[kind].decode(bytes.fromhex(data)) == Measured(celsius, humidity)


@pytest.mark.parametrize(
    ("kind", "data", "fault"),
    [
        ("htu21d", "683a7d4e856b", "garbled"),
        ("sht3x", "000081ffffad", "garbled"),
        ("aht1x", "9c8000080000", "silent"),
    ],
)
def test_wrong_answers_give_no_measurement(kind: str, data: str, fault: str) -> None:
    with pytest.raises(ChipError) as caught:
        CHIPS[kind].decode(bytes.fromhex(data))
    assert caught.value.fault == fault
