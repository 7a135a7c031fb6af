"""Tunes and gains on a console."""

import re

import pytest
from tests.console.scenario import Scenario

from passo import config
from passo.config.load import shipped_text


def gains(line):
    return [float(x) for x in re.findall(r"[PID](-?[\d.]+)", line.split("H", 1)[1])]


def test_a_relay_tune_finds_gains_that_hold_the_temperature(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        before = s.host.ok("M301 H0")[0]
        answer = s.host.ok("M303 H0 S200 C5 U", 1200)
        assert answer[:2] == [
            "PID Autotune start",
            "Hotend:0 Temp:200 Cycles:5 Method:0 (applied and stored)",
        ]
        assert any("PID Autotune finished!" in line for line in answer)
        assert "echo:busy: heating" in answer
        found = s.host.ok("M301 H0")[0]
        assert found != before
        assert s.printer.connection.heaters["hotend"].target == 0
        s.host.ok("M109 S210", 600)
        hottest = 0.0
        for _ in range(240):
            s.passes(0.5)
            hottest = max(hottest, s.board.temperature("hotend"))
        assert hottest <= 212
        assert s.board.temperature("hotend") == pytest.approx(210, abs=0.5)
    with Scenario("i3", state=str(tmp_path)) as s:
        assert gains(s.host.ok("M301 H0")[0]) == pytest.approx(gains(found))


def test_without_u_a_tune_only_reports():
    with Scenario("i3") as s:
        before = s.host.ok("M301 H-1")
        s.host.ok("M303 H-1 S60 C3", 3600)
        assert s.host.ok("M301 H-1") == before


def test_a_tune_can_be_ended():
    with Scenario("i3") as s:
        before = s.host.ok("M301 H0")
        s.host.send("M303 H0 S200")
        s.passes(60)
        s.host.send("M108")
        s.host.expect("^ok", 1)
        assert s.printer.connection.heaters["hotend"].target == 0
        assert s.host.ok("M301 H0") == before


def test_a_target_too_near_the_limit_is_refused():
    with Scenario("i3") as s:
        assert s.host.ok("M303 H0 S280")[0] == "echo:PID Autotune failed! Temperature too high"


def test_a_model_is_found_by_its_step_response():
    text = shipped_text("i3").replace(
        "[heaters.hotend]\n", '[heaters.hotend]\ncontrol = { kind = "model" }\n'
    )
    with Scenario(config.load_text(text)) as s:
        answer = s.host.ok("M303 H0 S200 U", 3600)
        assert answer[0] == "MPC Autotune start"
        model = s.printer.connection.heaters["hotend"].model
        assert model.rise_c == pytest.approx(380, rel=0.05)
        assert model.time_constant_s == pytest.approx(120, rel=0.05)
        s.passes(0.5)
        assert s.board.output_value("part") == 0


def test_gains_are_set_in_the_usual_unit():
    with Scenario("i3") as s:
        s.host.ok("M301 H0 P25.5 I2.55 D51")
        control = s.printer.connection.heaters["hotend"].control
        assert (control.kp, control.ki, control.kd) == pytest.approx((0.1, 0.01, 0.2))
        assert s.host.ok("M301 H0")[0] == "M301 H0 P25.5 I2.55 D51"
        s.host.ok("M304 P10.2")
        assert s.printer.connection.heaters["bed"].control.kp == pytest.approx(0.04)
        assert "numbers of at least 0" in s.host.ok("M301 P-1")[0]
        assert "there is no hotend with number 4" in s.host.ok("M301 H4 P1")[0]


def test_a_thermistor_can_be_changed_while_it_runs():
    with Scenario("i3") as s:
        assert s.host.ok("M305 H0")[0].startswith("M305 H0 A100000 B3950 C0.0000000000 R4700")
        s.host.ok("M109 S200", 300)
        s.passes(60)
        s.host.ok("M305 H0 B4267")
        s.passes(1)
        # The same resistance is a lower temperature with a greater beta.
        assert s.printer.connection.heaters["hotend"].celsius < 190
        assert "B4267" in s.host.ok("M305 H0")[0]
        assert "expected values of a thermistor" in s.host.ok("M305 H0 B-3")[0]
        assert s.host.ok("M306 H0")[0] == "M306 H0 L5 O285 C255 U1 T1"
