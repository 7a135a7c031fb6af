"""Tunes and gains on a console."""

import re
import tomllib

import pytest
from tests.support.scenario import Host, Scenario

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
            "Hotend:0 Temp:200 Cycles:5 Method:0 Apply result",
        ]
        assert any("PID Autotune finished!" in line for line in answer)
        assert "echo:busy: heating" in answer
        assert answer[-4] == "In use until a restart. M500 stores it"
        found = s.host.ok("M301 H0")[0]
        assert found != before
        assert s.printer.rig.connection.heaters["hotend"].target == 0
        s.host.ok("M109 S210", 600)
        hottest = 0.0
        for _ in range(240):
            s.passes(0.5)
            hottest = max(hottest, s.board.temperature("hotend"))
        assert hottest <= 212
        assert s.board.temperature("hotend") == pytest.approx(210, abs=0.5)
    with Scenario("i3", state=str(tmp_path)) as s:
        assert s.host.ok("M301 H0")[0] == before  # nothing is stored
        s.host.ok(found)
        s.host.ok("M500")
    with Scenario("i3", state=str(tmp_path)) as s:
        assert gains(s.host.ok("M301 H0")[0]) == pytest.approx(gains(found))


@pytest.mark.parametrize(
    ("heater", "words", "control"),
    [
        ("hotend", "H0 S200", 'control = { kind = "pid", kp = 20.0, filter_s = 2.0 }\n'),
        ("bed", "H-1 S60", ""),
    ],
)
def test_a_tune_ends_with_the_keys_of_the_machine_file(heater, words, control):
    head = f'[heaters.{heater}]\nkind = "{heater}"\n'
    text = shipped_text("i3")
    assert head in text
    with Scenario(config.load_text(text.replace(head, head + control))) as s:
        answer = s.host.ok(f"M303 {words} C3 U", 3600)
        assert answer[-3:] == [
            f"To keep this, write in the machine file, in the table [heaters.{heater}]:",
            answer[-2],
            "ok",
        ]
        found = s.printer.heat.controls.control(heater)
    kept = answer[-2] + "\n"
    machine = config.load_text(text.replace(head, head + kept))
    with Scenario(machine) as s:
        again = s.printer.heat.controls.control(heater)
        for key in ("kp", "ki", "kd"):
            assert getattr(again, key) == pytest.approx(getattr(found, key), rel=1e-3)
        assert again.filter_s == (2.0 if control else 1.0)


def test_gains_of_the_machine_file_are_those_of_m301_and_m503():
    head = "[heaters.hotend]\n"
    gains = 'control = { kind = "pid", kp = 21.527, ki = 1.063, kd = 108.982 }\n'
    with Scenario(config.load_text(shipped_text("i3").replace(head, head + gains))) as s:
        assert s.host.ok("M301 H0")[0] == "M301 H0 P21.527 I1.063 D108.982"
        assert "M301 H0 P21.527 I1.063 D108.982" in s.host.ok("M503")


def test_m301_questions_gains_of_another_unit():
    with Scenario("i3") as s:
        assert s.host.ok("M301 H0 P0.0844 I0.00417") == [
            "echo:The gains are in force, but P is 0.0844: a hotend has 1.5 to 1000, where full"
            " power is 255. Did you mean kp = 21.52, ki = 1.063 (multiplied by 255)?",
            "ok",
        ]
        assert s.host.ok("M301 H0")[0] == "M301 H0 P0.0844 I0.00417 D0"
        assert s.host.ok("M301 H0 P21.5 I1 D0") == ["ok"]


def test_without_u_a_tune_only_reports():
    with Scenario("i3") as s:
        before = s.host.ok("M301 H-1")
        answer = s.host.ok("M303 H-1 S60 C3", 3600)
        assert answer[-4] == "Not in use: the command has no U1"
        assert s.host.ok("M301 H-1") == before


