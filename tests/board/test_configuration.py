"""Descriptions that no board could have, and the configuration of one that it can."""

from __future__ import annotations

import zlib
from dataclasses import replace

import pytest

from passo.board import Dictionary, Output, Stepper
from passo.board.configuration import checksum, commands, full_scale, queries
from passo.simulator.dictionary import compressed_dictionary

from .bench import HZ, description

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
def test_what_no_board_could_be_wired_like_is_refused(change, says):
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


def test_an_output_that_rests_on_is_configured_so():
    board = replace(BOARD, outputs=(*BOARD.outputs, Output("lamp", "PA0", default_on=True)))
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
