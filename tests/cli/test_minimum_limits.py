"""The least limits, long moves, and what is told of them, through `passo print`."""

from __future__ import annotations

import json
import re
from importlib.resources import files

import pytest

from passo.cli.main import main
from passo.config.load import shipped_text
from passo.errors import Problem

PROGRAM = "G28\nG1 X20 Y20 Z5 F3000\nG1 X40 E2\nG3 I5 E3\nG1 E1\nG1 X0.01 Y20\n"


def told(capsys, tmp_path, text, *words):
    """Status of a print, its result, and what went to stderr."""
    path = tmp_path / "p.gcode"
    path.write_text(text)
    status = main(["print", str(path), "--assume-ready", "--json", *words])
    out, err = capsys.readouterr()
    return status, json.loads(out), err.replace(f"{path}:", "")


@pytest.mark.parametrize("name", ["i3", "corexy", "delta", "dual-extruder"])
def test_machine_with_minimum_accelerations_prints(capsys, tmp_path, name):
    shipped = files("passo.config").joinpath("machines", f"{name}.toml").read_text()
    text = re.sub(r"(?m)^((?:\w+_)?accel_(?:mm|deg)_s2) = .*", r"\1 = 0.1", shipped)
    machine = tmp_path / "machine.toml"
    machine.write_text(text)
    assert main(["check", str(machine)]) == 0
    capsys.readouterr()
    status, result, _ = told(capsys, tmp_path, PROGRAM, "--machine", str(machine))
    assert status == 0
    assert result["final_steps"] == result["net_steps_expected"]
    assert result["final_position_mm"]["x"] == 0.01
    # Two ways of 20 mm and one of 40 from rest to rest take 2 sqrt(d / a) each.
    assert result["print_time_s"] > 2 * (2 * 200**0.5 + 400**0.5)
    assert result["step_error_us"]["max"] < 2.1


@pytest.mark.parametrize(
    "line",
    [
        "M204 S0.1",
        "M204 P0.1 T0.1 R0.1",
        "M201 X0.1 Y0.1 Z0.1 E0.1",
        "SET_VELOCITY_LIMIT ACCEL=0.1 SQUARE_CORNER_VELOCITY=0.000001",
    ],
)
def test_program_with_minimum_accelerations_prints(capsys, tmp_path, line):
    status, result, _ = told(capsys, tmp_path, f"{line}\n{PROGRAM}")
    assert status == 0
    assert result["warnings"] == []
    assert result["final_steps"] == result["net_steps_expected"]
    assert result["print_time_s"] > 2 * (2 * 200**0.5 + 400**0.5)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("M204 S0.00000000000000000000001", "M204: S is 1e-23: expected at least 0.1 mm/s²"),
        ("M204 T0.0999", "M204: T is 0.0999: expected at least 0.1 mm/s²"),
        ("M201 E0.05", "M201: E is 0.05: expected at least 0.1 mm/s²"),
        ("M203 X0.0001", "M203: X is 0.0001: expected at least 0.001 mm/s"),
        (
            "SET_VELOCITY_LIMIT VELOCITY=0.0001",
            "SET_VELOCITY_LIMIT: VELOCITY is 0.0001: expected at least 0.001 mm/s",
        ),
        (
            "SET_VELOCITY_LIMIT ACCEL=0.01",
            "SET_VELOCITY_LIMIT: ACCEL is 0.01: expected at least 0.1 mm/s²",
        ),
    ],
)
def test_limits_below_minimum_are_reported_and_ignored(capsys, tmp_path, line, says):
    _, plain, _ = told(capsys, tmp_path, PROGRAM)
    status, result, err = told(capsys, tmp_path, f"{line}\n{PROGRAM}")
    assert status == 0
    assert f"1: {says}. Send the command with such a value. (1 time)" in err
    assert result["stream_hash"] == plain["stream_hash"]


