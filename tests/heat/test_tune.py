"""Tunes: golden rules, their lines, and what their results do on simulated heat."""

from __future__ import annotations

import pytest
from tests.heat.oven import FAN_LOSS, Oven

from passo import _core
from passo.heat.relay_tune import RelayTune, TuneError
from passo.heat.rules import RULES, Gains
from passo.heat.step_fit import fit_step, step_response
from passo.heat.step_tune import StepTune


@pytest.mark.parametrize(
    ("number", "name", "gains"),
    [
        (0, "Classic PID", (12, 0.8, 45)),
        (1, "Some Overshoot PID", (6.6, 0.44, 66)),
        (2, "No Overshoot PID", (4, 0.26667, 40)),
        (3, "Pessen Integral Rule PID", (14, 1.16667, 63)),
        (4, "Tyreus-Lyben PID", (9.09, 0.13773, 43.286)),
    ],
)
def test_five_tuning_rules_give_their_gains(number, name, gains):
    found = RULES[number].gains(20.0, 30.0)
    assert RULES[number].name == name
    assert (found.kp, found.ki, found.kd) == pytest.approx(gains, rel=1e-4)


def tuned(oven: Oven, tune: RelayTune | StepTune) -> list[str]:
    """Runs a tune to its end; its lines."""
    lines = tune.begin()
    oven.heater.set_control(tune.control)
    oven.heat(tune.target_c)
    fan = 0.0
    while not tune.done:
        oven.run(0.25)
        for row in oven.heater.take_samples():
            lines += tune.feed(row)
        if tune.control != oven.heater.control:
            oven.heater.set_control(tune.control)
        if tune.fan != fan:
            fan = tune.fan
            oven.blow(fan)
    oven.heat(0.0)
    return lines


def sample(clock: int, celsius: float) -> _core.HeatSample:
    """On the way up to 200 °C at full power."""
    terms = _core.HeatTerms(200 - celsius, p=0.5, d=0.5, output=1.0)
    return _core.HeatSample(clock, celsius, 200.0, 1.0, terms)


def relay(oven: Oven, target: float, *, count_c: float = 0.5, **options: int) -> RelayTune:
    limit = oven.machine.heaters[oven.name].max_c
    label = "BED" if oven.name == "bed" else "Hotend:0"
    return RelayTune(label, target, **options, clock_hz=oven.hz, limit_c=limit, count_c=count_c)


def test_relay_tune_prints_these_lines():
    oven = Oven()
    tune = relay(oven, 200.0, cycles=4)
    lines = tuned(oven, tune)
    assert oven.faults == []
    assert lines[:2] == ["PID Autotune start", "Hotend:0 Temp:200 Cycles:4 Method:0"]
    assert [line.split(":")[0] for line in lines[2:]] == [
        " bias", " bias",
        " bias", " Ku", " Classic PID", " Kp",
        " bias", " Ku", " Classic PID", " Kp",
        "PID Autotune finished!",
        " Kp",
    ]  # fmt: skip
    assert lines[-1] == lines[-3] == f" {tune.result}"
    assert tune.result == Gains(
        pytest.approx(51, rel=0.2), pytest.approx(10.2, rel=0.2), pytest.approx(66.3, rel=0.2)
    )


def test_a_bed_gets_the_same_lines_as_a_hotend():
    oven = Oven(name="bed")
    tune = relay(oven, 60.0, cycles=3, count_c=0.205)
    lines = tuned(oven, tune)
    assert lines[1] == "BED Temp:60 Cycles:3 Method:0"
    assert [line for line in lines if "too small" in line] == [
        " A swing of 0.21 C is too small to measure: 4 steps of the sensor are 0.82 C. The tune"
        " continues with a larger one"
    ]
    assert tune.control == _core.RelayControl(band_c=2.5 * 0.205)
    assert lines[-2:] == ["PID Autotune finished!", f" {tune.result}"]


def cycle(tune: RelayTune, start: int, low: float, high: float) -> list[str]:
    """A swing of ten seconds around 60 °C, with a clock of 1 Hz."""
    down, up = (_core.HeatTerms(0.0, p=0.5, d=d, output=0.5 + d) for d in (-0.5, 0.5))
    lines = tune.feed(_core.HeatSample(start, high, 60.0, 0.0, down))
    return lines + tune.feed(_core.HeatSample(start + 10, low, 60.0, 1.0, up))


