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
from passo.board.trinamic.datagrams import (
    crc8,
    spi20,
    spi20_value,
    spi_read,
    spi_value,
    spi_write,
    uart_read,
    uart_value,
    uart_write,
)
from passo.config.trinamic import CHIPS

WORD = st.integers(0, 2**32 - 1)
REGISTER = st.integers(0, 127)
ADDRESS = st.integers(0, 3)


@given(st.binary(max_size=8))
def test_uart_checksum_equals_polynomial_division(data):
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
def test_answer_with_one_wrong_bit_is_refused(register, value, bit):
    answer = trinamic.packed(trinamic.line_bits(trinamic.answer(register, value)))
    whole = int.from_bytes(answer, "little") ^ 1 << bit
    damaged = whole.to_bytes(10, "little")
    # The upper half of the first byte says nothing, but the checksum has it.
    assert uart_value(register, damaged) is None


def test_spi_datagrams_are_those_of_the_data_sheet():
    assert spi_read(0x6F) == bytes.fromhex("6f00000000")
    assert spi_write(0x10, 0x00061F0A) == bytes.fromhex("9000061f0a")  # an example of the sheet
    assert spi_value(bytes.fromhex("0900061f0a")) == 0x00061F0A
    assert spi_value(b"\xff" * 5) is None
    assert spi_value(b"\x00" * 5) == 0


def test_20_bit_datagrams_are_returned_by_the_chip():
    sent = spi20(7, 0x10)  # DRVCONF: the address is in the upper three bits
    assert sent == bytes.fromhex("e0010e0010")
    assert spi20_value(sent, bytes.fromhex("12045e0010")) == 0x12045
    assert spi20_value(sent, bytes.fromhex("12045e0011")) is None
    assert spi20_value(sent, bytes.fromhex("12145e0010")) is None  # a bit that is always 0
    assert spi20_value(sent, bytes(5)) is None


# chip, resistor, wanted current -> fields of the run current, the RMS current that they make
CURRENTS = [
    ("TMC2209", 0.11, 0.3, {"irun": 9, "vsense": 1}, 0.3060),
    ("TMC2209", 0.11, 0.58, {"irun": 18, "vsense": 1}, 0.5813),
    ("TMC2226", 0.11, 0.65, {"irun": 20, "vsense": 1}, 0.6425),
    ("TMC2209", 0.11, 0.8, {"irun": 25, "vsense": 1}, 0.7955),
    ("TMC2209", 0.11, 1.0, {"irun": 17, "vsense": 0}, 0.9791),
    ("TMC2225", 0.11, 1.2, {"irun": 21, "vsense": 0}, 1.1967),
    ("TMC2209", 0.11, 1.5, {"irun": 27, "vsense": 0}, 1.5230),
    ("TMC2208", 0.11, 1.74, {"irun": 31, "vsense": 0}, 1.7406),
    ("TMC2130", 0.11, 0.05, {"irun": 1, "vsense": 1}, 0.0612),
    ("TMC2208", 0.15, 0.74, {"irun": 31, "vsense": 1}, 0.7487),
    ("TMC5160", 0.075, 0.3, {"globalscaler": 32, "irun": 24}, 0.2992),
    ("TMC5160", 0.075, 0.5, {"globalscaler": 42, "irun": 31}, 0.5027),
    ("TMC5160", 0.075, 1.0, {"globalscaler": 84, "irun": 31}, 1.0054),
    ("TMC5160", 0.075, 3.0, {"globalscaler": 251, "irun": 31}, 3.0043),
    ("TMC5160", 0.075, 3.06, {"globalscaler": 0, "irun": 31}, 3.0641),
    ("TMC5160", 0.022, 0.8, {"globalscaler": 32, "irun": 19}, 0.8161),
    ("TMC5160", 0.022, 4.2, {"globalscaler": 103, "irun": 31}, 4.2028),
    ("TMC2240", 12_000, 0.3, {"current_range": 0, "globalscaler": 111, "irun": 31}, 0.3002),
    ("TMC2240", 12_000, 0.65, {"current_range": 0, "globalscaler": 240, "irun": 31}, 0.6491),
    ("TMC2240", 12_000, 0.8, {"current_range": 1, "globalscaler": 145, "irun": 31}, 0.8010),
    ("TMC2240", 12_000, 1.4, {"current_range": 1, "globalscaler": 253, "irun": 31}, 1.3976),
    ("TMC2240", 12_000, 2.0, {"current_range": 2, "globalscaler": 241, "irun": 31}, 1.9970),
    ("TMC2660", 0.051, 0.8, {"vsense": 1, "cs": 10}, 0.7864),
    ("TMC2660", 0.051, 1.6, {"vsense": 1, "cs": 21}, 1.5728),
    ("TMC2660", 0.051, 2.2, {"vsense": 1, "cs": 30}, 2.2162),
]


@pytest.mark.parametrize(("chip", "ohm", "ampere", "fields", "made"), CURRENTS)
def test_current_settings_match_the_data_sheet(chip, ohm, ampere, fields, made):
    numbers = CHIPS[chip].currents.numbers(ohm, ampere, ampere / 2)
    assert {name: numbers.fields[name] for name in fields} == fields
    assert numbers.run_a == pytest.approx(made, abs=6e-5)
    if chip != "TMC2660":
        assert numbers.hold_a == pytest.approx(ampere / 2, abs=made / 8)


