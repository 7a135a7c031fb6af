"""Faults that other controllers are known for, and that this one must not have."""

import json
import re

import pytest
from tests.printer.test_homing import dual_scara
from tests.support.scenario import Host, Scenario

import passo
from passo import config
from passo.cli.main import main
from passo.config.load import shipped_text
from passo.errors import ConfigError


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X0 Y0 Z0 E0")
        yield scenario


def x_of(s):
    return float(re.match(r"X:(-?[\d.]+)", s.host.ok("M114")[0])[1])


@pytest.mark.parametrize("line", ["M220 S-1", "M220 S0", "M220 S-1000"])
def test_invalid_speed_factor_changes_nothing(s, line):
    s.host.ok("M220 S120")
    assert "expected 10 to 1000 percent" in s.host.ok(line)[0]
    assert s.host.ok("M220") == ["Speed factor override: 120", "ok"]


def test_a_speed_factor_that_is_not_a_number_changes_nothing(s):
    s.host.ok("M220 S120")
    s.host.ok("M220 Snan")
    assert s.host.ok("M220") == ["Speed factor override: 120", "ok"]


def test_a_speed_factor_is_kept_and_taken_back(s):
    s.host.ok("M220 S150")
    for line in ("M220 B", "M220 S100", "M220 R"):
        assert s.host.ok(line) == ["ok"]
    assert s.host.ok("M220") == ["Speed factor override: 150", "ok"]
    s.host.ok("M220 B S80")  # as Marlin: kept is what held before
    assert s.host.ok("M220") == ["Speed factor override: 80", "ok"]
    s.host.ok("M220 R")
    assert s.host.ok("M220") == ["Speed factor override: 150", "ok"]


@pytest.mark.parametrize("code", ["M84", "M85"])
def test_negative_dwell_is_refused(s, code):
    s.host.ok(f"{code} S600")
    assert "S is -5: expected at least 0 s" in s.host.ok(f"{code} S-5")[0]
    assert f"{code} S600" in s.host.ok("M503 S0", 20)


def test_commands_in_lower_case_are_the_same_commands(s):
    s.host.ok("g1 x10 f6000")
    assert x_of(s) == 10
    assert s.host.ok("m105")[0].startswith("ok T:")
    assert s.host.ok("foo") == ['echo:Unknown command: "FOO"', "ok"]


def test_an_unknown_command_is_named_every_time(s):
    for _ in range(3):
        assert s.host.ok("G999") == ['echo:Unknown command: "G999"', "ok"]


@pytest.mark.parametrize(
    "line",
    ["G1.1 X2", "G28.2", "G92.1 X0", "G92.1", "M104.5 S50", "M106.1 S9", "M112.1"],
)
def test_a_code_with_a_subcode_of_no_meaning_is_unknown(s, line):
    for _ in range(2):
        assert s.host.ok(line) == [f'echo:Unknown command: "{line.split()[0]}"', "ok"]
    assert x_of(s) == 0
    assert s.printer.rig.connection.heaters["hotend"].target == 0
    assert not s.printer.state.halted


def test_a_file_is_warned_once_of_each_such_code(tmp_path, capsys):
    (tmp_path / "a.gcode").write_text("G28\nG1.1 X2\nG1.1 X3\nM104.5 S50\nM862.3 P MK3S\n")
    assert main(["print", str(tmp_path / "a.gcode"), "--clock", "virtual"]) == 0
    told = [x.partition("a.gcode:")[2] for x in capsys.readouterr().err.splitlines()]
    assert [x for x in told if "unknown" in x] == [
        "2: G1.1 is unknown and was skipped (2 times)",
        "4: M104.5 is unknown and was skipped (1 time)",
    ]


def test_large_numbers_of_commands_do_not_wrap(s):
    assert s.host.ok("M65650") == ['echo:Unknown command: "M65650"', "ok"]  # 65536 + 114


def test_invalid_numbers_move_nothing(s):
    s.host.ok("G1 X10 F6000")
    for word in ("Xabc", "Xnan", "Xinf", "X", "X--1"):
        assert s.host.ok(f"G1 {word}")[0].startswith("echo:"), word
    assert x_of(s) == 10


