"""`passo print` fails where a print from the card of the served printer stops."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from tests.support.scenario import Scenario

import passo
from passo.cli.main import main
from passo.errors import InputError

START = "G28\nM109 S200\n"


def outcome(capsys, path, *words):
    """Exit status, sentences of what is wrong without the file's name, and the result."""
    status = main(["print", str(path), "--json", *words])
    result = json.loads(capsys.readouterr().out)
    return status, [e.partition(f"{path}:")[2] for e in result["errors"]], result


@pytest.fixture
def program(tmp_path):
    def write(text):
        path = tmp_path / "a.gcode"
        path.write_text(text)
        return path

    return write


REFUSED = {  # a program, the line that stops it, a part of the sentence
    "never homed": ("G1 X5 F600\n", 1, "axis X is not homed"),
    "one axis not homed": ("G28 X\nG1 X5 F600\nG1 Y5\n", 3, "axis Y is not homed"),
    "motors off": ("G28\nG1 X5 F600\nM84\nG1 X6\n", 4, "axis X is not homed"),
    "one motor off": ("G28\nM18 Y\nG1 X5 F600\nG1 Y6\n", 4, "axis Y is not homed"),
    "cold": ("G28\nG1 X10 E5 F600\n", 2, "cold extrusion"),
    "cold retraction": ("G28\nG10\n", 2, "cold extrusion"),
    "not hot enough yet": ("G28\nM104 S200\nG1 X10 E5 F600\n", 3, "cold extrusion"),
    "too low a target": ("G28\nM109 S150\nG1 X10 E5 F600\n", 3, "cold extrusion"),
    "guard set higher": (f"{START}M302 S220\nG1 E5 F600\n", 4, "cold extrusion"),
    "cold again": (f"{START}G1 E5 F600\nM104 S0\nG4 S200\nG1 E9\n", 6, "cold extrusion"),
    "cold again between moves": (
        f"{START}M104 S0\n" + "G1 X200 E9 F600\nG1 X0 E0\n" * 20,
        None,
        "cold extrusion",
    ),
    "hotend above its maximum": (
        "G28\nM109 S400\nG1 X5 F600\n",
        2,
        "is outside of its safe range, 5 to",
    ),
    "bed above its maximum": (
        "G28\nM140 S400\nG1 X5 F600\n",
        2,
        "is outside of its safe range, 5 to",
    ),
    "no such fan": ("G28\nM106 P7 S255\n", 2, "P is 7"),
    "a speed of 0": ("G28\nM220 S0\n", 2, "S is 0"),
}


@pytest.mark.parametrize(("text", "line", "says"), REFUSED.values(), ids=REFUSED)
def test_print_stops_where_a_card_print_stops(capsys, program, tmp_path, text, line, says):
    path = program(text)
    status, (error,), _ = outcome(capsys, path)
    assert status == 4
    assert says in error
    stopped = int(error.split(":")[0])
    assert line in (None, stopped)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.gcode")
        told = s.host.expect("^echo:Print of a.gcode stopped: a.gcode:", 900)
        there = int(told.split("a.gcode:")[1].split(":")[0])
        # Both look at a temperature that falls, some seconds of print time ahead.
        assert there == stopped if line else abs(there - stopped) <= 1
        assert says in told
    assert outcome(capsys, path, "--assume-ready")[0] == 0


PASSES = {
    "homed and warm": f"{START}G1 X10 E5 F600\n",
    "told where it is": "G92 X0 Y0 Z0\nG1 X10 F600\n",
    "homed where lost": "G28 X\nG28 O\nG1 X10 Y10 F600\n",
    "warm without a wait": "G28\nM104 S200\nG4 S120\nG1 X10 E5 F600\n",
    "cold allowed": "G28\nM302 P1\nG1 X10 E5 F600\n",
    "guard set lower": "G28\nM302 S0\nG1 X10 E5 F600\n",
}


@pytest.mark.parametrize("text", PASSES.values(), ids=PASSES)
def test_print_passes_what_a_card_print_passes(capsys, program, tmp_path, text):
    status, errors, result = outcome(capsys, program(text))
    assert (status, errors, result["warnings"]) == (0, [], [])
    assert result["final_position_mm"]["x"] == 10
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.gcode")
        s.host.expect("^Done printing file$", 900)


def test_checks_change_no_step_of_a_print(capsys, program):
    path = program(f"{START}" + "G1 X50 Y20 E3 F3000\nG1 X10 Y50 E6\nM106 S99\n" * 50)
    checked, ready = outcome(capsys, path)[2], outcome(capsys, path, "--assume-ready")[2]
    assert checked["stream_hash"] == ready["stream_hash"]


def test_each_hotend_is_checked_for_its_tool(capsys, program):
    path = program("G28\nM109 T0 S200\nG1 E1 F600\nT1\nG1 E2\n")
    status, (error,), _ = outcome(capsys, path, "--machine", "dual-extruder")
    assert status == 4
    assert error.startswith("5: cold extrusion")


UNKNOWN = [
    "PRINT_START BED=60", "START_PRINT", "_PURGE_LINE", "print_end",
    "G84 X1 Z-1 R1",
    "G5 X1 Y1 I0 J1 P0 Q1", "G41 D1", "G51 X2", "O100 call", "O5 while [1]",
    "G90 G68 X0 Y0 R45",
]  # fmt: skip