def test_result_for_another_control_is_not_used():
    with Scenario("i3") as s:
        before = model_of(s)
        answer = s.host.ok("M303 H0 S200 R5 U1", 3600)
        assert answer[-4].startswith('Not in use: the control of hotend is "pid"')
        assert model_of(s) == before


@pytest.mark.parametrize(("name", "celsius"), [("i3", 60), ("i3", 45), ("prusa-mk3s", 60)])
def test_bed_swings_by_several_steps_of_its_sensor(name, celsius):
    with Scenario(name) as s:
        answer = s.host.ok(f"M303 H-1 S{celsius} C3 U1", 3600)
        step_c = s.printer.heat.controls.step_c("bed", celsius)
        low, high = re.findall(r"min:([\d.]+) max:([\d.]+)", "\n".join(answer))[-1]
        assert float(high) - float(low) >= 4 * step_c
        s.host.ok(f"M190 S{celsius}", 3600)
        s.passes(60)
        powers: list[float] = []
        for _ in range(120):
            s.passes(1)
            powers.append(s.printer.rig.connection.heaters["bed"].power)
        assert max(powers) - min(powers) < 0.7  # 1 with gains from a single step
        assert s.board.temperature("bed") == pytest.approx(celsius, abs=0.4)


def test_a_tune_can_be_ended():
    with Scenario("i3") as s:
        before = s.host.ok("M301 H0")
        s.host.send("M303 H0 S200")
        s.passes(60)
        s.host.send("M108")
        s.host.expect("^ok", 1)
        assert s.printer.rig.connection.heaters["hotend"].target == 0
        assert s.host.ok("M301 H0") == before


def test_a_target_too_near_the_limit_is_refused():
    with Scenario("i3") as s:
        assert s.host.ok("M303 H0 S280")[0] == "echo:PID Autotune failed! Temperature too high"


def by_model():
    text = shipped_text("i3").replace(
        "[heaters.hotend]\n", '[heaters.hotend]\ncontrol = { kind = "model" }\n'
    )
    return config.load_text(text)


def model_of(s):
    m = s.printer.rig.connection.heaters["hotend"].model
    return m.rise_c, m.time_constant_s, m.sensor_lag_s, m.fan_loss, m.ambient_c


def test_a_model_is_found_by_its_step_response_and_stays(tmp_path):
    with Scenario(by_model(), state=str(tmp_path)) as s:
        first = s.host.ok("M307 H0")[0]
        answer = s.host.ok("M303 H0 S200 U", 3600)
        assert answer[:2] == ["MPC Autotune start", "Hotend:0 Temp:200 Apply result"]
        found = model_of(s)
        assert found[:2] == (pytest.approx(380, rel=0.05), pytest.approx(120, rel=0.05))
        s.passes(0.5)
        assert s.board.output_value("part") == 0
        line = s.host.ok("M307 H0")[0]
        assert line != first
        assert line in s.host.ok("M503")
        s.host.ok("M500")
        s.host.ok("M502")
        assert s.host.ok("M307 H0")[0] == first
        s.host.ok("M501")
        assert model_of(s) == pytest.approx(found, rel=1e-9)
        s.host.ok("M502")
        s.host.ok(line)
        assert s.host.ok("M307 H0")[0] == line
        s.host.send("M112")
        s.host.expect("halted", 5)
        s.host.send("M999")
        s.host.expect("ready again", 5)
        assert model_of(s) == pytest.approx(found, rel=1e-9)
    with Scenario(by_model(), state=str(tmp_path)) as s:
        assert model_of(s) == pytest.approx(found, rel=1e-9)


