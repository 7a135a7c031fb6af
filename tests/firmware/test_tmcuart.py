"""The UART of motor drivers by software: its levels in time, and a driver's answers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.oracles import trinamic
from tests.support.raw_board import RawBoard

from passo import _core

BIT = 400
REST = 200 * 16
ONE_WIRE = ("PE5", "PE5")
TWO_WIRES = ("PE5", "PB4")
KIND = _core.TrinamicKind.TMC2209


def pin(board: RawBoard, name: str) -> int:
    return board.dictionary.enumerations["pin"][name]


def wired(wires: tuple[str, str] = TWO_WIRES, bit: int = BIT) -> tuple[RawBoard, list]:
    """Four drivers, addresses 0 to 3, on one UART."""
    board = RawBoard()
    rx, tx = wires
    chips = [_core.TrinamicChip(KIND, address) for address in range(4)]
    for chip in chips:
        _core.add_uart_driver(board.device, pin(board, rx), pin(board, tx), chip)
    for line in (
        "allocate_oids count=1",
        f"config_tmcuart oid=0 rx_pin={rx} pull_up=1 tx_pin={tx} bit_time={bit}",
        "finalize_config crc=1",
    ):
        assert board.tell(line) == []
    board.device.trace_edges(pin(board, tx))
    return board, chips


def asked(board: RawBoard, data: bytes, read: int, bit: int = BIT) -> tuple[bytes, int]:
    """The bits that came back, and after how many ticks."""
    began = board.now
    write = trinamic.packed(trinamic.line_bits(data)).hex()
    assert board.tell(f"tmcuart_send oid=0 write={write} read={read}") == []
    for _ in range(200):
        for name, values in board.wait(bit):
            assert (name, values["oid"]) == ("tmcuart_response", 0)
            return values["read"], board.now - began
    raise AssertionError("no answer")


@pytest.mark.parametrize("wires", [ONE_WIRE, TWO_WIRES])
@given(st.binary(min_size=1, max_size=8))
def test_the_line_has_each_bit_for_its_time(wires, data):
    board, _ = wired(wires)
    bits = trinamic.line_bits(data)
    start = board.now + REST
    whole = trinamic.packed([*bits, *[1] * (-len(bits) % 8)])
    board.tell(f"tmcuart_send oid=0 write={whole.hex()} read=0")
    board.wait(REST + BIT * 8 * len(whole))
    level, expected = 1, []
    for i, bit in enumerate(bits):
        if bit != level:
            expected.append((start + i * BIT, bit))
        level = bit
    assert board.device.take_edges(pin(board, wires[1])) == expected


@pytest.mark.parametrize("wires", [ONE_WIRE, TWO_WIRES])
@pytest.mark.parametrize("bit", [400, 444, 1776, 1777])
def test_registers_of_each_driver_are_written_and_read(wires, bit):
    board, chips = wired(wires, bit)
    for address, chip in enumerate(chips):
        value = 0x10000053 + address
        assert asked(board, trinamic.write_access(address, 0x6C, value), 0, bit)[0] == b""
        answer, _ = asked(board, trinamic.read_request(address, 0x6C), 10, bit)
        assert answer == trinamic.packed(trinamic.line_bits(trinamic.answer(0x6C, value)))
        assert chip.read(0x6C) == value
        assert chip.read(2) == 1  # IFCNT


def test_an_answer_comes_when_its_bits_are_over():
    board, _ = wired()
    _, ticks = asked(board, trinamic.read_request(0, 2), 10)
    # Rest, question, the driver's delay, the search for the start bit, 79 bits after its first.
    assert ticks == pytest.approx(REST + BIT * (40 + 8 + 0.25 + 79), abs=BIT)


def test_no_device_answers():
    board, chips = wired()
    chips[2].plugged = False
    answer, ticks = asked(board, trinamic.read_request(2, 2), 10)
    assert answer == b""
    assert ticks == pytest.approx(REST + BIT * (40 + 68), abs=BIT)


def test_a_line_that_is_always_low_is_not_an_answer():
    board = RawBoard()
    for line in (
        "allocate_oids count=1",
        f"config_tmcuart oid=0 rx_pin=PE5 pull_up=1 tx_pin=PB4 bit_time={BIT}",
        "finalize_config crc=1",
    ):
        board.tell(line)
    board.simulated.force_switch("x", False)
    answer, ticks = asked(board, trinamic.read_request(0, 2), 10)
    assert answer == b""
    assert ticks == pytest.approx(REST + BIT * (40 + 68), abs=BIT)


def test_a_busy_line_drops_what_else_is_sent():
    board, chips = wired()
    write = trinamic.packed(trinamic.line_bits(trinamic.write_access(0, 0x10, 5))).hex()
    for _ in range(3):
        assert board.tell(f"tmcuart_send oid=0 write={write} read=0") == []
    assert [name for name, _ in board.wait(200 * BIT)] == ["tmcuart_response"]
    asked(board, trinamic.read_request(0, 2), 10)
    assert chips[0].read(2) == 1


def test_uart_line_is_idle_after_shutdown():
    board, _ = wired()
    board.tell(f"tmcuart_send oid=0 write={'00' * 10} read=0")
    board.wait(REST + 3 * BIT)
    board.tell("emergency_stop")
    board.wait(100 * BIT)
    assert [level for _, level in board.device.take_edges(pin(board, "PB4"))] == [0, 1]


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        (f"tmcuart_send oid=0 write={'00' * 11} read=0", "tmcuart data too large"),
        ("tmcuart_send oid=0 write=00 read=11", "tmcuart data too large"),
        ("config_tmcuart oid=1 rx_pin=PE5 pull_up=0 tx_pin=PE5 bit_time=99",
         "Pins cannot make a driver's UART"),
    ],
)  # fmt: skip
def test_misuse_shuts_the_board_down(line, fault):
    board = RawBoard()
    board.tell("allocate_oids count=2")
    board.tell("config_tmcuart oid=0 rx_pin=PE5 pull_up=1 tx_pin=PE5 bit_time=400")
    board.tell(line)
    assert board.device.fault == fault


@pytest.mark.parametrize(("beyond", "bit_time"), [(65536, BIT), (0, 1)])
def test_a_line_that_is_refused_moves_no_pin(beyond, bit_time):
    """Nor does the shutdown that follows, which lets all lines rest."""
    board = RawBoard()
    board.tell("allocate_oids count=2")
    board.tell("config_digital_out oid=1 pin=PB4 value=0 default_value=0 max_duration=2000")
    heater = pin(board, "PB4")
    board.device.trace_edges(heater)
    line = [heater + beyond, 1, heater + beyond, bit_time]
    board.feed(board.commands.encode("config_tmcuart", [0, *line]))
    assert board.device.fault == "Pins cannot make a driver's UART"
    assert [level for _, level in board.device.take_edges(heater) if level] == []