# More standing than running: the range is large enough for both.
HOLDS = [("TMC2209", 0.11, 0.5, 1.5, 8, 27), ("TMC5160", 0.075, 0.5, 1.0, 15, 31)]


@pytest.mark.parametrize(("chip", "ohm", "run", "hold", "irun", "ihold"), HOLDS)
def test_hold_current_above_run_current_is_kept(chip, ohm, run, hold, irun, ihold):
    numbers = CHIPS[chip].currents.numbers(ohm, run, hold)
    assert (numbers.fields["irun"], numbers.fields["ihold"]) == (irun, ihold)
    assert (numbers.run_a, numbers.hold_a) == (pytest.approx(run, 0.03), pytest.approx(hold, 0.03))


SETTINGS = DriverSettings("TMC2209", 0.8, 0.4, 0.11)


def packed(chip, **changes):
    settings = replace(SETTINGS, chip=chip, resistor_ohm=CHIPS[chip].currents.resistor_ohm)
    return replace(settings, **changes).registers()


@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize("exponent", range(9))
def test_microsteps_and_mode(chip, exponent):
    made = packed(chip, microsteps=2**exponent, interpolate=False)
    values = {
        name: value
        for register in made
        for name, value in CHIPS[chip].registers[register].unpack(made[register]).items()
    }
    assert (values["mres"], values["intpol"], values["toff"]) == (8 - exponent, 0, 3)
    mode = CHIPS[chip].mode
    if mode:
        strong, silent = packed(chip), packed(chip, threshold=94)
        modes = [CHIPS[chip].registers["GCONF"].unpack(x["GCONF"])[mode] for x in (strong, silent)]
        assert modes == ([1, 0] if mode == "en_spreadcycle" else [0, 1])
        assert (strong["TPWMTHRS"], silent["TPWMTHRS"]) == (0, 94)


def test_all_registers_of_a_tmc2209():
    assert SETTINGS.writes() == [
        (0x00, 0x1C4),
        (0x03, 0x200),
        (0x10, 0x8190C),
        (0x11, 20),
        (0x13, 0),
        (0x14, 0),
        (0x40, 0),
        (0x42, 0),
        (0x70, 0xC10D0024),
        (0x6C, 0x140300C3),
        (0x01, 7),
    ]


@pytest.mark.parametrize(
    ("chip", "counts"), [("TMC2209", 94), ("TMC2130", 103), ("TMC2240", 98), ("TMC5160", 94)]
)
def test_thresholds_use_the_clock_of_the_chip(chip, counts):
    assert threshold_of(chip, 8000, 16) == counts  # 100 mm/s at 80 steps/mm


def test_the_threshold_is_a_time_of_256ths_of_a_step():
    assert threshold_of("TMC2209", 8000, 256) == 1500
    assert threshold_of("TMC2209", 1e-9, 16) == 0xFFFFF
    assert threshold_of("TMC2209", 1e9, 16) == 0


def test_fields_replace_start_values_and_are_bounded():
    chopper = packed("TMC5160", fields={"toff": 5, "tpfd": 9, "sgt": -3})
    values = CHIPS["TMC5160"].registers["CHOPCONF"].unpack(chopper["CHOPCONF"])
    assert (values["toff"], values["tpfd"], values["hstrt"]) == (5, 9, 4)
    assert CHIPS["TMC5160"].registers["COOLCONF"].unpack(chopper["COOLCONF"])["sgt"] == -3
    assert list(chopper)[-2:] == ["PWMCONF", "CHOPCONF"]
    with pytest.raises(ValueError, match="16 is not within 0 to 15"):
        packed("TMC5160", fields={"toff": 16})
    with pytest.raises(ValueError, match="-65 is not within -64 to 63"):
        packed("TMC2130", fields={"sgt": -65})


@pytest.mark.parametrize("chip", CHIPS)
def test_fields_of_a_register_have_bits_of_their_own(chip):
    for register in CHIPS[chip].registers.values():
        masks = [field.placed(-1 if field.signed else field.most)
                 for field in register.fields.values()]  # fmt: skip
        assert sum(masks) == sum(set(masks)) < 1 << 32
        assert sum(mask.bit_count() for mask in masks) == sum(masks).bit_count()


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
        ("TMC2240", 16, 0, ["undervoltage"]),
        ("TMC2240", 8, 1 << 26, ["reset", "hot"]),
        ("TMC2660", 0, 1 << 4, ["short-to-ground"]),
        ("TMC2660", 0, 1 << 2 | 1 << 1, ["overheated"]),
    ],
)
def test_status_bits_become_findings(chip, gstat, status, codes):
    found = findings("x", chip, Reading(gstat, status))
    assert [f.problem.code for f in found] == [f"driver.{code}" for code in codes]
    assert all(f.stops != (f.problem.code == "driver.hot") for f in found)


def test_open_coils_are_found_by_their_status_bits():
    assert open_coils("TMC2209", Reading(0, 1 << 7)) == ["B"]
    assert open_coils("TMC5160", Reading(0, 3 << 29)) == ["A", "B"]
    assert open_coils("TMC2660", Reading(0, 1 << 5)) == ["A"]
    assert open_coils("TMC2660", Reading(0, 1 << 7 | 1 << 5)) == []  # at standstill


def test_a_wire_that_is_always_low_is_not_a_driver():
    exchange = DriverLink("x", "TMC5160", SpiWire(0), "PG2").status()
    next(exchange)
    with pytest.raises(DriverFailure, match="does not answer"):
        for _ in range(100):
            exchange.send(bytes(5))