def test_r5_finds_the_model_of_a_heater_that_its_gains_control(tmp_path):
    """Not M1: an M begins a command."""
    with Scenario("i3", state=str(tmp_path)) as s:
        settings = s.host.ok("M503")
        answer = s.host.ok("M303 H0 S200 R5 U", 3600)
        assert answer[:2] == ["MPC Autotune start", "Hotend:0 Temp:200"]
        told = dict(re.findall(r"(\w[\w ]*):([\d.]+)", answer[-5]))
        assert float(told["rise"]) == pytest.approx(380, rel=0.01)
        assert float(told["time constant"]) == pytest.approx(120, rel=0.01)
        keys = tomllib.loads(answer[-2])["model"]
        assert keys == {
            "rise_c": pytest.approx(float(told["rise"]), abs=0.06),
            "time_constant_s": pytest.approx(float(told["time constant"]), abs=0.06),
            "sensor_lag_s": pytest.approx(float(told["sensor lag"]), abs=0.006),
            "fan_loss": pytest.approx(float(told["fan loss"]), abs=0.0006),
            "ambient_c": pytest.approx(25, abs=0.5),
        }
        assert s.host.ok("M503") == settings
        assert "R is 6: expected 0 to 5" in s.host.ok("M303 H0 R6")[0]
        assert "R is -1: expected 0 to 5" in s.host.ok("M303 H0 R-1")[0]


def test_impossible_model_values_are_refused():
    with Scenario(by_model()) as s:
        line = s.host.ok("M307 H0")[0]
        assert line == "M307 H0 A380 C120 D2 F0.3 R25"
        wrong = s.host.ok("M307 H0 A400 C0")[0]
        assert wrong.startswith("echo:C is 0: expected more than 0 s")
        assert s.host.ok("M307 H0")[0] == line
        s.host.ok("M307 H0 A400 F0.2")
        assert model_of(s) == (400, 120, 2, 0.2, 25)
        assert "bed is not controlled by its model" in s.host.ok("M307 H-1 A3")[0]


@pytest.mark.parametrize(
    ("words", "note"), [("", ""), (" U0", ""), (" U1", " Apply result"), (" U", " Apply result")]
)
def test_a_tune_says_what_becomes_of_what_it_finds(words, note):
    with Scenario("i3") as s:
        s.host.send(f"M303 H0 S200 C3{words}")
        s.host.expect("PID Autotune start", 1)
        assert s.host.expect("^Hotend:0", 1) == f"Hotend:0 Temp:200 Cycles:3 Method:0{note}"


