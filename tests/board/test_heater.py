"""Heater loops beside the link, over the wire, on simulated heat."""

from __future__ import annotations

from dataclasses import replace

import pytest
from tests.support.link_bench import HZ, Bench, description

from passo import _core
from passo.board.faults import FaultKind
from passo.errors import MachineError


@pytest.mark.parametrize("pwm", [False, True])
def test_pid_reaches_and_holds_its_target(pwm):
    bench = Bench(description(pwm=pwm))
    c = bench.connection
    c.set_target("hotend", 200.0)
    before = c.now
    assert c.run(before + 600 * HZ, until_heaters=True)
    assert 60 < (c.now - before) / HZ < 150
    assert bench.simulated.temperature("hotend") == pytest.approx(200, abs=4)
    bench.run(120.0)
    c.heaters["hotend"].take_samples()
    for _ in range(20):
        bench.run(5.0)
        assert bench.simulated.temperature("hotend") == pytest.approx(200, abs=1)
        assert c.heaters["hotend"].celsius == pytest.approx(200, abs=1)
    powers = [sample.power for sample in c.heaters["hotend"].take_samples()]
    assert len(powers) == 400
    assert sum(powers) / len(powers) == pytest.approx(175 / 300, abs=0.01)


def test_on_off_control_stays_around_its_target():
    bench = Bench(description(control=_core.OnOffControl(1.0)))
    c = bench.connection
    c.set_target("hotend", 150.0)
    assert c.run(c.now + 600 * HZ, until_heaters=True)
    bench.run(60.0)
    seen = []
    for _ in range(100):
        bench.run(1.0)
        seen.append(c.heaters["hotend"].celsius)
        assert c.heaters["hotend"].power in (0.0, 1.0)
    assert 140 < min(seen) < 149.5 < 150.5 < max(seen) < 160


def test_a_target_of_zero_turns_the_output_off():
    bench = Bench()
    c = bench.connection
    c.set_target("hotend", 100.0)
    bench.run(5.0)
    assert bench.simulated.output_value("hotend") == HZ // 10
    c.set_target("hotend", 0.0)
    bench.run(1.0)
    assert bench.simulated.output_value("hotend") == 0
    assert c.heaters["hotend"].power == 0.0
    assert not c.heaters["hotend"].reached


@pytest.mark.parametrize("target", [-5.0, float("nan")])
def test_target_that_is_not_a_number_is_off(target):
    bench = Bench()
    bench.connection.set_target("hotend", 100.0)
    bench.run(2.0)
    bench.connection.set_target("hotend", target)
    bench.run(1.0)
    assert bench.connection.heaters["hotend"].target == 0.0
    assert bench.simulated.output_value("hotend") == 0


def test_new_target_counts_as_not_reached():
    bench = Bench()
    c = bench.connection
    c.set_target("hotend", 60.0)
    assert c.run(c.now + 100 * HZ, until_heaters=True)
    c.set_target("hotend", 80.0)
    assert not c.heaters["hotend"].reached
    assert not c.run(c.now + HZ, until_heaters=True)


def test_wait_without_target_ends_at_once():
    bench = Bench()
    before = bench.connection.now
    assert bench.connection.run(before + HZ, until_heaters=True)
    assert bench.connection.now == before


@pytest.mark.parametrize("target", [0.0, 200.0])
@pytest.mark.parametrize(
    ("ratio", "kind"), [(0.0, FaultKind.SENSOR_SHORT), (1.0, FaultKind.SENSOR_OPEN)]
)
def test_a_broken_sensor_is_a_fault_within_a_second(ratio, kind, target):
    bench = Bench()
    c = bench.connection
    c.on_fault = lambda name, fault: events.append((name, fault))
    events = []
    c.set_target("hotend", target)
    bench.run(10.1)  # between two sums of samples
    assert (bench.simulated.output_value("hotend") > 0) == (target > 0)
    bench.simulated.force_sensor("hotend", ratio)
    before = c.now
    bench.run(0.95)
    [(name, fault)] = events
    assert (name, fault.heater, fault.kind) == ("hotend", "hotend", kind)
    assert fault.clock - before < 0.8 * HZ
    assert bench.simulated.output_value("hotend") == 0
    assert c.heaters["hotend"].target == target
    bench.run(20.0)
    assert c.faults == [fault]
    assert bench.simulated.output_value("hotend") == 0


def test_fault_without_listener_is_raised():
    bench = Bench()
    bench.simulated.force_sensor("hotend", 1.0)
    with pytest.raises(MachineError, match="means a broken cable"):
        bench.run(1.0)


def test_board_switches_heater_off_without_host_protections():
    bench = Bench()
    bench.connection.set_target("hotend", 200.0)
    bench.run(10.0)
    silence = bench.connection.now
    bench.simulated.force_sensor("hotend", 1.0)
    bench.device.poll(silence + 2 * HZ)
    assert bench.device.fault == "ADC out of range"
    assert bench.simulated.output_value("hotend") == 0


def test_a_board_without_a_host_switches_its_heater_off():
    bench = Bench()
    bench.connection.set_target("hotend", 200.0)
    bench.run(10.0)
    silence = bench.connection.now
    assert bench.simulated.output_value("hotend") > 0
    bench.device.poll(silence + 4 * HZ)
    assert bench.device.fault == "Missed scheduling of next digital out event"
    assert bench.simulated.output_value("hotend") == 0
    hot = bench.simulated.temperature("hotend")
    bench.device.poll(silence + 104 * HZ)
    assert bench.simulated.temperature("hotend") == pytest.approx(25 + (hot - 25) / 2.718, abs=1)


@pytest.mark.parametrize("pwm", [False, True])
def test_active_low_output_heats_in_the_same_way(pwm):
    plain = description(pwm=pwm)
    fan, heat, *others = plain.outputs
    low = replace(plain, outputs=(fan, replace(heat, pin="!PB4"), *others))
    values, temperatures = [], []
    for board in (plain, low):
        bench = Bench(board)
        assert bench.simulated.temperature("hotend") == 25.0
        bench.connection.set_target("hotend", 200.0)
        bench.run(10.0)
        values.append(bench.simulated.output_value("hotend"))
        temperatures.append(bench.simulated.temperature("hotend"))
        bench.connection.set_target("hotend", 0.0)
        bench.run(3.0)
        values.append(bench.simulated.output_value("hotend"))
    full = 255 if pwm else HZ // 10
    assert values == [full, 0, 0, full]
    assert temperatures[0] == temperatures[1] > 40


def test_active_low_output_is_off_after_shutdown():
    plain = description()
    fan, heat, *others = plain.outputs
    bench = Bench(replace(plain, outputs=(fan, replace(heat, pin="!PB4"), *others)))
    bench.connection.set_target("hotend", 200.0)
    bench.run(5.0)
    assert bench.simulated.output_value("hotend") == 0
    with pytest.raises(MachineError):
        bench.connection.command("emergency_stop")
        bench.run(1.0)
    assert bench.simulated.output_value("hotend") == HZ // 10