def test_e_is_a_word_and_no_exponent(s):
    s.host.ok("M302 P1")
    s.host.ok("G1 X1E3 F6000")
    assert s.host.ok("M114")[0].startswith("X:1.000 Y:0.000 Z:0.000 E:3.0000")


def test_a_comment_is_not_an_error(s):
    assert s.host.ok("G1 X3 F6000 ; over there") == ["ok"]
    assert s.host.ok("G1 X4 (over there) Y1") == ["ok"]
    assert x_of(s) == 4


def test_temperatures_are_in_celsius(s):
    assert s.host.ok("M149 F")[0].startswith("echo:M149 is F: expected C")
    assert s.host.ok("M149 C") == ["ok"]
    s.host.ok("M104 S100 F")
    assert "/100.00" in s.host.ok("M105")[0]


def test_looking_at_a_fan_does_not_turn_it_on(s):
    """M503 and M105 are the ways to look; M106 always sets."""
    s.host.ok("M503")
    s.host.ok("M105")
    s.passes(1)
    assert s.board.output_value("part") == 0


def test_a_move_before_any_feed_rate_is_done(s):
    s.host.ok("G1 X10")
    s.host.ok("M400", 5)
    assert s.positions()["x"] == 30.0


def test_no_command_sets_a_pin_that_belongs_to_a_heater(s):
    assert s.host.ok("M42 P10 S255")[0].startswith("echo:P is 10: expected no output")
    s.passes(1)
    assert s.board.output_value("hotend") == 0


def test_a_reversal_stops_for_a_moment(tmp_path):
    path = tmp_path / "reversal.gcode"
    path.write_text("G28\nG1 X10 F6000\nG1 X0\nG1 X10\n")
    moves = [move.core for move in passo.Machine.load("i3").plan(path)]
    assert [move.end_speed for move in moves] == [0, 0, 0]
    assert [move.cruise_speed for move in moves] == [100, 100, 100]


def test_m82_leaves_the_motors_alone(s):
    s.host.ok("G1 X1 F6000")
    s.host.ok("M400")
    s.host.ok("M82")
    s.passes(1)
    assert s.board.output_value("x-enable") == 0  # low is on


def test_g92_e_counts_in_millimetres(s):
    s.host.ok("M302 P1")
    s.host.ok("G92 E7.5")
    s.host.ok("G1 E8.5 F600")
    s.host.ok("M400")
    assert s.positions()["e"] == pytest.approx(1.0, abs=0.011)


def test_firmware_reports_its_name(s):
    assert s.host.ok("M115")[0].startswith("FIRMWARE_NAME:Passo ")


def test_m999_alone_does_no_harm(s):
    s.host.ok("M104 S100 F")
    s.host.ok("G1 X5 F6000")
    assert s.host.ok("M999") == ["ok"]
    assert x_of(s) == 5
    assert s.printer.rig.connection.heaters["hotend"].target == 100


def test_m112_stops_at_once_and_no_job_counts_as_done(tmp_path):
    (tmp_path / "a.g").write_text("G28\n" + "G1 X100 F3000\nG1 X10\n" * 50)
    with Scenario("i3", card=str(tmp_path), state=str(tmp_path)) as s:
        s.host.ok("M104 S200")
        s.host.ok("M32 a.g")
        s.passes(15)
        s.host.send("M112")
        s.host.expect("Printer halted", 2)
        assert s.board.output_value("hotend") == 0
        assert not [line for line in s.host.heard if line == "Done printing file"]
        assert "Not SD printing" in s.host.ok("M27")[0]
        assert "Done printing" not in " ".join(s.host.ok("M78"))


def test_an_axis_that_failed_to_home_is_not_homed(s):
    s.board.force_switch("x", False)
    answer = s.host.ok("G28 X", 120)[-2]
    assert "axis X was not homed" in answer
    assert "switch x at ^X_MIN" in answer
    assert "axis X is not homed" in s.host.ok("G1 X1")[0]


