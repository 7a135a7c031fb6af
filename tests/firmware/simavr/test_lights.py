"""The wire of a chain of lights on a real chip, while motors turn beside it."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.support.link_bench import Planner

from passo.board.configuration import Oids
from passo.board.description import BoardDescription, Light, Stepper

from .bench import Edge
from .boards import HZ, RAMPS_PINS, bench
from .host import AvrConnection

US = HZ / 1e6
FRAME = bytes((0x00, 0xFF, 0xA5, 0x5A, 0x81, 0x7E, 0x01, 0x80, 0xC3))
LONG = FRAME * 25  # 75 LEDs


@pytest.fixture(params=[FRAME, LONG], ids=["3 LEDs", "75 LEDs"])
def case(request):
    chip, frame = bench(), request.param
    light = Light("head", "PH3", len(frame))
    made = AvrConnection(
        BoardDescription(HZ, (Stepper("m0", *RAMPS_PINS[0]),), lights=(light,)), chip
    )
    made.connect()
    chip.watch(["PH3"])
    yield made, frame
    chip.close()


def update(connection: AvrConnection, frame: bytes) -> None:
    [oid] = Oids.of(connection.board).chains.values()
    for i in range(0, len(frame), 40):
        data = frame[i : i + 40].hex()
        connection.command(f"neopixel_update oid={oid} pos={i} data={data}")
    connection.run(connection.now + HZ // 20)


def send(connection: AvrConnection) -> tuple[list[Edge], bool]:
    """The edges of a frame, and whether the board has reported success."""
    [oid] = Oids.of(connection.board).chains.values()
    connection.bench.edges()
    answer = connection.ask(f"neopixel_send oid={oid}", "neopixel_result")
    return connection.bench.edges(), bool(answer["success"])


def pulses_us(edges: list[Edge]) -> list[float]:
    return [(b.cycle - a.cycle) / US for a, b in zip(edges[::2], edges[1::2], strict=True)]


def bits_us(edges: list[Edge]) -> list[float]:
    return [(b.cycle - a.cycle) / US for a, b in pairwise(edges[::2])]


def decoded(edges: list[Edge]) -> bytes:
    bits = "".join("1" if us > 0.6 else "0" for us in pulses_us(edges))
    return int(bits, 2).to_bytes(len(bits) // 8, "big")


def test_pulses_have_the_lengths_of_the_lights(case):
    connection, frame = case
    update(connection, frame)
    edges, success = send(connection)
    assert success
    assert decoded(edges) == frame
    zeros = [us for us in pulses_us(edges) if us < 0.6]
    ones = [us for us in pulses_us(edges) if us >= 0.6]
    assert 0.2 <= min(zeros) <= max(zeros) <= 0.5
    assert 0.75 <= min(ones) <= max(ones) <= 1.2
    assert min(bits_us(edges)) >= 1.2
    assert sorted(bits_us(edges))[int(0.99 * len(edges) / 2) - 2] <= 4.0  # the others: interrupts


def test_frames_are_whole_while_a_motor_turns(case):
    connection, frame = case
    update(connection, frame)
    plan = Planner()
    plan.steps(0, True, HZ // 20_000, 40_000)
    connection.start_job(plan.queue)
    connection.run(connection.now + HZ // 3)
    for i in range(8):
        connection.run(connection.now + HZ // 50 + 31 * i)
        edges, success = send(connection)
        assert success
        assert decoded(edges) == frame
        assert max(us for us in pulses_us(edges) if us < 0.6) <= 0.5
        assert max(pulses_us(edges)) <= 1.2
        assert max(bits_us(edges)) <= 40  # 24 seen


def test_steps_are_not_late_while_a_frame_is_sent(case):
    connection, frame = case
    update(connection, frame)
    chip, plan = connection.bench, Planner()
    chip.watch([RAMPS_PINS[0][0]])
    plan.steps(0, True, HZ // 10_000, 4000)
    connection.start_job(plan.queue)
    connection.run(connection.now + HZ // 3)
    [oid] = Oids.of(connection.board).chains.values()
    longest: list[int] = []
    for sends in (False, True):
        chip.edges()
        if sends:
            connection.command(f"neopixel_send oid={oid}")
        connection.run(connection.now + HZ // 20)
        rises = [edge.cycle for edge in chip.edges() if edge.level]
        assert len(rises) >= 450
        longest.append(max(b - a for a, b in pairwise(rises)))
    assert longest[1] - longest[0] <= 2 * US  # interrupts are off for 1.75 µs
