"""How converters of each type are asked, bit by bit."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.support.raw_board import RawBoard

PINS = {"select": "PB4", "miso": "PE5", "mosi": "PH5", "clock": "PH6"}


def pin(board: RawBoard, name: str) -> int:
    return board.dictionary.enumerations["pin"][PINS[name]]


# type -> what the board sends in each transfer, bytes of the word
TYPES = {
    "MAX31855": ([bytes(4)], 4),
    "MAX31856": ([bytes([0x0C, 0, 0, 0]), bytes([0x0F, 0])], 3),
    "MAX31865": ([bytes([0x01, 0, 0]), bytes([0x07, 0])], 2),
    "MAX6675": ([bytes(2)], 2),
}


@pytest.mark.parametrize("high", [False, True])
@pytest.mark.parametrize("kind", TYPES)
def test_each_converter_type_is_read_by_its_protocol(kind, high):
    transfers, size = TYPES[kind]
    board = RawBoard()
    for line in (
        "allocate_oids count=2",
        f"config_spi oid=0 pin={PINS['select']} cs_active_high=0",
        f"spi_set_sw_bus oid=0 miso_pin={PINS['miso']} mosi_pin={PINS['mosi']}"
        f" sclk_pin={PINS['clock']} mode=1 pulse_ticks=16",
        f"config_thermocouple oid=1 spi_oid=0 thermocouple_type={kind}",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
        assert board.device.fault == "", line
    for name in PINS:
        board.device.trace_edges(pin(board, name))
    board.simulated.force_switch("x", high)  # what the converter answers, all the time
    board.tell(
        f"query_thermocouple oid=1 clock={board.clock(100)} rest_ticks=100000 min_value=0"
        f" max_value={2**32 - 1} max_invalid_count=1"
    )
    [(name, values)] = board.wait(200)
    registers = len(transfers) > 1
    assert (name, values["value"]) == ("thermocouple_result", 2 ** (8 * size) - 1 if high else 0)
    assert values["fault"] == (0xFF if registers and high else 0)

    def levels(name: str) -> list[int]:
        return [level for _, level in board.device.take_edges(pin(board, name))]

    assert levels("select") == [0, 1] * len(transfers)
    sent = b"".join(transfers)
    assert levels("clock") == [1, 0] * 8 * len(sent)
    bits = "0" + "".join(f"{byte:08b}" for byte in sent)
    assert levels("mosi") == [int(b) for a, b in pairwise(bits) if a != b]


def test_unknown_converter_type_shuts_board_down():
    board = RawBoard()
    board.tell("allocate_oids count=2")
    board.tell("config_spi oid=0 pin=PB4 cs_active_high=0")
    payload = board.commands.encode("config_thermocouple", [1, 0, 4])
    board.feed(payload)
    assert board.device.fault == "Invalid thermocouple chip type"


def test_a_converter_that_is_not_read_checks_nothing():
    board = RawBoard()
    for line in (
        "allocate_oids count=3",
        f"config_spi oid=0 pin={PINS['select']} cs_active_high=0",
        f"spi_set_sw_bus oid=0 miso_pin={PINS['miso']} mosi_pin={PINS['mosi']}"
        f" sclk_pin={PINS['clock']} mode=1 pulse_ticks=16",
        "config_thermocouple oid=1 spi_oid=0 thermocouple_type=MAX31855",
        "config_digital_out oid=2 pin=PF0 value=0 default_value=0 max_duration=2000",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
    ask = f"query_thermocouple oid=1 clock={board.clock(10**6)} rest_ticks={{}} min_value=1"
    board.tell(ask.format(10**6) + " max_value=9 max_invalid_count=1")
    board.tell("survive_output oid=2 value=1 seconds=60")
    assert board.device.fault == ""
    board.tell(ask.format(0) + " max_value=9 max_invalid_count=1")
    board.tell("survive_output oid=2 value=0 seconds=60")
    assert board.device.fault == ""  # it keeps nothing
    board.tell("survive_output oid=2 value=1 seconds=60")
    assert board.device.fault.startswith("No sensor watches")
