"""I2C by software: what is on its two lines, read back bit by bit."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support.raw_board import RawBoard

STATUS = ["SUCCESS", "NACK", "BUS_TIMEOUT", "START_NACK", "START_READ_NACK"]
SCL, SDA = "PH6", "PE5"  # SDA is the bench's switch: pressed it is high


def wired(address: int = 0x48, scl: str = SCL, sda: str = SDA) -> RawBoard:
    board = RawBoard()
    for line in (
        "allocate_oids count=1",
        "config_i2c oid=0",
        f"i2c_set_sw_bus oid=0 scl_pin={scl} sda_pin={sda} pulse_ticks=80 address={address}",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
        assert board.device.fault == "", line
    status = board.dictionary.enumerations["i2c_bus_status"]
    assert status == {name: number for number, name in enumerate(STATUS)}
    for name in (SCL, SDA):
        board.device.trace_edges(pin(board, name))
    return board


def pin(board: RawBoard, name: str) -> int:
    return board.dictionary.enumerations["pin"][name]


def transfer(board: RawBoard, data: bytes, read: int) -> tuple[str, bytes]:
    [(name, values)] = board.tell(f"i2c_transfer oid=0 write={data.hex()} read_len={read}")
    assert name == "i2c_response"
    return STATUS[values["i2c_bus_status"]], values["response"]


def heard(board: RawBoard) -> tuple[int, list[int]]:
    """Clock pulses, and the levels that the data line took."""
    clocks = [level for _, level in board.device.take_edges(pin(board, SCL))]
    data = [level for _, level in board.device.take_edges(pin(board, SDA))]
    return clocks.count(1), data


def changes(bits: list[int], before: int) -> list[int]:
    found: list[int] = []
    for bit in bits:
        if bit != before:
            found.append(bit)
        before = bit
    return found


def byte(value: int) -> list[int]:
    return [value >> (7 - i) & 1 for i in range(8)]


@given(st.binary(max_size=20), st.integers(0, 20), st.integers(0, 127))
def test_a_device_takes_and_gives_bytes(data, read, address):
    board = wired(address)
    board.simulated.force_switch("x", False)  # the device pulls: acknowledges, and gives zeros
    assert transfer(board, data, read) == ("SUCCESS", bytes(read))
    line: list[int] = []
    writes = bool(data) or read == 0
    if writes:
        for value in (address << 1, *data):
            line += [*byte(value), 1]
        line = [1, 0, *line]
    if read:
        line += [1, 0, *byte(address << 1 | 1), 1]
        line += [*[1] * 8, 0] * (read - 1) + [*[1] * 8, 1]
    line += [0, 1]
    pulses, levels = heard(board)
    assert levels == changes(line, 1)
    # Nine for each byte, one for the end, one for a start in the midst.
    sent = writes * (1 + len(data)) + (1 + read if read else 0)
    assert pulses == 9 * sent + 1 + (writes and read > 0)


@pytest.mark.parametrize(
    ("data", "read", "status"),
    [(b"", 0, "START_NACK"), (b"12", 0, "START_NACK"), (b"", 3, "START_READ_NACK")],
)
def test_no_device_answers(data, read, status):
    board = wired()
    board.simulated.force_switch("x", True)
    assert transfer(board, data, read) == (status, bytes(read))
    assert heard(board)[0] == 10


def test_an_answer_is_as_long_as_a_frame_takes():
    board = wired()
    board.simulated.force_switch("x", False)
    assert transfer(board, b"", 64) == ("SUCCESS", bytes(64 - 5 - 4))


def test_a_clock_that_stays_low_is_a_timeout():
    board = wired(scl=SDA, sda=SCL)
    board.simulated.force_switch("x", False)
    assert transfer(board, b"1", 2)[0] == "BUS_TIMEOUT"


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("i2c_transfer oid=0 write= read_len=0", "I2C device without a bus"),
        ("i2c_set_sw_bus oid=0 scl_pin=PH6 sda_pin=PE5 pulse_ticks=16001 address=1",
         "I2C clock too slow for this board"),
        ("i2c_set_sw_bus oid=1 scl_pin=PH6 sda_pin=PE5 pulse_ticks=1 address=1",
         "Invalid oid type"),
    ],
)  # fmt: skip
def test_misuse_shuts_the_board_down(line, fault):
    board = RawBoard()
    board.tell("allocate_oids count=2")
    board.tell("config_i2c oid=0")
    board.tell(line)
    assert board.device.fault == fault


def test_too_long_a_transfer_shuts_the_board_down():
    board = wired()
    board.tell("i2c_transfer oid=0 write= read_len=65")
    assert board.device.fault == "I2C data too large"
