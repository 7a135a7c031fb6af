"""Every step at its time, with its direction, whatever the interval."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from random import Random

import pytest
from tests.support.link_bench import Planner

from passo.board.boards import Boards
from passo.board.description import BoardDescription, Endstop, Stepper
from passo.board.endstops import Endstops
from passo.errors import MachineError
from passo.toolchain.avr import AvrBoard

from .bench import Edge
from .boards import HZ, MELZI, MELZI_PINS, OTHER_PINS, RAMPS, RAMPS_PINS, bench, motors
from .host import AvrConnection

PULSE = 32


def _moves(random: Random, count: int) -> list[tuple[bool, int, int, int]]:
    """(forward, interval, count, add): short and long intervals, all kinds of ramps and lengths."""
    moves = []
    for _ in range(count):
        shape = random.randrange(5)
        if shape == 0:
            interval, steps = random.randrange(400, 3000), random.randrange(1, 700)
            add = random.randrange(-300 // steps, 300 // steps + 1)
        elif shape == 1:
            interval, steps = random.randrange(40_000, 2_000_000), random.randrange(1, 5)
            add = random.randrange(-8000, 8000)
        elif shape == 2:  # from short to long and back
            interval, steps, add = random.choice([(32_000, 6, 300), (34_000, 9, -400)])
        elif shape == 3:  # whole pieces, and one tick beside them
            interval, add = random.choice([32767, 32768, 32769, 65536, 98304]), 0
            steps = random.randrange(1, 4)
        else:
            interval, steps = random.choice([1000, 1500]), random.choice([255, 256, 257, 512, 513])
            add = 0
        moves.append((random.random() < 0.5, interval, steps, add))
    return moves


def _check(edges: Sequence[Edge], pins: tuple[str, str], planner: Planner, target: int) -> int:
    """Counts, directions, pulses and set-up are exact; returns by how much lateness varies."""
    _step, direction = pins
    mine = [e for e in edges if e.pin in pins]
    level, turned, rises, directions, fell = 0, -HZ, [], [], -HZ
    for e in mine:
        if e.pin == direction:
            assert e.cycle >= fell  # not within a pulse
            level, turned = e.level, e.cycle
        elif e.level:
            assert e.cycle - fell >= 17
            assert e.cycle - turned >= 40
            rises.append(e.cycle)
            directions.append(1 if level else -1)
        else:
            assert e.cycle - rises[-1] >= PULSE
            fell = e.cycle
    assert directions == planner.directions[target]
    late = [cycle - clock for cycle, clock in zip(rises, planner.clocks[target], strict=True)]
    return max(late) - min(late)


@pytest.mark.parametrize(
    ("board", "pins"),
    [(RAMPS, RAMPS_PINS), (MELZI, MELZI_PINS), (RAMPS, OTHER_PINS)],
    ids=["2560", "1284P", "free pins"],
)
def test_steps_of_every_kind_come_on_time(board, pins):
    connection = motors(2, board, pins)
    connection.bench.watch(direction for _, direction in pins[:2])
    random = Random(7)
    # The second motor walks on alone when the first is done; the queue is sorted by clock.
    planner = Planner()
    planned: list[tuple[int, tuple[bool, int, int, int]]] = []
    for target, count in ((0, 120), (1, 160)):
        planned += [(target, move) for move in _moves(random, count)]
    now = [HZ // 4, HZ // 4]
    todo = [[move for t, move in planned if t == target] for target in (0, 1)]
    for target in (0, 1):
        planner.steps(target, True, HZ // 4 + 1000 * target, 1)
    while todo[0] or todo[1]:
        target = 0 if todo[0] and (not todo[1] or now[0] <= now[1]) else 1
        planner.steps(target, *todo[target].pop(0))
        now[target] = planner.clocks[target][-1]
    connection.start_job(planner.queue)
    edges = []
    while connection.now < max(now) + 2 * HZ:
        connection.run(connection.now + HZ // 10)
        edges += connection.bench.edges()
    assert _check(edges, pins[0], planner, 0) < 450
    assert _check(edges, pins[1], planner, 1) < 450
    for name, target in (("m0", 0), ("m1", 1)):
        assert connection.net_steps(name) == sum(planner.directions[target])
    connection.bench.close()


@pytest.mark.parametrize("pulse_ticks", [39, 80])
def test_longer_pulses_take_a_free_unit(pulse_ticks):
    connection = motors(1, pulse_ticks=pulse_ticks)
    planner = Planner()
    planner.steps(0, True, HZ // 4, 1)
    planner.steps(0, True, 2000, 500, 3)
    connection.start_job(planner.queue)
    connection.run(connection.now + HZ)
    edges = connection.bench.edges()
    widths = {b.cycle - a.cycle for a, b in zip(edges[::2], edges[1::2], strict=True)}
    assert len(edges) == 2 * 501
    assert min(widths) >= pulse_ticks
    assert max(widths) < pulse_ticks + 120
    connection.bench.close()


@pytest.mark.parametrize(
    ("board", "pins", "pulse_ticks", "interval"),
    [(RAMPS, RAMPS_PINS, 48, 1000), (MELZI, MELZI_PINS, 480, 6000)],  # TB6600, TB6560
)
def test_an_image_may_have_long_pulses_for_all_its_motors(board, pins, pulse_ticks, interval):
    slow = AvrBoard(board.mcu, slow_motors=len(pins))
    connection = motors(len(pins), slow, pins, pulse_ticks)
    planner = Planner()
    for target in range(len(pins)):
        planner.steps(target, True, HZ // 4, 1)
        planner.steps(target, True, interval, 200)
    connection.start_job(planner.queue)
    connection.run(connection.now + HZ)
    edges = connection.bench.edges()
    for step, _ in pins:
        mine = [e.cycle for e in edges if e.pin == step]
        widths = [b - a for a, b in zip(mine[::2], mine[1::2], strict=True)]
        assert len(widths) == 201
        assert pulse_ticks <= min(widths) <= max(widths) < pulse_ticks + 120
    connection.bench.close()


def test_long_pulses_of_colliding_motors_are_2_us_apart():
    connection = motors(3, pins=OTHER_PINS, pulse_ticks=80)
    planner = Planner()
    for target in range(3):
        planner.steps(target, True, HZ // 4, 1)
    for _ in range(50):
        for target in range(3):
            planner.steps(target, True, 200, 3)
        for target in range(3):
            planner.steps(target, True, 3000, 1)
    connection.start_job(planner.queue)
    connection.run(connection.now + HZ)
    edges = connection.bench.edges()
    for step, _ in OTHER_PINS:
        mine = [e.cycle for e in edges if e.pin == step]
        assert len(mine) == 2 * 201
        assert min(b - a for a, b in zip(mine[::2], mine[1::2], strict=True)) >= 80
        assert min(b - a for a, b in pairwise(mine)) >= HZ * 2e-6
    connection.bench.close()


def test_the_position_is_known_between_steps():
    connection = motors(1)
    carriage = connection.bench.add_carriage(*RAMPS_PINS[0])
    planner = Planner()
    planner.steps(0, True, HZ // 4, 1)
    for k in range(30):
        planner.steps(0, k % 7 != 3, 700 + 37 * k, 300 - 7 * k)
        planner.steps(0, k % 5 != 1, 45_000, 3, -9_000)
    connection.start_job(planner.queue)
    connection.run(connection.now + HZ // 3)
    for _ in range(40):
        before = connection.bench.position(carriage)
        told = connection.net_steps("m0")
        after = connection.bench.position(carriage)
        assert abs(told - before) <= abs(after - before) + 20
        connection.run(connection.now + HZ // 50)
    connection.run(connection.now + HZ)
    assert connection.net_steps("m0") == connection.bench.position(carriage)
    assert connection.bench.position(carriage) == sum(planner.directions[0])
    connection.bench.close()


def test_the_position_is_known_where_256_steps_are_left():
    """For 2 ms, of which the question hits some."""
    connection = motors(1)
    carriage = connection.bench.add_carriage(*RAMPS_PINS[0])
    connection.command("set_next_step_dir oid=0 dir=1")
    for ms in range(6):
        clock = connection.link.clock_at(connection.now) + HZ // 20
        connection.command(f"reset_step_clock oid=0 clock={clock & 0xFFFFFFFF}")
        connection.command("queue_step oid=0 interval=32000 count=257 add=-120")
        connection.run(connection.now + HZ // 20 + ms * HZ // 1000)
        before = connection.bench.position(carriage)
        told = connection.net_steps("m0")
        assert before <= told <= connection.bench.position(carriage)
        connection.run(connection.now + HZ // 3)
        assert connection.bench.position(carriage) == 257 * (ms + 1)
    connection.bench.close()


@pytest.mark.parametrize("way", [1, -1])
def test_motor_stopped_before_turn_keeps_position_and_direction(way):
    chip = bench()
    steppers = (Stepper("m0", *RAMPS_PINS[0], pulse_ticks=PULSE),)
    description = BoardDescription(HZ, steppers, endstops=(Endstop("a", "^PE4"),))
    connection = AvrConnection(description, chip)
    connection.connect()
    chip.set_pin("PE4", False)
    carriage = chip.add_carriage(*RAMPS_PINS[0])
    planner = Planner()
    planner.steps(0, True, HZ // 4, 1)
    planner.steps(0, True, 3000, 1000)
    planner.steps(0, False, 3000, 1000)
    connection.start_job(planner.queue)
    connection.run(connection.now + HZ // 4)
    Endstops(Boards([connection])).arm({"a": ["m0"]}, connection.now + HZ // 100, 1e-3)
    while chip.position(carriage) < 700:  # the board knows of the turn
        connection.run(connection.now + HZ // 1000)
    chip.set_pin("PE4", True)
    connection.run(connection.now + HZ // 100)
    connection.link.stop_job()
    stopped = chip.position(carriage)
    assert 700 <= stopped < 800
    assert connection.net_steps("m0") == stopped
    clock = connection.link.clock_at(connection.now) + HZ // 10
    connection.command(f"set_next_step_dir oid=0 dir={int(way > 0)}")
    connection.command(f"reset_step_clock oid=0 clock={clock & 0xFFFFFFFF}")
    connection.command("queue_step oid=0 interval=5000 count=20 add=0")
    connection.run(connection.now + HZ // 5)
    assert chip.position(carriage) == connection.net_steps("m0") == stopped + 20 * way
    chip.close()


def _start(ahead: int) -> int | str:
    """A lone step due `ahead` ticks after its command is sent: how late it comes, to a constant, or
    what the board says if it refuses."""
    connection = motors(1)
    clock = connection.link.clock_at(connection.now)
    connection.command(f"reset_step_clock oid=0 clock={clock % 2**32}")
    connection.command(f"queue_step oid=0 interval={ahead} count=1 add=0")
    try:
        connection.run(connection.now + HZ // 50)
    except MachineError as error:
        return str(error)
    finally:
        edges = connection.bench.edges()
        connection.bench.close()
    return edges[0].cycle - clock - ahead


def test_a_start_at_the_last_moment_is_on_time_or_refused():
    refused, made = 1000, HZ // 100
    normal = _start(made)
    assert isinstance(normal, int)
    assert isinstance(_start(refused), str)
    while made - refused > 1:
        middle = (refused + made) // 2
        if isinstance(_start(middle), str):
            refused = middle
        else:
            made = middle
    assert "Timer too close" in str(_start(refused))  # some ticks ahead, not enough
    for ahead in (made, made + 1, made + 7, made + 40):
        late = _start(ahead)
        assert isinstance(late, int)
        assert late - normal < 100
