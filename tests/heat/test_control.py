"""Closed loops on simulated heat: overshoot, settling, fans, hysteresis."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.heat.oven import FAN_LOSS, Oven

from passo import _core, config
from passo.printer.setup.connections import connect_simulated

CONTROLS = {
    "pid": "control = { kind = 'pid' }",
    "tuned pid": "control = { kind = 'pid', kp = 55.82, ki = 11.17, kd = 69.79 }",
    "model": "control = { kind = 'model' }",
}


@pytest.mark.parametrize("name", CONTROLS)
@pytest.mark.parametrize("target", [60.0, 150.0, 210.0])
def test_control_settles_without_overshoot_and_with_fan(name, target):
    oven = Oven(CONTROLS[name])
    oven.heat(target)
    rise = oven.run(240)
    assert max(body for _, body, _, _ in rise) < target + 1.0
    settled = [body for s, body, _, _ in rise if s > 160]
    assert all(abs(body - target) < 0.5 for body in settled)
    oven.blow(1.0)
    wind = oven.run(120)
    assert oven.heater.fan == 1.0
    assert all(abs(body - target) < 0.5 for _, body, _, _ in wind)
    oven.blow(0.0)
    calm = oven.run(120)
    assert all(abs(body - target) < 0.5 for _, body, _, _ in calm)
    assert oven.faults == []


@pytest.mark.parametrize("name", CONTROLS)
@pytest.mark.parametrize(
    ("before", "target", "within_s"),
    [(200, 150, 60), (240, 200, 45), (150, 200, 75), (200, 205, 30)],
)
def test_another_target_is_held_as_well(name, before, target, within_s):
    oven = Oven(CONTROLS[name])
    oven.heat(before)
    oven.run(200)
    oven.heat(target)
    begin = oven.now_s
    rows = oven.run(150)
    first = next(s for s, body, _, _ in rows if abs(body - target) < 1)
    assert all(abs(body - target) < 2.0 for s, body, _, _ in rows if s > first)
    assert all(abs(body - target) < 0.5 for s, body, _, _ in rows if s > begin + within_s)
    assert oven.faults == []


@pytest.mark.parametrize("name", CONTROLS)
@pytest.mark.parametrize(("before", "target"), [(26, 240), (30, 283), (60, 240), (100, 240)])
@pytest.mark.parametrize("fan", [0.0, 1.0])
def test_heating_never_overshoots(name, before, target, fan):
    oven = Oven(CONTROLS[name])
    oven.blow(fan)
    oven.heat(before)
    oven.run(60)
    oven.heat(target)
    rows = oven.run(200)
    assert max(body for _, body, _, _ in rows) < target + 2.0
    assert oven.faults == []


@pytest.mark.parametrize("name", CONTROLS)
def test_a_lower_target_with_the_fan_on(name):
    oven = Oven(CONTROLS[name])
    oven.blow(1.0)
    oven.heat(240.0)
    oven.run(200)
    oven.heat(150.0)
    rows = oven.run(150)
    first = next(s for s, body, _, _ in rows if abs(body - 150) < 1)
    assert all(abs(body - 150) < 1.2 for s, body, _, _ in rows if s > first)


@pytest.mark.parametrize("name", ["pid", "tuned pid"])
def test_fan_beyond_full_power_leaves_no_windup(name):
    oven = Oven(f"max_power = 0.65\n{CONTROLS[name]}")
    oven.heat(240.0)
    oven.run(240)
    for _ in range(6):
        oven.blow(1.0)
        oven.run(2)
        oven.blow(0.0)
        oven.run(8)
    rows = oven.run(30)
    assert all(abs(body - 240) < 1.0 for _, body, _, _ in rows)


def test_wound_up_control_is_off_above_its_range():
    oven = Oven("control = { kind = 'pid', kp = 12.75, ki = 12.75, kd = 0.0, range_c = 5.0 }")
    oven.heat(210.0)
    rows = oven.run(300)
    assert max(body for _, body, _, _ in rows) < 230
    assert oven.heater.terms.i <= 1.0
    assert any(row[3] == 0.0 for row in rows)


def test_sensor_shows_effect_of_fan_outside_the_model():
    model = "model = { rise_c = 380.0, time_constant_s = 120.0, fan_loss = 0.0 }"
    oven = Oven(f"{CONTROLS['pid']}\n{model}")
    oven.heat(210.0)
    oven.run(240)
    oven.blow(1.0)
    wind = oven.run(120)
    assert -2.0 < min(body for _, body, _, _ in wind) - 210.0 < -1.0
    assert all(abs(body - 210.0) < 0.5 for _, body, _, _ in wind[4 * 60 :])
    assert oven.faults == []


@pytest.mark.parametrize("name", CONTROLS)
@pytest.mark.parametrize(("target", "adc_step_c"), [(90, 0.1), (180, 0.4), (240, 0.9), (280, 1.7)])
def test_a_hot_thermistor_is_as_exact_as_its_adc(name, target, adc_step_c):
    oven = Oven(CONTROLS[name])
    oven.heat(target)
    rise = oven.run(240)
    assert max(body for _, body, _, _ in rise) < target + 2.0
    near = max(0.5, adc_step_c)
    assert all(abs(body - target) < near for s, body, _, _ in rise if s > 180)
    assert oven.faults == []


def test_heat_model_anticipates_the_fan():
    oven = Oven(CONTROLS["model"])
    oven.heat(210.0)
    settled = oven.run(240)
    assert next(s for s, body, _, _ in settled if body > 209.5) < 90
    oven.blow(1.0)
    wind = oven.run(60)
    assert min(body for _, body, _, _ in wind) > 209.5
    power = sum(row[3] for row in wind[-120:]) / 120
    assert power == pytest.approx((1 + FAN_LOSS) * 185 / 380, abs=0.01)


@pytest.mark.parametrize(
    ("rise_c", "time_constant_s"), [(304.0, 120.0), (456.0, 120.0), (380.0, 96.0), (380.0, 144.0)]
)
def test_wrong_heat_model_still_settles(rise_c, time_constant_s):
    model = f"model = {{ rise_c = {rise_c}, time_constant_s = {time_constant_s} }}"
    oven = Oven(f"{CONTROLS['model']}\n{model}\nprotection = {{ deviation = 0.0 }}")
    oven.heat(200.0)
    rise = oven.run(240)
    assert max(body for _, body, _, _ in rise) < 202.0
    assert all(abs(body - 200) < 0.5 for s, body, _, _ in rise if s > 140)


def test_gains_that_are_far_too_small_are_not_a_fault():
    oven = Oven("control = { kind = 'pid', kp = 10.2, ki = 0.1275, kd = 25.5 }")
    oven.heat(210.0)
    slow = oven.run(600)
    assert max(body for _, body, _, _ in slow) < 210.5
    assert slow[-1][1] > 208
    assert oven.faults == []


def test_two_hotends_have_states_of_their_own():
    machine = config.load("dual-extruder")
    connection, board = connect_simulated(machine)
    hz = machine.board.clock_hz
    connection.set_target("hotend", 200.0)
    connection.run(connection.now + 60 * hz)
    connection.set_target("hotend1", 150.0)
    connection.run(connection.now + 180 * hz)
    assert board.temperature("hotend") == pytest.approx(200, abs=0.5)
    assert board.temperature("hotend1") == pytest.approx(150, abs=0.5)
    first, second = (connection.heaters[name].take_samples() for name in ("hotend", "hotend1"))
    assert len(first) == pytest.approx(len(second), abs=1)
    assert first[-1].terms.i == pytest.approx(175 / 380, abs=0.05)
    assert second[-1].terms.i == pytest.approx(125 / 380, abs=0.05)


def test_bed_temperature_settles():
    oven = Oven(name="bed")
    oven.heat(60.0)
    rise = oven.run(300)
    assert max(body for _, body, _, _ in rise) < 60.5
    assert all(abs(body - 60) < 0.5 for s, body, _, _ in rise if s > 180)


def test_bang_bang_stays_within_its_hysteresis():
    control = "control = { kind = 'bang-bang', hysteresis_c = 1.0, interval_s = 0.0 }"
    oven = Oven(bed=control, name="bed")
    oven.heat(60.0)
    oven.run(200)
    seen = oven.run(600)
    # The sensor's lag of 4 s adds what the bed gains or loses in it: 0.17 and 0.09 °C/s.
    assert 58.4 < min(felt for _, _, felt, _ in seen) < 59.0
    assert 61.0 < max(felt for _, _, felt, _ in seen) < 61.9
    assert {power for _, _, _, power in seen} == {0.0, 1.0}


def test_bang_bang_keeps_its_interval():
    oven = Oven("control = { kind = 'bang-bang', hysteresis_c = 0.2, interval_s = 5.0 }")
    oven.heat(210.0)
    oven.run(120)
    seen = oven.run(200)
    switched = [b[0] for a, b in pairwise(seen) if (a[3] > 0) != (b[3] > 0)]
    gaps = [b - a for a, b in pairwise(switched)]
    assert len(gaps) > 10
    assert min(gaps) >= 5.0


def test_the_terms_of_pid_can_be_traced():
    oven = Oven("control = { kind = 'pid', kp = 12.75, ki = 2.55, kd = 25.5, drive_min = 0.1 }")
    oven.heat(100.0)
    oven.run(60)
    samples = oven.heater.take_samples()
    assert oven.heater.take_samples() == []
    far = [s for s in samples if s.target == 100 and s.terms.error > 10]
    near = [s for s in samples if abs(s.terms.error) <= 10]
    assert {(s.terms.p, s.terms.i, s.terms.d, s.power) for s in far} == {(0.0, 0.1, 0.0, 1.0)}
    assert len(near) > 100
    for s in near:
        t = s.terms
        assert t.p == pytest.approx(0.05 * t.error)
        assert 0.1 <= t.i <= 1.0
        assert s.power == t.output == pytest.approx(min(max(t.p + t.i + t.d, 0), 1))
    # The derivative knows the temperature only: a new target does not move it.
    before = oven.heater.terms
    oven.heat(102.0)
    oven.run(0.25)
    after = oven.heater.terms
    assert after.p - before.p == pytest.approx(0.1, abs=0.03)
    assert after.d == pytest.approx(before.d, abs=0.03)


def test_power_is_limited():
    oven = Oven("max_power = 0.6")
    oven.heat(200.0)
    assert max(power for *_, power in oven.run(150)) == 0.6
    assert oven.output() <= 0.6 * oven.connection.full_scale("hotend") + 1


def test_a_controller_is_changed_while_it_heats():
    oven = Oven()
    oven.heat(200.0)
    oven.run(200)
    oven.heater.set_control(_core.ModelControl(_core.HeatModel(380.0, 120.0, 2.0)))
    assert isinstance(oven.heater.control, _core.ModelControl)
    assert all(abs(body - 200) < 0.6 for _, body, _, _ in oven.run(60))
