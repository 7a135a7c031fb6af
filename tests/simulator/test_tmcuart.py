"""The drivers' UART of both kinds of board: the same answers at the same ticks."""

from __future__ import annotations

import pytest
from tests.oracles import trinamic
from tests.support.raw_board import RawBoard

from passo import _core

BIT = 400
REST = 200 * 16


def wired() -> tuple[RawBoard, _core.TrinamicChip]:
    board = RawBoard()
    pins = board.dictionary.enumerations["pin"]
    chip = _core.TrinamicChip(_core.TrinamicKind.TMC2209, 1)
    _core.add_uart_driver(board.device, pins["PE5"], pins["PB4"], chip)
    for line in (
        "allocate_oids count=1",
        f"config_tmcuart oid=0 rx_pin=PE5 pull_up=1 tx_pin=PB4 bit_time={BIT}",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
    return board, chip


def send(board: RawBoard, data: bytes, read: int) -> None:
    bits = trinamic.packed(trinamic.line_bits(data)).hex()
    assert board.tell(f"tmcuart_send oid=0 write={bits} read={read}") == []


def answered_after(board: RawBoard, ticks: int) -> bytes:
    assert board.wait(ticks - 1) == []
    [(name, values)] = board.wait(1)
    assert name == "tmcuart_response"
    return values["read"]


def test_a_write_is_done_with_its_last_bit():
    board, chip = wired()
    send(board, trinamic.write_access(1, 0x10, 0x81F0A), 0)
    assert answered_after(board, REST + 80 * BIT) == b""
    send(board, trinamic.read_request(1, 2), 10)  # whose first edge lets a real chip hear it
    board.wait(300 * BIT)
    assert chip.read(0x10) == 0x81F0A
    assert chip.read(2) == 1


# The driver waits for 8 bits, or by SENDDELAY 2 for 24.
@pytest.mark.parametrize(("delay", "bits"), [(0, 8), (2, 24), (3, 24), (15, 120)])
def test_an_answer_is_read_to_its_last_bit(delay, bits):
    board, chip = wired()
    chip.set(3, delay << 8)
    chip.set(0x6F, 0xC0140003)
    send(board, trinamic.read_request(1, 0x6F), 10)
    if bits > 64:  # longer than anybody waits
        assert answered_after(board, REST + (40 + 4 + 64) * BIT) == b""
        return
    answer = answered_after(board, REST + (40 + bits) * BIT + BIT // 4 + 79 * BIT)
    assert answer == trinamic.packed(trinamic.line_bits(trinamic.answer(0x6F, 0xC0140003)))


@pytest.mark.parametrize("wrong", ["address", "checksum", "unplugged"])
def test_without_an_answer_it_is_over_after_64_bits(wrong):
    board, chip = wired()
    data = trinamic.read_request(0 if wrong == "address" else 1, 0x6F)
    if wrong == "checksum":
        data = data[:3] + bytes([data[3] ^ 1])
    chip.plugged = wrong != "unplugged"
    send(board, data, 10)
    assert answered_after(board, REST + (40 + 4 + 64) * BIT) == b""


def test_a_shutdown_ends_an_exchange():
    board, _ = wired()
    send(board, trinamic.read_request(1, 0x6F), 10)
    board.wait(REST + 60 * BIT)
    board.tell("emergency_stop")
    assert board.wait(1000 * BIT) == []
    board.tell("clear_shutdown")
    send(board, trinamic.read_request(1, 0x6F), 10)
    assert answered_after(board, REST + (40 + 8) * BIT + BIT // 4 + 79 * BIT) != b""


def test_too_long_uart_transfer_is_refused():
    board, _ = wired()
    board.tell("tmcuart_send oid=0 write=00 read=11")
    assert board.device.fault == "tmcuart data too large"
