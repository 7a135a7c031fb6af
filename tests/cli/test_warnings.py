"""Warnings of `passo print`: commands that it skips, limits and values that it does not apply."""

from __future__ import annotations

import json
from importlib.resources import files

import pytest
from tests.support.print_result import printed

from passo.cli.main import main


def test_an_unsafe_temperature_is_a_warning_and_heats_nothing(tmp_path, capsys):
    path = tmp_path / "hot.gcode"
    path.write_text("G28\nM104 S999\nG1 X10 F3000\n")
    assert main(["print", str(path), "--assume-ready", "--json"]) == 0
    (warning,) = json.loads(capsys.readouterr().out)["warnings"]
    assert warning.startswith(f"{path}:2: M104: heater hotend was switched off: 999 °C is outside")


def test_each_unknown_command_has_one_warning(capsys, tmp_path):
    """A file with a byte order mark, and without any line feed."""
    foreign = ["O1000", "D5", "H1", "Q5", "T?", "Tx", "Tc", "/G1 X5", "$H", "@pause", "T-1"]
    plain, path = tmp_path / "plain.gcode", tmp_path / "p.gcode"
    plain.write_text("G28\nG1 X10 Y10 E1 F3000\nG1 X100 E5\n")
    lines = ["%", *foreign, "G28", "G1 X10 Y10 E1 F3000", *foreign, "G1 X100 E5", ""]
    path.write_bytes(b"\xef\xbb\xbf" + "\r".join(lines).encode())
    result = printed(capsys, str(path))
    names = ["O1000", "D5", "H1", "Q5", "T?", "TX", "TC", "/", "$H", "@pause", "T-1"]
    assert result["warnings"] == [
        f"{path}:{i}: {name} is unknown and was skipped (2 times)"
        for i, name in enumerate(names, 2)
    ]
    assert result["stream_hash"] == printed(capsys, str(plain))["stream_hash"]


