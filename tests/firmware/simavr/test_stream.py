"""Steps at high rates while commands arrive, a heater is pulsed and its sensor read."""

from __future__ import annotations

import pytest
from tests.support.link_bench import PID, TABLE, Planner

from passo import config
from passo.board.description import BoardDescription, Heater, Output, Sensor, Stepper
from passo.toolchain import avr, avr_wheel

from .bench import RISES
from .boards import HZ, RAMPS_PINS, bench
from .host import AvrConnection

HOTEND_CHANNEL = 13


def _live(count: int, make) -> AvrConnection:
    chip = bench(make=make)
    chip.set_voltage(HOTEND_CHANNEL, 2.5)
    steppers = (Stepper(f"m{i}", *pins) for i, pins in enumerate(RAMPS_PINS[:count]))
    description = BoardDescription(
        HZ,
        tuple(steppers),
        outputs=(
            Output("fan", "PH6", "digital", HZ // 100),
            Output("hotend", "PB4", "digital", HZ // 10, max_duration_ticks=3 * HZ),
        ),
        sensors=(Sensor("hotend", "PK5", TABLE, min_ratio=0.01, max_ratio=0.99),),
        heaters=(Heater("hotend", "hotend", "hotend", PID),),
    )
    connection = AvrConnection(description, chip)
    connection.connect()
    connection.set_target("hotend", 120.0)
    connection.switch("fan", True)
    return connection


def _budget(count: int) -> tuple[int, int]:
    """Ticks between a motor's steps and steps of a command at the rates that the planner gives this
    board, and a tenth more steps."""
    spec = config.load_board("ramps").budget_spec()
    assert spec
    steps_s = 1.1 * spec["steps_s"]
    return round(count * HZ / steps_s), int(steps_s / spec["commands_s"])


@pytest.mark.parametrize(
    ("count", "interval", "segment", "p99", "make"),
    [
        (3, 240, 250, 250, avr.build),
        (3, 240, 250, 250, avr_wheel.build),
        (3, 480, 60, 250, avr.build),
        (4, 400, 100, 400, avr.build),
        (3, *_budget(3), 250, avr.build),
        (4, *_budget(4), 400, avr.build),
    ],
    ids=["200k steps/s", "200k, packages", "100k steps/s", "four", "budget", "budget of four"],
)
def test_steps_are_on_time_with_everything_alive(count, interval, segment, p99, make):
    connection = _live(count, make)
    planner = Planner()
    for target in range(count):
        planner.steps(target, True, HZ // 4, 1)
    for _ in range(HZ // interval // segment):
        for target in range(count):
            planner.steps(target, True, interval, segment)
    chip = connection.bench
    pins = [step for step, _ in RAMPS_PINS[:count]]
    chip.watch(pins, RISES)
    rescued, siblings, sampled = chip.rescues, chip.siblings, chip.channels
    connection.start_job(planner.queue)
    edges = []
    end = connection.now + HZ + HZ * 3 // 4
    while connection.now < end:
        connection.run(connection.now + HZ // 10)
        edges += chip.edges()
    for target, pin in enumerate(pins):
        rises = [e.cycle for e in edges if e.pin == pin]
        clocks = planner.clocks[target]
        late = sorted(r - clock for r, clock in zip(rises, clocks, strict=True))
        assert late[len(late) * 99 // 100] - late[0] <= p99
        assert late[-1] - late[0] <= 1300  # by how it all falls together: 1102 seen
    assert connection.link.retransmitted_bytes < 20
    # What the bench makes up for was needed, or these figures would mean nothing.
    assert chip.rescues > rescued
    assert chip.siblings > siblings
    assert chip.channels > sampled
    assert chip.entries > count * HZ // interval
    chip.close()