@pytest.mark.parametrize(
    ("lines", "seconds"),
    [
        ("G1 X0.01 T100", 100),
        ("G1 E1 T20000", 20_000),
        ("M203 X0.001\nG1 X20", 20_000),
        ("G1 X0.02 F0.0001", 12_000),
    ],
)
def test_slow_moves_take_their_time(capsys, tmp_path, lines, seconds):
    status, result, _ = told(capsys, tmp_path, f"G28\n{lines}\n")
    assert status == 0
    assert result["print_time_s"] == pytest.approx(seconds, rel=1e-6)
    assert result["final_steps"] == result["net_steps_expected"]
    assert result["step_error_us"]["max"] < 2.1


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (
            "G1 X10 F0.0001",
            "the move would take 6e+06 s (limit 1,000,000 s): feedrate is too slow. "
            "Correct F, T, M203 or the speeds of the machine file, or use several moves.",
        ),
        (
            "G2 F100",
            "the arc has neither a centre nor a radius: I, J and R are missing or 0. "
            "Give the centre relative to the start of the arc, or the radius R.",
        ),
        (
            "G2 I5 P100000000",
            "P is 1e+08: expected 0 to 135047. Send the command with such a value.",
        ),
        ("G1 X250.0001", "X 250.0001 mm is beyond the limit of 250.0000 mm"),
        ("G1 X250.00004", "X 250.00004 mm is beyond the limit of 250.00000 mm"),
        ("G1 X-0.5", "X -0.500 mm is beyond the limit of 0.000 mm"),
        ("SET_VELOCITY_LIMIT ACCEL=", "the word 'ACCEL' has no valid number"),
        ("SET_VELOCITY_LIMIT ACCEL= VELOCITY=5", "the word 'ACCEL' has no valid number"),
        ("SET_VELOCITY_LIMIT VELOCITY=5 ACCEL", "the word 'ACCEL' has no valid number"),
        ("SET_VELOCITY_LIMIT ACCEL=fast", "the word 'ACCEL=fast' has no valid number"),
    ],
)
def test_wrong_limits_are_named_with_their_line(capsys, tmp_path, line, says):
    status, _, err = told(capsys, tmp_path, f"G28\n{line}\n")
    assert status == 4
    assert err.startswith(f"2: {says}")


@pytest.mark.parametrize(
    ("junction", "words", "says"),
    [
        ("deviation", "ACCEL_TO_DECEL=50 ACCEL=100", "ACCEL_TO_DECEL has no effect"),
        (
            "jerk",
            "SQUARE_CORNER_VELOCITY=5 ACCEL=100",
            "SQUARE_CORNER_VELOCITY has no effect, because the machine's corners use the jerk of"
            " each axis (X Y Z E)",
        ),
    ],
)
def test_keys_without_effect_are_reported_and_the_others_act(
    capsys, tmp_path, junction, words, says
):
    machine = tmp_path / "m.toml"
    text = shipped_text("i3").replace('junction = "deviation"', f'junction = "{junction}"')
    machine.write_text(text)
    option = ("--machine", str(machine))
    status, plain, _ = told(capsys, tmp_path, f"SET_VELOCITY_LIMIT ACCEL=100\n{PROGRAM}", *option)
    assert status == 0
    status, result, _ = told(capsys, tmp_path, f"SET_VELOCITY_LIMIT {words}\n{PROGRAM}", *option)
    assert status == 0
    assert result["stream_hash"] == plain["stream_hash"]
    (warning,) = result["warnings"]
    assert warning.endswith(f":1: SET_VELOCITY_LIMIT: {says} (1 time)")


def test_blanks_around_equals_sign_are_ignored(capsys, tmp_path):
    tight = told(capsys, tmp_path, f"SET_VELOCITY_LIMIT ACCEL=500 VELOCITY=5\n{PROGRAM}")
    wide = told(capsys, tmp_path, f"SET_VELOCITY_LIMIT accel = 500  VELOCITY= 5\n{PROGRAM}")
    assert wide[1]["warnings"] == []
    assert wide[1]["stream_hash"] == tight[1]["stream_hash"]


@pytest.mark.parametrize(
    "line", ["N1 G1 X5*{}", "M92 {}=", "SET_VELOCITY_LIMIT {}=1", "G5.{}", "#{}", "M104 S1 {}"]
)
def test_only_the_beginning_of_a_long_text_is_reported(capsys, tmp_path, line):
    _, result, err = told(capsys, tmp_path, f"G28\n{line.format('A' * 5000)}\nG1 X1\n")
    assert all(len(text) < 700 for text in err.splitlines())
    assert all(len(text) < 700 for text in result["warnings"] + result["errors"])


def test_a_long_value_of_any_problem_is_cut():
    for values in ({"value": "A" * 5000}, {"value": ["A"] * 5000}):
        problem = Problem("config.value", "m.toml", 3, {"key": "k" * 5000, "limit": "b", **values})
        assert str(problem).startswith("m.toml:3: " + "k" * 500 + "… is ")
        assert str(problem).endswith("…: expected b. Correct the value.")
        assert len(str(problem)) < 1100