def test_g28_without_axes_homes_all_of_them(s):
    s.host.ok("G28", 60)
    at = s.positions()
    assert [at[k] for k in "xyz"] == pytest.approx([0, 0, 0], abs=0.02)


def test_leaving_a_triggered_endstop_is_not_a_trigger(s):
    s.host.ok("G28", 60)
    s.host.ok("M540 S1")
    assert s.host.ok("G1 X20 Y20 Z5 F6000") == ["ok"]
    s.host.ok("M400", 10)
    assert s.positions()["x"] == 20.0


def test_two_parts_on_one_pin_are_refused():
    text = shipped_text("i3").replace('pin = "D9"', 'pin = "D8"')
    with pytest.raises(ConfigError) as error:
        config.load_text(text, "i3.toml")
    assert "D8" in str(error.value)


def test_an_upload_that_cannot_begin_moves_nothing(tmp_path):
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M932")
        assert s.host.ok("M28 Fnowhere/new.g")[0].startswith("Error:")
        assert s.host.ok("G1 X10 F6000")[0] == "Error:PreviousCommandFailed"
        s.passes(1)
        assert s.positions()["x"] == 20.0


def test_reports_do_not_wait_for_moves(s):
    s.host.ok("G1 X100 F600")
    other = Host(s)
    start = s.loop.time()
    other.ok("M114")
    other.ok("M105")
    assert s.loop.time() - start < 0.05
    assert s.positions()["x"] < 100


def strictly(text):
    """JSON as its standard has it: no NaN, no infinity."""
    return json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} in {text}"))


def test_arms_that_do_not_meet_lead_nowhere():
    """Forward kinematics without a solution: the position stays what it was, and a number."""
    with Scenario(dual_scara()) as s:
        s.host.ok("G28", 60)
        before = s.host.ok("M114")
        for arms in ("A179 B0", "A-30 B150", "B180"):
            assert "no point belongs to the motor positions" in s.host.ok(f"G92 {arms}")[0]
            assert s.host.ok("M114") == before
        assert all(abs(mm) < 200 for mm in strictly(s.host.ok("M408")[0])["coords"]["xyz"])


@pytest.mark.parametrize("sensor", [0.0, 0.5, 1.0])
def test_the_state_is_json_for_strict_readers(s, sensor):
    """With a sensor that is open or shorted, and halted by it, too."""
    s.host.ok("M104 S200")
    s.board.force_sensor("hotend", sensor)
    s.passes(3)
    for form in range(4):
        status = strictly(s.host.ok(f"M408 S{form}")[0])
        assert isinstance(status["temps"]["heads"]["current"][0], float)
        assert status["status"] == ("I" if sensor == 0.5 else "H")


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("M104 Sabc", "the word 'S' has no valid number"),
        ("M104 S", "the word 'S' has no valid number"),
        ("M104 S20000000000", "the word 'S20000000000' has no valid number"),
        ("M106 Sabc", "the word 'S' has no valid number"),
        ("M106 P S255", "the word 'P' has no valid number"),
        ("M104 S nan T", "the word 'T' has no valid number"),
        ("M106 S nan", "the word 'S' has no valid number"),
        ("M92 X", "the word 'X' has no valid number"),
        ("M302 P", "the word 'P' has no valid number"),
    ],
)
def test_a_word_without_a_number_changes_nothing(s, line, told):
    s.host.ok("M104 S60")
    s.host.ok("M106 S128")
    s.passes(0.5)
    before = (
        s.printer.rig.commands.outputs.fans,
        s.printer.rig.connection.heaters["hotend"].target,
    )
    assert any(told in text for text in s.host.ok(line))
    s.passes(0.5)
    after = (s.printer.rig.commands.outputs.fans, s.printer.rig.connection.heaters["hotend"].target)
    assert after == before
    assert after[1] == 60.0


def test_nan_switches_a_heater_off(s):
    s.host.ok("M104 S60")
    s.passes(0.5)
    s.host.ok("M104 S nan")
    s.passes(0.5)
    assert s.printer.rig.connection.heaters["hotend"].target == 0.0
