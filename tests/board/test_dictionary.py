"""Dictionaries and the decoded view of a wire."""

from __future__ import annotations

import zlib

import pytest
from tests.oracles import wire
from tests.support.link_bench import description

from passo import _core
from passo.board.dictionary import Dictionary, DictionaryError, decode
from passo.simulator.dictionary import compressed_dictionary

DICTIONARY = Dictionary.parse(compressed_dictionary(description()))


def test_constants_and_pins():
    assert DICTIONARY.number("CLOCK_FREQ") == 16_000_000
    assert DICTIONARY.number("ADC_MAX") == 1023
    assert DICTIONARY.number("NO_SUCH", 7) == 7
    assert DICTIONARY.enumerations["pin"]["PF0"] != DICTIONARY.enumerations["pin"]["PF1"]


def test_the_same_description_gives_the_same_bytes():
    assert compressed_dictionary(description()) == compressed_dictionary(description())


def test_a_range_of_pins_is_expanded():
    text = (
        b'{"commands":{},"responses":{},"config":{},"enumerations":{"pin":{"PA0":[8,4],"gpio":1}}}'
    )
    assert Dictionary.parse(zlib.compress(text)).enumerations["pin"] == {
        "PA0": 8,
        "PA1": 9,
        "PA2": 10,
        "PA3": 11,
        "gpio": 1,
    }


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"junk",
        zlib.compress(b"{"),
        zlib.compress(b"[]"),
        zlib.compress(b'{"commands":1}'),
        *(
            zlib.compress(
                b'{"commands":{},"responses":{},"config":{},"enumerations":{"pin":{"PA0":%s}}}' % v
            )
            for v in (b"[1]", b"[0, 1e999]", b"[0, 1000000000000]")
        ),
    ],
)
def test_a_damaged_dictionary_is_named(data):
    with pytest.raises(DictionaryError, match="damaged"):
        Dictionary.parse(data)


def test_a_constant_that_is_not_a_number_is_named():
    text = b'{"commands":{},"responses":{},"config":{"CLOCK_FREQ":"fast"},"enumerations":{}}'
    with pytest.raises(DictionaryError, match="the board's CLOCK_FREQ is 'fast', not a number"):
        Dictionary.parse(zlib.compress(text)).number("CLOCK_FREQ")


def test_values_follow_the_declaration():
    pins = DICTIONARY.enumerations["pin"]
    assert DICTIONARY.values(
        "config_stepper step_pin=PF0 oid=3 dir_pin=PF1 step_pulse_ticks=32 invert_step=0"
    ) == ("config_stepper", [3, pins["PF0"], pins["PF1"], 0, 32])
    assert DICTIONARY.values("debug_ping data=00ff") == ("debug_ping", [b"\x00\xff"])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("no_such_command", "no message 'no_such_command'"),
        ("config_endstop oid=1 pin=PZ9 pull_up=0", "no pin 'PZ9'"),
        ("queue_step oid=0", "does not match"),
        ("get_clock now", "'now'"),
    ],
)
def test_unknown_messages_and_names_are_refused(text, says):
    with pytest.raises(DictionaryError, match=says):
        DICTIONARY.values(text)


def test_decoded_frames_read_as_text():
    ids = {text.split()[0]: number for number, text in DICTIONARY.commands}
    payload = b"".join(map(wire.vlq, [ids["queue_step"], 0, 1234, 10, -3, ids["get_clock"]]))
    data = wire.frame(payload, 1) + wire.frame(b"", 2) + b"\x01\x02\x7e"
    assert decode(data, DICTIONARY) == [
        "queue_step oid=0 interval=1234 count=10 add=-3",
        "get_clock",
        "(acknowledge 2)",
        "(bytes that are not a frame)",
    ]


def test_decoded_reports():
    ids = {text.split()[0]: number for number, text in DICTIONARY.reports}
    payload = b"".join(map(wire.vlq, [ids["analog_in_state"], 4, 4294967290])) + b"\x02\x10\x20"
    assert decode(wire.frame(payload, 0), DICTIONARY, from_board=True) == [
        "analog_in_state oid=4 next_clock=4294967290 values=1020"
    ]


def test_a_message_that_lacks_a_byte_is_refused():
    """Nothing is read behind its end, also where what is missing is the last of a text."""
    reports = _core.Formats(DICTIONARY.reports)
    payload = reports.encode("analog_in_state", [4, 300, b"\x10\x20"])
    assert reports.decode(payload)[0][1]["values"] == b"\x10\x20"
    for size in range(1, len(payload)):
        with pytest.raises(ValueError, match="cut short"):
            reports.decode(payload[:size])
