"""The host's code prints, homes and heats with the simulated chip."""

from __future__ import annotations

import pytest
from tests.support.link_bench import TABLE, Planner

from passo import _core
from passo.board.boards import Boards
from passo.board.description import BoardDescription, Endstop, Heater, Output, Sensor, Stepper
from passo.board.endstops import Endstops
from passo.errors import MachineError

from .boards import HZ, RAMPS_PINS, bench
from .host import AvrConnection, Hotend

CONTROL = _core.PidControl(kp=7.65, ki=3.825, kd=0.0)


def _heated(control: _core.PidControl | None = CONTROL) -> tuple[AvrConnection, Hotend]:
    chip = bench()
    sensor = Sensor("hotend", "PK5", TABLE, min_ratio=0.01, max_ratio=0.99)
    description = BoardDescription(
        HZ,
        outputs=(Output("hotend", "PB4", "digital", HZ // 10, max_duration_ticks=3 * HZ),),
        sensors=(sensor,),
        heaters=(Heater("hotend", "hotend", "hotend", control),) if control else (),
    )
    chip.set_voltage(13, 4.75)
    connection = AvrConnection(description, chip)
    connection.connect()
    hotend = Hotend(chip, "PB4", 13, sensor)
    connection.pump.world.append(hotend)
    return connection, hotend


def test_a_heater_reaches_its_target_and_stays_there():
    connection, hotend = _heated()
    connection.set_target("hotend", 100.0)
    connection.run(connection.now + 20 * HZ)
    highest = lowest = hotend.celsius
    for _ in range(20):
        connection.run(connection.now + HZ // 4)
        highest, lowest = max(highest, hotend.celsius), min(lowest, hotend.celsius)
    assert 98 < lowest < highest < 102
    assert abs(connection.heaters["hotend"].celsius - hotend.celsius) < 1
    connection.set_target("hotend", 0.0)
    connection.run(connection.now + HZ)
    before = connection.bench.high_cycles("PB4")
    connection.run(connection.now + HZ)
    assert connection.bench.high_cycles("PB4") == before


def test_a_silent_host_leaves_no_heater_on():
    connection, _ = _heated()
    connection.set_target("hotend", 200.0)
    connection.run(connection.now + 2 * HZ)
    assert connection.bench.high_cycles("PB4") > HZ
    connection.bench.run_for(4 * HZ)
    before = connection.bench.high_cycles("PB4")
    connection.bench.run_for(HZ)
    assert connection.bench.high_cycles("PB4") == before
    assert connection.bench.level("PB4") == 0


def test_a_broken_sensor_shuts_the_board_down():
    connection, _ = _heated(control=None)  # the host does not look
    connection.pump.world.clear()
    connection.bench.set_voltage(13, 5.0)
    with pytest.raises(MachineError, match="ADC out of range"):
        connection.run(connection.now + 3 * HZ)


def test_a_switch_stops_its_motor_where_it_is():
    chip = bench()
    description = BoardDescription(
        HZ,
        (Stepper("x", *RAMPS_PINS[0]), Stepper("y", *RAMPS_PINS[1])),
        endstops=(Endstop("x", "^PE5"),),
    )
    connection = AvrConnection(description, chip)
    x = chip.add_carriage(*RAMPS_PINS[0], 3000, "PE5")
    y = chip.add_carriage(*RAMPS_PINS[1])
    connection.connect()
    endstops = Endstops(Boards([connection]))
    assert not endstops.pressed("x")
    planner = Planner()
    for target, forward in ((0, False), (1, True)):
        planner.steps(target, forward, HZ // 4, 1)
    for _ in range(100):
        planner.steps(0, False, 5000, 40)
        planner.steps(1, True, 5000, 40)
    base = connection.start_job(planner.queue)
    endstops.arm({"x": ["x"]}, base + HZ // 8, 0.001)
    connection.run(connection.now + 2 * HZ)
    assert endstops.all_hit()
    # 1 ms between looks and three samples more: four steps at most.
    assert -6 <= chip.position(x) <= -1
    assert connection.net_steps("x") == chip.position(x) - 3000
    assert endstops.pressed("x")
    assert connection.net_steps("y") == chip.position(y) == 4001
    endstops.disarm()
    connection.link.stop_job()
    connection.run(connection.now + HZ // 10)
    # It moves again from where it is.
    again = Planner()
    again.steps(0, True, HZ // 4, 1)
    again.steps(0, True, 2000, 499)
    connection.start_job(again.queue)
    stopped = chip.position(x)
    connection.run(connection.now + HZ)
    assert chip.position(x) == stopped + 500
    assert connection.net_steps("x") == chip.position(x) - 3000
    assert not endstops.pressed("x")