def test_swing_that_stays_too_small_fails_the_tune():
    tune = RelayTune("BED", 60.0, 3, clock_hz=1.0, limit_c=120.0, count_c=0.2)
    lines: list[str] = []
    for n in range(8):
        lines += cycle(tune, 20 * n, 59.9, 60.1)
        if tune.done:
            break
    assert tune.result is None
    assert tune.control == _core.RelayControl(band_c=0.5)
    assert lines[-1] == (
        "Error:PID Autotune failed! A swing of 0.10 C is too small to measure: 4 steps of the"
        " sensor are 0.80 C; R5 measures a rise in its place"
    )


@pytest.mark.parametrize("rule", range(5))
def test_every_rule_gives_gains_that_hold(rule):
    oven = Oven()
    tune = relay(oven, 210.0, rule=rule, cycles=3)
    tuned(oven, tune)
    gains = tune.result
    assert gains is not None
    oven = Oven(f"control = {{ kind='pid', kp={gains.kp}, ki={gains.ki}, kd={gains.kd} }}")
    oven.heat(210.0)
    rise = oven.run(240)
    assert max(body for _, body, _, _ in rise) < 212.0
    assert all(abs(body - 210) < 0.5 for s, body, _, _ in rise if s > 170)
    oven.blow(1.0)
    wind = oven.run(120)
    assert all(abs(body - 210) < 2.0 for _, body, _, _ in wind)
    assert all(abs(body - 210) < 0.5 for _, body, _, _ in wind[160:])


def test_unfit_tunes_are_refused():
    for target, rule in ((271.0, 0), (200.0, 5)):
        with pytest.raises(TuneError, match="PID Autotune failed!"):
            RelayTune("Hotend:0", target, rule=rule, clock_hz=1e6, limit_c=285.0)
    with pytest.raises(TuneError, match="Temperature too high"):
        StepTune("Hotend:0", 271.0, clock_hz=1e6, limit_c=285.0)
    assert RelayTune("BED", 60.0, 1, clock_hz=1e6, limit_c=120.0).cycles == 3
    assert RelayTune("BED", 60.0, 99, clock_hz=1e6, limit_c=120.0).cycles == 20


def test_a_tune_ends_when_it_gets_too_hot_or_takes_too_long():
    hot = RelayTune("Hotend:0", 200.0, clock_hz=1.0, limit_c=285.0)
    assert hot.feed(sample(0, 219.0)) == []
    says = ["Error:PID Autotune failed! Temperature too high"]
    assert hot.feed(sample(1, 221.0)) == says
    assert hot.done
    assert hot.result is None
    slow = RelayTune("Hotend:0", 200.0, clock_hz=1.0, limit_c=285.0)
    assert slow.feed(sample(0, 25.0)) == []
    assert slow.feed(sample(600, 25.0)) == []
    says = ["Error:PID Autotune failed! timeout"]
    assert slow.feed(sample(601, 25.0)) == says


def test_the_fit_finds_what_made_the_rows():
    rows = [(t / 4, 25 + step_response(t / 4, 380.0, 120.0, 2.0)) for t in range(280)]
    assert fit_step(rows, 25.0) == pytest.approx((380, 120, 2), rel=1e-6)


def test_the_step_tune_finds_the_model():
    oven = Oven()
    tune = StepTune("Hotend:0", 210.0, clock_hz=oven.hz, limit_c=285.0)
    lines = tuned(oven, tune)
    assert oven.faults == []
    model = tune.result
    assert model is not None
    assert model.rise_c == pytest.approx(380, rel=0.01)
    assert model.time_constant_s == pytest.approx(120, rel=0.01)
    assert model.sensor_lag_s == pytest.approx(2.1, abs=0.1)  # 2 s, and 0.1 s of the way there
    assert model.fan_loss == pytest.approx(FAN_LOSS, abs=0.02)
    assert lines[0] == "MPC Autotune start"
    assert lines[-2] == "MPC Autotune finished!"
    assert tune.fan == 0.0


def test_the_step_tune_of_a_bed_ends_with_its_rise():
    oven = Oven(name="bed")
    tune = StepTune("BED", 60.0, clock_hz=oven.hz, limit_c=120.0, with_fan=False)
    tuned(oven, tune)
    assert tune.result is not None
    assert tune.result.rise_c == pytest.approx(110, rel=0.01)
    assert tune.result.time_constant_s == pytest.approx(400, rel=0.01)
    assert tune.result.fan_loss == 0.0


def test_the_step_tune_must_start_cold():
    tune = StepTune("Hotend:0", 200.0, clock_hz=1.0, limit_c=285.0)
    assert tune.feed(sample(0, 50.0)) == ["Error:MPC Autotune failed! It must start cold"]
    assert tune.done