@pytest.mark.parametrize("line", UNKNOWN)
def test_unknown_command_that_may_move_stops_first(capsys, program, line):
    path = program(f"{START}G1 X10 F600\n{line} ; here\nG1 X20\n{line}\n")
    status, (error,), result = outcome(capsys, path)
    assert status == 4
    assert error.startswith("4: ")
    assert "is unknown here" in error
    assert "--unknown skip" in error
    assert (result["moves"], result["heat_time_s"]) == (0, 0)
    status, errors, result = outcome(capsys, path, "--unknown", "skip")
    assert (status, errors, result["final_position_mm"]["x"]) == (0, [], 20)
    assert "is unknown and was skipped (2 times)" in result["warnings"][0]


def test_probing_move_without_a_probe_stops_first(capsys, program):
    path = program(f"{START}G1 X10 F600\nG38.2 Z-5\nG1 X20\n")
    status, (error,), result = outcome(capsys, path)
    assert status == 4
    assert error.startswith("4: ")
    assert "G38.2 is unknown here" in error
    assert result["moves"] == 0


HARMLESS = [
    "TIMELAPSE_TAKE_FRAME", "_TIMELAPSE_TAKE_FRAME",
    "BED_MESH_PROFILE LOAD=default", "SAVE_GCODE_STATE NAME=a", "RESPOND MSG=hi", "@pause", "$X",
    "M5000", "G777", "G64 P0.1", "G49", "O100", "D5", "Tx", "T?", "; PRINT_START", "(G81)",
    "M117 PRINT_START", "/PRINT_START",
]  # fmt: skip


@pytest.mark.parametrize("line", HARMLESS)
def test_commands_without_motion_stop_no_print(capsys, program, line):
    path = program(f"{START}G1 X10 F600\n{line}\nG1 X20\n")
    status, errors, result = outcome(capsys, path)
    assert (status, errors, result["final_position_mm"]["x"]) == (0, [], 20)


def test_all_unknown_commands_are_named_at_once(capsys, program):
    path = program("PRINT_START\nG29\nG1 X10 F600\nM600\nG87 X1\nM30\nPRINT_END\n")
    errors = outcome(capsys, path)[1]
    assert [error.split()[:2] for error in errors] == [
        ["1:", "PRINT_START"],
        ["2:", "G29"],
        ["5:", "G87"],
    ]


@pytest.mark.parametrize("line", ["G29", "g29 a", "G28 G29", "G32", "G33", "QUAD_GANTRY_LEVEL"])
def test_levelling_without_a_probe_stops_first(capsys, program, line):
    path = program(f"{START}{line}\nG1 X20 F600\n")
    status, (error,), result = outcome(capsys, path)
    assert (status, result["moves"]) == (4, 0)
    assert "levels the bed, and this machine has no probe" in error
    assert "--levelling skip" in error
    assert outcome(capsys, path, "--levelling", "skip")[0] == 0


def test_a_pipe_stops_at_its_unknown_command(program):
    path = program(f"{START}G1 X10 F600\nPRINT_START\nG1 X20\n")
    command = f"cat {path} | {sys.executable} -m passo print /dev/stdin"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert run.returncode == 4
    assert "/dev/stdin:4: PRINT_START is unknown here" in run.stderr


@pytest.mark.parametrize("command", ["estimate", "steps", "report", "explain"])
def test_estimate_and_steps_accept_partial_files(capsys, program, tmp_path, command):
    path = program("PRINT_START\nG29\nG1 X10 E5 F600\n")
    words = ["--output", str(tmp_path / "out.npz")] if command in ("steps", "report") else []
    if command == "estimate":
        assert main([command, str(path)]) == 4  # as its print
        assert "--unknown skip" in capsys.readouterr().err
        words = ["--assume-ready", "--unknown", "skip", "--levelling", "skip"]
    file = f"{path}:3" if command == "explain" else str(path)
    assert main([command, file, *words]) == 0
    told = capsys.readouterr().err
    assert ("PRINT_START is unknown and was skipped" in told) is (command != "explain")


def test_library_checks_programs_unless_told_to_assume(program):
    machine = passo.Machine.load("i3")
    piece, full = program("G1 X10 E5 F600\n"), None
    with pytest.raises(InputError, match="axis X is not homed"):
        machine.print(piece)
    assert machine.print(piece, assume_ready=True).final_position_mm["x"] == 10
    full = program(f"START_PRINT\nG29\n{START}G1 X10 E5 F600\n")
    with pytest.raises(InputError, match="START_PRINT is unknown"):
        machine.print(full, skip_levelling=True)
    with pytest.raises(InputError, match="G29 levels the bed"):
        machine.print(full, skip_unknown=True)
    result = machine.print(full, skip_unknown=True, skip_levelling=True)
    assert result.final_position_mm["x"] == 10


def test_temperature_wait_lets_a_print_heat(capsys, program):
    """A macro M109 of the community waits so: in 3 °C of the target, not until it is stable."""
    wait = "M104 S200\nTEMPERATURE_WAIT SENSOR=extruder MINIMUM=197 MAXIMUM=203\n"
    text = f"G28\n{wait}G1 X10 E5 F3000\n"
    status, wrong, result = outcome(capsys, program(text))
    assert (status, wrong) == (0, [])
    assert 60 < result["heat_time_s"] < 200
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.host.ok("M104 S200")
        begun_s = s.printer.rig.queue.now_s
        s.host.ok("TEMPERATURE_WAIT SENSOR=extruder MINIMUM=197 MAXIMUM=203", 300)
        assert result["heat_time_s"] == pytest.approx(s.printer.rig.queue.now_s - begun_s, abs=30)
        assert s.printer.rig.connection.heaters["hotend"].celsius > 196
