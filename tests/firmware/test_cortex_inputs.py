"""Inputs of Cortex-M chips: what pulls them, and what the converter measures with."""

from __future__ import annotations

import pytest

from .talk import Host
from .test_cortex import CASES, Case, configured, dictionary_of, finalized, image


@pytest.fixture(params=CASES, ids=lambda case: case.board)
def case(request: pytest.FixtureRequest) -> Case:
    return request.param


def test_pull_up_is_on_if_requested(case: Case) -> None:
    name, pin = case.output
    for asked in (1, 0):
        host = case.host()
        host.send("allocate_oids count=1", f"config_endstop oid=0 pin={name} pull_up={asked}")
        assert host.chip.pull(pin) == asked


def test_outputs_and_sensors_have_no_pull_up(case: Case) -> None:
    host = configured(case)
    sensor = host.dictionary.enumerations["pin"][case.sensor[0]]
    for pin in (case.step[1], case.direction[1], case.output[1], sensor):
        assert host.chip.pull(pin) == 0


# How the converter is set up: 12 bits of the whole reference, samples of several µs.
CONVERTERS = {
    # 84 MHz / 2 / 21; start-up, settling, tracking and transfer as long as they may be
    "radds": {0x400C0004: 0x1F381400},
    # 96 MHz / 2 / 24; gain 1
    "4pi": {0x400A8004: 0x0FFF1700, 0x400A8064: 0x100},
    # A quarter of 84 MHz, 480 cycles for each channel, one conversion, 12 bits; ADC1 and ADC3
    **{
        board: {0x40012304: 1 << 16}
        | {
            adc + offset: value
            for adc in (0x40012000, 0x40012200)
            for offset, value in {4: 0, 12: 0x7FFFFFF, 16: 0x3FFFFFFF, 44: 0}.items()
        }
        for board in ("stm32f407-discovery", "stm32f429-discovery")
    },
    "pico": {0x4004C000: 1, 0x4004C008: 0, 0x4004C010: 0},
    # Bus / 2 / 8, long samples, 12 bits, inputs b; half of the sum that was found, with its mark
    **{
        board: {
            0x4003B008: 0x75,
            0x4003B00C: 0x10,
            0x4003B020: 0,
            0x4003B024: 0,
            0x4003B02C: 0x8000 | (100 + 200 + 400 + 800 + 1600 + 3200) // 2,
        }
        for board in ("teensy3-mk20dx128", "teensy3-mk20dx256")
    },
}


def test_the_converter_measures_with_its_whole_reference(case: Case) -> None:
    chip = case.model(image(case.board))
    if case.board.startswith("teensy"):
        for i in range(6):  # what it finds about itself
            chip.registers[0x4003B038 + 4 * i] = 100 << i
    Host(chip, dictionary_of(case.board)).send("get_uptime")
    expected = CONVERTERS[case.board]
    assert {address: chip.registers.get(address, 0) for address in expected} == expected


def test_adc_report_reaches_full_scale(case: Case) -> None:
    host = finalized(case)
    host.chip.analog[case.sensor[1]] = 4095
    at, ms = host.chip.clock + case.hz // 100, case.hz // 1000
    host.send(
        f"query_analog_in oid=2 clock={at} sample_ticks={ms} sample_count=4 rest_ticks={10 * ms}"
        " bytes_per_report=2 min_value=0 max_value=16380 range_check_count=4"
    )
    values = host.send("get_clock", seconds=0.03)["analog_in_state"]["values"]
    assert isinstance(values, bytes)
    assert int.from_bytes(values[-2:], "little") == 4 * 4095