def test_u0_neither_takes_nor_stores(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        before = s.host.ok("M301 H0")
        s.host.ok("M303 H0 S200 C3 U0", 1200)
        assert s.host.ok("M301 H0") == before
        assert not (tmp_path / "settings.json").exists()


def test_cancelled_tune_of_print_keeps_gains_and_is_off(tmp_path):
    (tmp_path / "tune.g").write_text("M303 E0 S200\nM118 after\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        heater = s.printer.rig.connection.heaters["hotend"]
        before = heater.control
        s.host.ok("M32 tune.g")
        s.passes(20)
        assert heater.target == 200
        assert heater.control != before
        s.host.ok("M524")
        s.passes(0.5)
        assert (heater.target, heater.control) == (0, before)
        hottest = heater.celsius + 20  # what the sensor did not show yet
        s.passes(30)
        assert (heater.target, heater.power) == (0, 0)
        assert heater.celsius < hottest
        assert s.host.ok("M301 H0 P30 I2 D40") == ["ok"]
        s.host.ok("M109 S60", 300)
        s.passes(60)
        assert heater.celsius == pytest.approx(60, abs=0.5)


def test_gains_set_in_a_tune_hold_after_it_and_after_a_halt():
    with Scenario("i3") as s:
        s.host.ok("M301 H0 P30 I2 D40")
        s.host.send("M303 H0 S200")
        s.passes(20)
        other = Host(s)
        assert other.ok("M301 H0")[0] == "M301 H0 P30 I2 D40"
        other.ok("M301 H0 P31")
        other.send("M112")
        other.expect("halted", 5)
        other.send("M999")
        other.expect("ready again", 5)
        assert other.ok("M301 H0")[0] == "M301 H0 P31 I2 D40"
        assert s.printer.rig.connection.heaters["hotend"].target == 0


def test_gains_are_set_in_the_usual_unit():
    with Scenario("i3") as s:
        s.host.ok("M301 H0 P25.5 I2.55 D51")
        control = s.printer.rig.connection.heaters["hotend"].control
        assert (control.kp, control.ki, control.kd) == (25.5, 2.55, 51)
        assert s.host.ok("M301 H0")[0] == "M301 H0 P25.5 I2.55 D51"
        s.host.ok("M304 P10.2")
        assert s.printer.rig.connection.heaters["bed"].control.kp == 10.2
        refused = "echo:P is -1: expected at least 0"
        assert s.host.ok("M301 P-1 H-5")[0].startswith(refused)
        assert s.host.ok("M301 I3 P-1 H0")[0].startswith(refused)
        assert s.host.ok("M301 H0")[0] == "M301 H0 P25.5 I2.55 D51"
        assert "there is no hotend with number 4" in s.host.ok("M301 H4 P1")[0]


def test_a_thermistor_can_be_changed_while_it_runs():
    with Scenario("i3") as s:
        assert s.host.ok("M305 H0")[0].startswith("M305 H0 A100000 B3950 C0 R4700")
        s.host.ok("M109 S200", 300)
        s.passes(60)
        s.host.ok("M305 H0 B4267")
        s.passes(1)
        # The same resistance is a lower temperature with a greater beta.
        assert s.printer.rig.connection.heaters["hotend"].celsius < 190
        assert "B4267" in s.host.ok("M305 H0")[0]
        wrong = s.host.ok("M305 H0 A90000 B-3")[0]
        assert wrong.startswith("echo:B is -3: expected 100 to 20,000 K")
        assert "A100000 B4267" in s.host.ok("M305 H0")[0]
        assert s.host.ok("M306 H0")[0] == "M306 H0 A0 B255 L5 O285 C255 U1 T1"


def test_the_bounds_of_an_integral_are_settings(tmp_path):
    with Scenario("i3", state=str(tmp_path)) as s:
        assert s.host.ok("M306 H0 A25.5 B204") == ["ok"]
        for line, says in (
            ("M306 H0 B256", "B is 256: expected 0 to 255"),
            ("M306 H0 A-1", "A is -1: expected 0 to 255"),
            ("M306 H0 B20", "B is 20: expected more than A, 25.5"),
            ("M306 H0 O400", "heaters.hotend is fixed while the printer runs"),
        ):
            assert s.host.ok(line)[0].startswith(f"echo:{says}")
        control = s.printer.rig.connection.heaters["hotend"].control
        assert (control.drive_min, control.drive_max) == (0.1, 0.8)
        s.host.ok("M500")
    with Scenario("i3", state=str(tmp_path)) as s:
        assert s.host.ok("M306 H0")[0] == "M306 H0 A25.5 B204 L5 O285 C255 U1 T1"
        s.host.ok("M502")
        assert s.host.ok("M306 H0")[0] == "M306 H0 A0 B255 L5 O285 C255 U1 T1"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("A0.1", "A is 0.1: expected a number of at least 1"),
        ("R0.001", "R is 0.001: expected a number of at least 1"),
        ("B999999999", "B is 1e+09: expected 100 to 20,000 K"),
        (
            "A1",
            "with these values, the thermistor of hotend has no distinct reading for each"
            " temperature from 5 to 285 C",
        ),
    ],
)
def test_impossible_thermistor_is_refused(words, says):
    with Scenario("i3") as s:
        before = s.host.ok("M305 H0")
        assert says in s.host.ok(f"M305 H0 {words}")[0]
        assert s.host.ok("M305 H0") == before
        s.host.ok("M112")
        s.passes(1)
        s.host.ok("M999")
        assert not s.printer.state.halted
        assert s.host.ok("M305 H0") == before


@pytest.mark.parametrize("heater", ["E0", "H-1"])
def test_a_tune_without_heat_is_refused_with_a_reason(heater):
    with Scenario("i3") as s:
        assert s.host.ok(f"M303 {heater} S-5") == [
            "echo:S is -5: expected more than 5 C. Send the command with such a value.",
            "ok",
        ]
