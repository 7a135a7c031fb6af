"""The drivers' UART on a real chip's timers, with a motor turning beside it."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.oracles import trinamic
from tests.support.link_bench import Planner

from passo.board.configuration import Oids, uart_bit_ticks
from passo.board.description import BoardDescription, Driver, Stepper, UartPins
from passo.board.trinamic import DriverSettings

from .bench import Edge
from .boards import HZ, RAMPS_PINS, bench
from .host import AvrConnection

BIT = uart_bit_ticks(HZ)
WIRES = {"one wire": UartPins("^PH3", "PH3"), "two wires": UartPins("^PE3", "PH3")}


@pytest.fixture(params=WIRES)
def connection(request):
    wire = WIRES[request.param]
    chip = bench()
    driver = Driver("m0", wire, DriverSettings("TMC2209", 0.8, 0.4, 0.11))
    board = BoardDescription(HZ, (Stepper("m0", *RAMPS_PINS[0]),), drivers=(driver,))
    made = AvrConnection(board, chip)
    made.connect()
    chip.watch(["PH3"])
    yield made
    chip.close()


def turn(connection: AvrConnection) -> None:
    """20 000 steps a second for a while."""
    plan = Planner()
    plan.steps(0, True, HZ // 20_000, 20_000)
    connection.start_job(plan.queue)
    connection.run(connection.now + HZ // 3)


def send(connection: AvrConnection, data: bytes, read: int) -> list[Edge]:
    """The edges of the datagram, and only of that."""
    [oid] = Oids.of(connection.board).uarts.values()
    connection.bench.edges()
    bits = trinamic.packed(trinamic.line_bits(data)).hex()
    connection.command(f"tmcuart_send oid={oid} write={bits} read={read}")
    # Until the last bit is out, and the wire has not been turned around yet.
    edges: list[Edge] = []
    while len(edges) < expected_edges(data):
        connection.run(connection.now + BIT // 4)
        edges += connection.bench.edges()
    assert [edge.level for edge in edges] == [i % 2 for i in range(len(edges))]
    return edges


def expected_edges(data: bytes) -> int:
    return sum(a != b for a, b in pairwise([1, *trinamic.line_bits(data)]))


def measured(edges: list[Edge]) -> float:
    """A bit as a driver measures it: from the first to the third falling edge are four."""
    return (edges[4].cycle - edges[0].cycle) / 4


@pytest.mark.parametrize("turning", [False, True])
def test_each_bit_is_as_long_as_those_of_the_sync_nibble(connection, turning):
    if turning:
        turn(connection)
    data = trinamic.write_access(0, 0x6C, 0x14A3_55C3)
    changes = [i for i, (a, b) in enumerate(pairwise([1, *trinamic.line_bits(data)])) if a != b]
    for datagram in range(30):  # its edges and the steps meet anywhere
        connection.run(connection.now + HZ // 500 + 29 * datagram)
        edges = send(connection, data, 0)
        bit = measured(edges)
        assert bit == pytest.approx(BIT, rel=0.02)
        late = [(e.cycle - edges[0].cycle) / bit - at for e, at in zip(edges, changes, strict=True)]
        assert max(map(abs, late)) < 0.2  # 0.11 seen


@pytest.mark.parametrize("turning", [False, True])
def test_an_answer_is_read(connection, turning):
    if turning:
        turn(connection)
    chip, rx = connection.bench, connection.board.drivers[0].wire.rx_pin.lstrip("^")
    chip.set_pin(rx, True)
    data = trinamic.read_request(0, 0x6F)
    edges = send(connection, data, 10)
    bit = measured(edges)
    begin = edges[0].cycle + bit * (40 + 24)
    answer = trinamic.line_bits(trinamic.answer(0x6F, 0xC014_0003))
    for i, level in enumerate(answer):
        connection.run(int(begin + i * bit))
        chip.set_pin(rx, bool(level))
    connection.run(connection.now + HZ // 50)
    [(_, values)] = connection.take_responses("tmcuart_response")
    assert values["read"] == trinamic.packed(answer)
