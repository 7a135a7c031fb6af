"""Cycles of the step interrupt: a step's cost, and the highest rates that are kept up."""

from __future__ import annotations

import itertools

import pytest

from .bench import NOTHING
from .boards import HZ, MELZI, MELZI_PINS, OTHER_PINS, RAMPS, RAMPS_PINS, motors

LEAD = HZ // 10
SETTLED = 256


def _begin(connection, count, interval, steps):
    """All motors from the same tick on; returns 6 ms before the first step."""
    start = connection.link.clock_at(connection.now) + LEAD
    for oid in range(count):
        connection.command(f"reset_step_clock oid={oid} clock={start % 2**32}")
        left = steps
        while left > 0:
            part = min(left, 60_000)
            connection.command(f"queue_step oid={oid} interval={interval} count={part} add=0")
            left -= part
    connection.run(connection.now + LEAD - HZ // 160)


@pytest.mark.parametrize(
    ("board", "pins", "budget"),
    [(RAMPS, RAMPS_PINS, 57), (MELZI, MELZI_PINS, 55), (RAMPS, OTHER_PINS, 74)],
    ids=["2560", "1284P", "free pins"],
)
def test_a_step_costs_no_more_cycles_than_its_budget(board, pins, budget):
    connection = motors(3, board, pins)
    chip = connection.bench
    chip.watch((step for step, _ in pins[:3]), NOTHING)
    idle = chip.interrupt_cycles
    chip.run_for(HZ)
    idle = chip.interrupt_cycles - idle
    connection.pump.now = chip.cycle
    _begin(connection, 3, 1000, 20_000)
    chip.run_for(HZ // 100)
    busy, steps = chip.interrupt_cycles, sum(chip.rises(step) for step, _ in pins[:3])
    chip.run_for(HZ)
    busy = chip.interrupt_cycles - busy
    steps = sum(chip.rises(step) for step, _ in pins[:3]) - steps
    assert steps == pytest.approx(48_000, abs=3)
    assert budget - 2 < (busy - idle) / steps <= budget
    chip.close()


@pytest.mark.parametrize(
    ("board", "pins", "count", "interval"),
    [
        (RAMPS, RAMPS_PINS, 1, 60),
        (RAMPS, RAMPS_PINS, 3, 180),
        (RAMPS, RAMPS_PINS, 4, 240),
        (MELZI, MELZI_PINS, 1, 60),
        (MELZI, MELZI_PINS, 3, 180),
        (MELZI, MELZI_PINS, 4, 240),
        (RAMPS, OTHER_PINS, 3, 240),
    ],
)
def test_the_highest_rates_are_kept_up(board, pins, count, interval):
    steps = 6000
    connection = motors(count, board, pins)
    _begin(connection, count, interval, steps)
    connection.bench.run_for(steps * interval + HZ // 100)
    edges = connection.bench.edges()
    for step, _ in pins[:count]:
        rises = [e.cycle for e in edges if e.pin == step and e.level]
        assert len(rises) == steps
        first, last = sum(rises[SETTLED : 2 * SETTLED]), sum(rises[-SETTLED:])
        mean = (last - first) / SETTLED / (steps - 2 * SETTLED)
        assert mean == pytest.approx(interval, abs=0.01)
        late = [cycle - i * interval for i, cycle in enumerate(rises)]
        assert max(late) - min(late) < 1800  # by where the link's bytes fall: 1143 to 1606
    widths = [b.cycle - a.cycle for a, b in itertools.pairwise(edges) if a.pin == b.pin]
    assert min(widths) >= 17
    connection.bench.close()
