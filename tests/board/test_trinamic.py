"""Datagrams, registers and currents of drivers with registers."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.oracles import trinamic

from passo.board.trinamic import (
    DriverFailure,
    DriverLink,
    DriverSettings,
    Reading,
    SpiWire,
    findings,
    open_coils,
    threshold_of,
)
from passo.board.trinamic import registers as r
from passo.board.trinamic.current import current_numbers
from passo.board.trinamic.datagrams import (
    crc8,
    spi_read,
    spi_value,
    spi_write,
    uart_read,
    uart_value,
    uart_write,
)

WORD = st.integers(0, 2**32 - 1)
REGISTER = st.integers(0, 127)
ADDRESS = st.integers(0, 3)


@given(st.binary(max_size=8))
def test_the_checksum_is_a_division_of_polynomials(data):
    assert crc8(data) == trinamic.checksum(data)


@given(ADDRESS, REGISTER, WORD)
def test_uart_datagrams_are_those_of_the_data_sheet(address, register, value):
    def bits(data: bytes) -> bytes:
        return trinamic.packed(trinamic.line_bits(data))

    assert uart_read(address, register) == bits(trinamic.read_request(address, register))
    written = bits(trinamic.write_access(address, register, value))
    assert uart_write(address, register, value) == written
    answer = bits(trinamic.answer(register, value))
    assert uart_value(register, answer) == value
    assert uart_value(register ^ 1, answer) is None
    assert uart_value(register, answer[:-1]) is None
    assert uart_value(register, b"") is None


@given(REGISTER, WORD, st.integers(0, 79))
def test_one_wrong_bit_spoils_an_answer(register, value, bit):
    answer = trinamic.packed(trinamic.line_bits(trinamic.answer(register, value)))
    whole = int.from_bytes(answer, "little") ^ 1 << bit
    damaged = whole.to_bytes(10, "little")
    # The upper half of the first byte says nothing, but the checksum has it.
    assert uart_value(register, damaged) is None


def test_spi_datagrams():
    assert spi_read(0x6F) == bytes.fromhex("6f00000000")
    assert spi_write(0x10, 0x00061F0A) == bytes.fromhex("9000061f0a")  # an example of the sheet
    assert spi_value(bytes.fromhex("0900061f0a")) == 0x00061F0A
    assert spi_value(b"\xff" * 5) is None
    assert spi_value(b"\x00" * 5) == 0


# chip, resistor, wanted current -> irun, vsense, scaler, what it makes
CURRENTS = [
    ("TMC2209", 0.11, 0.8, 25, 1, 256, 0.7955),
    ("TMC2209", 0.11, 1.0, 17, 0, 256, 0.9791),
    ("TMC2208", 0.11, 1.74, 31, 0, 256, 1.7406),
    ("TMC2130", 0.11, 0.05, 1, 1, 256, 0.0612),
    ("TMC2208", 0.15, 0.74, 31, 1, 256, 0.7487),
    ("TMC5160", 0.075, 3.06, 31, 0, 256, 3.0641),
    ("TMC5160", 0.075, 1.0, 31, 0, 84, 1.0054),
    ("TMC5160", 0.075, 0.1, 7, 0, 32, 0.0958),
]


@pytest.mark.parametrize(("chip", "ohm", "ampere", "irun", "vsense", "scaler", "made"), CURRENTS)
def test_currents(chip, ohm, ampere, irun, vsense, scaler, made):
    numbers = current_numbers(chip, ohm, ampere, ampere / 2)
    assert (numbers.irun, numbers.vsense, numbers.scaler) == (irun, vsense, scaler)
    assert numbers.run_a == pytest.approx(made, abs=5e-5)
    assert numbers.hold_a == pytest.approx(ampere / 2, abs=made / (irun + 1))


# More standing than running: the range is large enough for both.
HOLDS = [("TMC2209", 0.11, 0.5, 1.5, 8, 27), ("TMC5160", 0.075, 0.5, 1.0, 15, 31)]


@pytest.mark.parametrize(("chip", "ohm", "run", "hold", "irun", "ihold"), HOLDS)
def test_a_standing_current_above_the_running_one(chip, ohm, run, hold, irun, ihold):
    numbers = current_numbers(chip, ohm, run, hold)
    assert (numbers.irun, numbers.ihold) == (irun, ihold)
    assert (numbers.run_a, numbers.hold_a) == (pytest.approx(run, 0.03), pytest.approx(hold, 0.03))


SETTINGS = DriverSettings("TMC2209", 0.8, 0.4, 0.11)


@pytest.mark.parametrize("chip", r.CHIPS)
@pytest.mark.parametrize("exponent", range(9))
def test_microsteps_and_mode(chip, exponent):
    made = dict(replace(SETTINGS, chip=chip, microsteps=2**exponent, interpolate=False).writes())
    chopper = r.CHIPS[chip].unpack(r.CHOPCONF, made[r.CHOPCONF])
    assert (chopper["mres"], chopper["intpol"], chopper["toff"]) == (8 - exponent, 0, 3)
    strong = dict(replace(SETTINGS, chip=chip).writes())
    silent = dict(replace(SETTINGS, chip=chip, threshold=94).writes())
    bit = "en_spreadcycle" if chip in ("TMC2208", "TMC2209") else "en_pwm_mode"
    modes = [r.CHIPS[chip].unpack(r.GCONF, made[r.GCONF])[bit] for made in (strong, silent)]
    assert modes == ([1, 0] if bit == "en_spreadcycle" else [0, 1])
    assert (strong[r.TPWMTHRS], silent[r.TPWMTHRS]) == (0, 94)


def test_all_registers_of_a_tmc2209():
    assert SETTINGS.writes() == [
        (0x00, 0x1C4),
        (0x03, 0x200),
        (0x10, 0x8190C),
        (0x11, 20),
        (0x13, 0),
        (0x70, 0xC10D0024),
        (0x6C, 0x140300C3),
        (0x01, 7),
    ]


def test_the_threshold_is_a_time_of_256ths_of_a_step():
    assert threshold_of(8000, 16) == 94  # 100 mm/s at 80 steps/mm
    assert threshold_of(8000, 256) == 1500
    assert threshold_of(1e-9, 16) == 0xFFFFF
    assert threshold_of(1e9, 16) == 0


@pytest.mark.parametrize(
    ("chip", "gstat", "status", "codes"),
    [
        ("TMC2209", 0, 0xC0000000, []),
        ("TMC2209", 0, 1 << 2, ["short-to-ground"]),
        ("TMC2209", 0, 1 << 5, ["short-to-supply"]),
        ("TMC2208", 2, 1 << 1 | 1, ["overheated"]),
        ("TMC2208", 0, 1, ["hot"]),
        ("TMC2209", 1, 0, ["reset"]),
        ("TMC2209", 4, 0, ["undervoltage"]),
        ("TMC2209", 2, 0, ["stopped"]),
        ("TMC2130", 0, 1 << 28, ["short-to-ground"]),
        ("TMC5160", 0, 1 << 12, ["short-to-supply"]),
        ("TMC5160", 0, 1 << 25 | 1 << 26, ["overheated"]),
        ("TMC2130", 0, 1 << 26, ["hot"]),
    ],
)
def test_findings(chip, gstat, status, codes):
    found = findings("x", chip, Reading(gstat, status))
    assert [f.problem.code for f in found] == [f"driver.{code}" for code in codes]
    assert all(f.stops != (f.problem.code == "driver.hot") for f in found)


def test_open_coils():
    assert open_coils("TMC2209", Reading(0, 1 << 7)) == ["B"]
    assert open_coils("TMC5160", Reading(0, 3 << 29)) == ["A", "B"]


def test_a_wire_that_is_always_low_is_not_a_driver():
    exchange = DriverLink("x", "TMC5160", SpiWire(0), "PG2").status()
    next(exchange)
    with pytest.raises(DriverFailure, match="does not answer"):
        for _ in range(100):
            exchange.send(bytes(5))
