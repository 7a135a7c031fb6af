"""Descriptions that no board could have, and the configuration of one that it can."""

from __future__ import annotations

import zlib
from dataclasses import replace

import pytest
from tests.support.link_bench import HZ, description

from passo import _core
from passo.board.configuration import checksum, commands, full_scale, queries, uart_bit_ticks
from passo.board.description import Driver, Output, Sensor, SpiPins, Stepper, UartPins
from passo.board.dictionary import Dictionary
from passo.board.trinamic import DriverSettings
from passo.board.words import check_words
from passo.simulator.dictionary import compressed_dictionary

BOARD = description()
DICTIONARY = Dictionary.parse(compressed_dictionary(BOARD))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"steppers": (Stepper("x", "PA0", "PA1"), Stepper("x", "PA2", "PA3"))}, "stepper name x"),
        ({"steppers": (Stepper("x", "PA0", "!PA0"),)}, "pin PA0"),
        ({"steppers": (Stepper("x", "PB4", "PA0"),)}, "pin PB4"),
        ({"outputs": ()}, "heater hotend: its output or sensor"),
        ({"outputs": (Output("hotend", "PB4"),)}, "needs a maximum duration"),
    ],
)
def test_impossible_wiring_is_refused(change, says):
    with pytest.raises(ValueError, match=says):
        replace(BOARD, **change)


def test_the_configuration_names_every_part_once():
    assert commands(BOARD, DICTIONARY) == [
        "allocate_oids count=8",
        "config_stepper oid=0 step_pin=PF0 dir_pin=PF1 invert_step=0 step_pulse_ticks=32",
        "config_stepper oid=1 step_pin=PF6 dir_pin=PF7 invert_step=0 step_pulse_ticks=32",
        "config_digital_out oid=2 pin=PH6 value=0 default_value=0 max_duration=0",
        "set_digital_out_pwm_cycle oid=2 cycle_ticks=160000",
        "config_digital_out oid=3 pin=PB4 value=0 default_value=0 max_duration=48000000",
        "set_digital_out_pwm_cycle oid=3 cycle_ticks=1600000",
        "config_pwm_out oid=4 pin=PH5 cycle_ticks=9 value=0 default_value=0 max_duration=0",
        "config_analog_in oid=5 pin=PK5",
        "config_endstop oid=6 pin=PE5 pull_up=1",
        "config_trsync oid=7",
    ]


def test_output_that_is_on_at_start_is_configured_on():
    board = replace(BOARD, outputs=(*BOARD.outputs, Output("lamp", "PA0", start=1.0, at_halt=1.0)))
    dictionary = Dictionary.parse(compressed_dictionary(board))
    lines = commands(board, dictionary)
    assert "config_digital_out oid=5 pin=PA0 value=1 default_value=1 max_duration=0" in lines


def test_the_checksum_is_the_crc_of_the_lines():
    assert checksum(["a", "b"]) == zlib.crc32(b"a\nb")
    assert checksum(commands(BOARD, DICTIONARY)) != checksum(
        commands(replace(BOARD, endstops=()), DICTIONARY)
    )


def test_full_scale_depends_on_the_kind():
    assert full_scale(BOARD.outputs[0], DICTIONARY) == HZ // 100
    assert full_scale(BOARD.outputs[2], DICTIONARY) == 255
    assert full_scale(Output("plain", "PA0"), DICTIONARY) == 1


def test_sensors_report_four_times_a_second_within_their_range():
    assert queries(BOARD, DICTIONARY, 2**32 + 5) == [
        "query_analog_in oid=5 clock=5 sample_ticks=16000 sample_count=8 rest_ticks=4000000"
        " bytes_per_report=2 min_value=81 max_value=8102 range_check_count=4"
    ]


def test_buses_of_drivers_and_converters_are_configured():
    silent = DriverSettings("TMC2209", 0.8, 0.8, 0.11)
    bus = ("PA1", "PA2", "PA3")
    wired = SpiPins("PA4", *bus, mode=0)
    thermocouple = Sensor(
        "hotend", "PA4", ((0.0, 0.5), (1000.0, 0.75)), 0.505, 0.55,
        converter=_core.Converter.MAX31855, spi=wired,
    )  # fmt: skip
    board = replace(
        BOARD,
        sensors=(thermocouple,),
        drivers=(
            Driver("x", UartPins("^PC0", "PC0"), silent),
            Driver("y", SpiPins("PA0", *bus), replace(silent, chip="TMC5160")),
        ),
    )
    dictionary = Dictionary.parse(compressed_dictionary(board))
    assert commands(board, dictionary)[8:] == [
        "config_endstop oid=6 pin=PE5 pull_up=1",
        "config_trsync oid=7",
        "config_tmcuart oid=8 rx_pin=PC0 pull_up=1 tx_pin=PC0 bit_time=1776",
        "config_spi oid=9 pin=PA0 cs_active_high=0",
        "spi_set_sw_bus oid=9 miso_pin=PA3 mosi_pin=PA2 sclk_pin=PA1 mode=3 pulse_ticks=80",
        "config_spi oid=10 pin=PA4 cs_active_high=0",
        "spi_set_sw_bus oid=10 miso_pin=PA3 mosi_pin=PA2 sclk_pin=PA1 mode=0 pulse_ticks=80",
        "config_thermocouple oid=5 spi_oid=10 thermocouple_type=MAX31855",
    ]
    low, high = 82, 819  # quarters of a degree
    assert queries(board, dictionary, 5) == [
        f"query_thermocouple oid=5 clock=5 rest_ticks=4000000 min_value={low << 18}"
        f" max_value={high << 18 | 0x3FFFF} max_invalid_count=4"
    ]
    # Klipper's firmware of before v0.11, and that of early versions of Passo
    for limit in ("", " consecutive_fault_limit=%u"):
        uncounted = replace(
            dictionary,
            commands=tuple(
                (number, text.removesuffix(" max_invalid_count=%c") + limit * config)
                for number, text in dictionary.commands
                for config in [text.startswith("config_thermocouple ")]
            ),
        )
        check_words(board, uncounted)
        assert commands(board, uncounted)[-1] == (
            "config_thermocouple oid=5 spi_oid=10 thermocouple_type=MAX31855"
            + limit.replace("%u", "3")
        )
        assert queries(board, uncounted, 5)[0].endswith(f" max_value={high << 18 | 0x3FFFF}")
    older = replace(
        dictionary,
        commands=tuple(
            (
                number,
                text.replace("spi_set_sw_bus", "spi_set_software_bus").replace(
                    "pulse_ticks", "rate"
                ),
            )
            for number, text in dictionary.commands
        ),
    )
    assert (
        "spi_set_software_bus oid=9 miso_pin=PA3 mosi_pin=PA2 sclk_pin=PA1 mode=3 rate=100000"
        in commands(board, older)
    )


@pytest.mark.parametrize(
    ("hz", "ticks"), [(16_000_000, 1776), (84_000_000, 2100), (168_000_000, 4200)]
)
def test_uart_bit_time_is_within_the_boards_ability(hz, ticks):
    assert uart_bit_ticks(hz) == ticks