def test_very_many_unknown_codes_are_counted_together(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("".join(f"O{i}\n" for i in range(1, 1501)) + "M400\n")
    warnings = printed(capsys, str(path))["warnings"]
    assert len(warnings) == 1001
    assert warnings[999] == f"{path}:1000: O1000 is unknown and was skipped (1 time)"
    assert warnings[1000] == f"{path}:1001: any other code is unknown and was skipped (500 times)"


SENSELESS = {
    "M220 S0": "S is 0: expected 10 to 1000 percent",
    "M220 S-5": "S is -5: expected 10 to 1000 percent",
    "M221 S0": "S is 0: expected 1 to 1000 percent",
    "M201 X0": "X is 0: expected at least 0.1 mm/s²",
    "M203 X-5 Y100": "X is -5: expected at least 0.001 mm/s",
    "M204 S0": "S is 0: expected at least 0.1 mm/s²",
    "M204 P500 T-1": "T is -1: expected at least 0.1 mm/s²",
    "M205 J0": "J is 0: expected 0.00001 to 0.3 mm",
    "SET_VELOCITY_LIMIT VELOCITY=0": "VELOCITY is 0: expected at least 0.001 mm/s",
    "SET_VELOCITY_LIMIT ACCEL=-1": "ACCEL is -1: expected at least 0.1 mm/s²",
    "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=1": (
        "MINIMUM_CRUISE_RATIO is 1: expected 0 to less than 1"
    ),
}


@pytest.mark.parametrize("line", SENSELESS)
def test_impossible_values_warn_and_change_nothing(capsys, tmp_path, line):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nG1 X100 Y50 E5 F3000\n")
    plain = printed(capsys, str(path))
    path.write_text(f"G28\n{line}\nG1 X100 Y50 E5 F3000\n")
    result = printed(capsys, str(path))
    assert result["warnings"] == [
        f"{path}:2: {line.split()[0]}: {SENSELESS[line]}. Send the command with such a value."
        " (1 time)"
    ]
    assert result["stream_hash"] == plain["stream_hash"]


def cornered_s(capsys, tmp_path, line, law="jerk"):
    """Time of a zigzag of right angles, and the warnings, after `line`."""
    machine = tmp_path / "machine.toml"
    shipped = files("passo.config").joinpath("machines", "i3.toml").read_text()
    machine.write_text(shipped.replace('junction = "deviation"', f'junction = "{law}"'))
    path = tmp_path / "p.gcode"
    corners = [f"G1 X{1 + i} Y{i + 1}\nG1 X{2 + i}" for i in range(50)]
    path.write_text("\n".join(["G28", line, "G1 X1 F9000", *corners, ""]))
    result = printed(capsys, str(path), "--machine", str(machine))
    return result["move_time_s"], result["warnings"]


def test_m205_sets_the_jerk_of_axes_within_the_machines_own(capsys, tmp_path):
    usual, none = cornered_s(capsys, tmp_path, "")
    assert none == []
    assert cornered_s(capsys, tmp_path, "M205 X10 Y10 S0 T0") == (usual, [])
    as_usual, (applied,) = cornered_s(capsys, tmp_path, "M205 X100 Y100")
    assert as_usual == usual
    assert (
        "M205: X 100 mm/s is above the machine's limit, 10 mm/s is applied. M205: Y 100" in applied
    )
    slow, none = cornered_s(capsys, tmp_path, "M205 X1 Y1")
    assert none == []
    assert slow > usual * 1.15
    assert cornered_s(capsys, tmp_path, "M205 X1") == (pytest.approx(slow, rel=0.02), [])
    _, (warning,) = cornered_s(capsys, tmp_path, "M205 J0.1 B20000")
    assert "M205: J B have no effect, because the machine's corners use the jerk" in warning


def test_limits_above_the_machines_have_a_warning(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("M203 X500\nM204 P9000\nM106 S300\nM106 S300\nG28\nG1 X9 F600\n")
    warnings = printed(capsys, str(path))["warnings"]
    assert [w.removeprefix(f"{path}:") for w in warnings] == [
        "1: M203: X 500 mm/s is above the machine's limit, 300 mm/s is applied (1 time)",
        "2: M204: P 9000 is above the limits of M201, which apply: X 3000, Y 3000 (1 time)",
        "3: M106 S: 300 is not within 0 to 255, 255 is taken (2 times)",
    ]


def test_m205_sets_the_junction_deviation(capsys, tmp_path):
    usual, none = cornered_s(capsys, tmp_path, "M205 J0.02", "deviation")
    assert none == []
    assert cornered_s(capsys, tmp_path, "M205 J0.2", "deviation")[0] < usual * 0.9
    seconds, (warning,) = cornered_s(capsys, tmp_path, "M205 X8 E4.5 S0 T0", "deviation")
    assert seconds == usual
    assert (
        ":2: M205: X E have no effect, because the machine's corners use the junction deviation (J)"
        in warning
    )
    _, (warning,) = cornered_s(capsys, tmp_path, "M205 X0 Y0 B0 S0 T0", "deviation")
    assert ":2: M205: X Y have no effect" in warning


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("G28\nG1 X10 F600\nG1 X2", [3]),
        ("G28\nG1 X10 F600\nN3 g1", [3]),
        ("G28\nG1 X10 F600\nG1 X2\n", []),
        ("G28\nG1 X10 F600\nM84", []),
        ("G28\nG1 X10 F600\nM2\nG1 X2", []),
    ],
)
def test_a_file_that_ends_within_a_move_may_be_cut(capsys, tmp_path, text, lines):
    path = tmp_path / "a.gcode"
    path.write_text(text)
    told = [
        f"{path}:{line}: the file ends in the middle of a line, it may be cut short"
        for line in lines
    ]
    assert printed(capsys, str(path))["warnings"] == told
    capsys.readouterr()
    assert main(["estimate", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["warnings"] == told


def test_commands_that_need_passo_serve_are_named(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("M302 S0\nG28\nM92 E415\nM206 X1\nG1 X5 F600\nM92 E95.5\nM81\n")
    assert printed(capsys, str(path))["warnings"] == [
        f"{path}:3: M92 is for a printer that is served and was skipped (2 times)",
        f"{path}:4: M206 is for a printer that is served and was skipped (1 time)",
        f"{path}:7: M81 is for a printer that is served and was skipped (1 time)",
    ]
