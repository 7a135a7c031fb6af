"""SPI by software: the edges on its pins, read back bit by bit."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support.raw_board import RawBoard

PINS = {"select": "PB4", "miso": "PE5", "mosi": "PH5", "clock": "PH6"}


def wired(mode: int, active_high: int = 0) -> RawBoard:
    """A device (oid 0) on these pins, and a message for the end (oid 1)."""
    board = RawBoard()
    for line in (
        "allocate_oids count=2",
        f"config_spi oid=0 pin={PINS['select']} cs_active_high={active_high}",
        f"spi_set_sw_bus oid=0 miso_pin={PINS['miso']} mosi_pin={PINS['mosi']}"
        f" sclk_pin={PINS['clock']} mode={mode} pulse_ticks=16",
        "config_spi_shutdown oid=1 spi_oid=0 shutdown_msg=a50f",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
        assert board.device.fault == "", line
    for name in PINS.values():
        board.device.trace_edges(pin(board, name))
    return board


def pin(board: RawBoard, name: str) -> int:
    return board.dictionary.enumerations["pin"][name]


def levels(board: RawBoard, name: str) -> list[int]:
    return [level for _, level in board.device.take_edges(pin(board, PINS[name]))]


@given(st.integers(0, 3), st.sampled_from([0, 1]), st.binary(min_size=1, max_size=50))
def test_a_transfer_clocks_each_bit_and_selects_the_device(mode, active_high, data):
    board = wired(mode, active_high)
    board.simulated.force_switch("x", len(data) % 2 == 0)  # what the device answers, all the time
    [(name, values)] = board.tell(f"spi_transfer oid=0 data={data.hex()}")
    assert (name, values["oid"]) == ("spi_transfer_response", 0)
    assert values["response"] == (b"\xff" if len(data) % 2 == 0 else b"\x00") * len(data)
    rest = mode >> 1
    assert levels(board, "clock") == [1 - rest, rest] * 8 * len(data)
    assert levels(board, "select") == [active_high, 1 - active_high]
    bits = "0" + "".join(f"{byte:08b}" for byte in data)
    changes = [int(b) for a, b in pairwise(bits) if a != b]
    assert levels(board, "mosi") == changes
    assert board.tell(f"spi_send oid=0 data={data.hex()}") == []
    assert levels(board, "clock") == [1 - rest, rest] * 8 * len(data)


@pytest.mark.parametrize("line", ["emergency_stop", "reset"])
def test_message_in_progress_is_completed_at_shutdown(line):
    board = wired(0)
    board.tell(line)
    assert levels(board, "mosi") == [1, 0, 1, 0, 1, 0, 1, 0, 1]
    assert levels(board, "select") == [0, 1]
    assert len(levels(board, "clock")) == 32


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("spi_transfer oid=0 data=00", "SPI device without a bus"),
        ("config_spi_shutdown oid=1 spi_oid=0 shutdown_msg=00", "SPI device without a bus"),
        ("spi_set_sw_bus oid=0 miso_pin=PE5 mosi_pin=PH5 sclk_pin=PH6 mode=4 pulse_ticks=1",
         "Pins cannot make an SPI bus"),
        ("spi_set_sw_bus oid=0 miso_pin=PE5 mosi_pin=PH5 sclk_pin=PH6 mode=0 pulse_ticks=32768",
         "SPI clock too slow for this board"),
        ("spi_set_sw_bus oid=0 miso_pin=PE5 mosi_pin=PH5 sclk_pin=PH6 mode=0 pulse_ticks=16001",
         "SPI clock too slow for this board"),
        ("spi_send oid=1 data=00", "Invalid oid type"),
    ],
)  # fmt: skip
def test_misuse_shuts_the_board_down(line, fault):
    board = RawBoard()
    board.tell("allocate_oids count=2")
    board.tell("config_spi_without_cs oid=0")
    board.tell(line)
    assert board.device.fault == fault
