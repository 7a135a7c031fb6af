"""`passo print`: figures, streams, traces, budget, memory."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib.resources import files

import pytest
from tests.support.print_result import printed

from passo import Machine
from passo.cli.main import main
from passo.config.load import shipped_text

FIELDS = [
    "file", "machine", "lines", "moves", "arcs", "print_time_s", "move_time_s", "heat_time_s",
    "dwell_time_s", "filament_mm", "travel_mm", "layers", "first_layer", "final_position_mm",
    "steps", "final_steps", "net_steps_expected", "reversal_pairs_dropped",
    "queue_step_commands", "wire_bytes", "step_error_us", "limits", "budget", "stream_hash",
    "warnings", "errors", "cpu_s", "process_peak_rss_mb",
]  # fmt: skip


def test_example_prints_on_the_i3(capsys, unpacked):
    result = printed(capsys, unpacked("demo"))
    assert list(result) == FIELDS
    assert result["lines"] == 32680
    assert result["layers"] == 15
    assert result["filament_mm"]["e"] == pytest.approx(413.966, abs=0.001)
    assert result["final_steps"] == result["net_steps_expected"]
    assert result["final_steps"] == {"x": 400, "y": 14592, "z": 60000, "e": 39534}
    parts = result["move_time_s"] + result["heat_time_s"] + result["dwell_time_s"]
    assert result["print_time_s"] == pytest.approx(parts)
    assert result["dwell_time_s"] == 10.0
    assert sum(result["limits"].values()) == pytest.approx(result["move_time_s"])
    assert result["step_error_us"]["max"] <= 2.0 + 0.5 / 16 + 1e-3
    assert result["warnings"] == result["errors"] == []
    assert set(result["cpu_s"]) == {
        "parse", "plan", "steps", "compress", "wire", "board", "total"
    }  # fmt: skip


GOLDEN = {
    ("demo", "i3"): "cd534b5fa7fabc46",
    ("gear_arcs", "mk3s"): "ebe2df0c699b509b",
    ("plate_toolchanger", "dual-extruder"): "79c65a015ad8b038",
}


@pytest.mark.parametrize(("file", "machine"), GOLDEN)
def test_golden_streams(capsys, unpacked, file, machine):
    result = printed(capsys, unpacked(file), "--machine", machine, "--levelling", "skip")
    assert result["stream_hash"] == GOLDEN[file, machine]
    assert result["final_steps"] == result["net_steps_expected"]


EXAMPLES_OF_APRINTER = {
    "radds": "z speed",
    "ramps-fd": "z speed",
    "four-pi": "z speed",
    "teensy3": "z speed",
    "ramps-13": "z speed",
    "melzi": "z speed",
    "stm32f407-discovery": "feedrate",
    "stm32f429-discovery": "feedrate",
    "linux-test": "feedrate",
}


@pytest.mark.parametrize("machine", EXAMPLES_OF_APRINTER)
def test_aprinters_examples_print_the_demo(capsys, unpacked, machine):
    """Most are too low for the place where the demo ends, hence `clamp`."""
    result = printed(capsys, unpacked("demo"), "--machine", machine, "--out-of-range", "clamp")
    assert (result["layers"], result["errors"]) == (15, [])
    assert result["final_steps"] == result["net_steps_expected"]
    assert EXAMPLES_OF_APRINTER[machine] in result["limits"]


def test_a_machine_with_a_real_board_prints_in_simulation(capsys, tmp_path, unpacked):
    """Its firmware is that of Passo unless the file names another; nothing opens the port."""
    real = tmp_path / "real.toml"
    port = 'link = "serial"\nport = "/dev/ttyUSB0"\n'
    real.write_text(shipped_text("i3").replace("[board]\n", f"[board]\n{port}"))
    result = printed(capsys, unpacked("demo"), "--machine", str(real))
    assert result["stream_hash"] == GOLDEN["demo", "i3"]


def test_arcs_are_printed_and_warnings_shown(capsys, unpacked):
    result = printed(capsys, unpacked("gear_arcs"), "--machine", "mk3s", "--levelling", "skip")
    assert result["arcs"] == 7241
    assert [w.split(": ", 1)[1] for w in result["warnings"]] == [
        "G80: levelling was skipped (1 time)",
        "M205: X Y Z E have no effect, because the machine's corners use the junction deviation (J)"
        " (1 time)",
        "M900: K30 is of Linear Advance 1.0 and has no effect (1 time)",
    ]


def test_print_with_two_extruders(capsys, unpacked):
    result = printed(capsys, unpacked("plate_toolchanger"), "--machine", "dual-extruder")
    assert sum(result["filament_mm"].values()) == pytest.approx(1662.9, abs=0.1)
    assert result["filament_mm"]["e1"] == pytest.approx(215.4, abs=0.1)


def test_table_confirms_that_all_steps_were_made(capsys, unpacked):
    assert main(["print", unpacked("demo")]) == 0
    out, err = capsys.readouterr()
    assert "net steps at the end        as expected on every motor" in out
    assert err == ""


def test_a_trace_has_the_steps_of_the_print(tmp_path):
    path = tmp_path / "trace.gcode"
    path.write_text("G28\nG1 X10 F3000\nG1 X5\n")
    trace = Machine.load("i3").trace(path, ideal=True)
    assert {name: len(ticks) for name, ticks in trace.ticks.items()} == {
        "x": 1200, "y": 0, "z": 0, "e": 0
    }  # fmt: skip
    assert sum(trace.directions["x"]) == 400
    errors = (abs(a - b) for a, b in zip(trace.ticks["x"], trace.ideal["x"], strict=True))
    assert max(errors) <= 32.5
    part = Machine.load("i3").trace(path, from_s=0.1, to_s=0.2)
    inside = [tick for tick in trace.ticks["x"] if 1_600_000 <= tick < 3_200_000]
    assert list(part.ticks["x"]) == inside


def test_a_slow_link_is_named_with_its_worst_line(capsys, tmp_path):
    """A zigzag of 0.05 mm a move at 100 mm/s is more than 30 000 baud carry."""
    lines = ["G92 X0 Y0 Z0 E0", "G1 X5 F6000"]
    lines += [f"G1 X{5 + 0.05 * i:.3f} Y{0.04 * (i % 2) + 0.05 * i:.3f}" for i in range(1500)]
    path = tmp_path / "tiny.gcode"
    path.write_text("\n".join(lines))
    machine = tmp_path / "slow.toml"
    shipped = files("passo.config").joinpath("machines", "i3.toml").read_text()
    machine.write_text(shipped + "budget = { link_bytes_s = 3000 }\n")
    words = [str(path), "--machine", str(machine)]
    free, slow = printed(capsys, str(path)), printed(capsys, *words)
    assert free["budget"]["worst"] == {}
    assert free["budget"]["widened_s"] == free["budget"]["tolerance_us"] == 0.0
    asked = free["budget"]["densest"]
    assert asked.keys() == {"steps", "commands", "slots"}
    assert asked["slots"]["load"] > 0.3
    given = slow["budget"]["densest"]["link"]
    assert 0.9 < given["load"] < 1.5  # all of 0.15 s, and a burst of 0.06 s
    assert 2 <= given["line"] <= len(lines)
    assert slow["limits"]["link"] > 1.0
    assert slow["move_time_s"] > 1.2 * free["move_time_s"]
    assert slow["budget"]["tolerance_us"] == 25.0
    assert slow["queue_step_commands"] < free["queue_step_commands"]
    assert slow["final_steps"] == free["final_steps"] == slow["net_steps_expected"]
    worst = slow["budget"]["worst"]["link"]
    assert main(["estimate", *words]) == 0
    out = capsys.readouterr().out
    place = re.escape(f"{worst['load']:.2f} times at {path}:{worst['line']}")
    assert re.search(f"^more than the link takes +{place}$", out, re.MULTILINE)
    assert re.search("^wider step tolerance +up to 25.0 µs, for ", out, re.MULTILINE)
    assert main(["explain", f"{path}:{worst['line']}", "--machine", str(machine)]) == 0
    out = capsys.readouterr().out
    assert "speed is bound by: link" in out
    assert "its steps may miss their ideal times by 25.0 µs" in out


def test_a_move_of_ten_metres_of_filament_takes_little_memory(tmp_path):
    """Its steps become commands in blocks; only their times, 8 bytes each, are there at once."""
    path = tmp_path / "p.gcode"
    found = []
    for mm in (10, 9999):
        path.write_text(f"G92 E0\nG1 E{mm} F6000\n")
        words = [sys.executable, "-m", "passo", "print", str(path), "--assume-ready", "--json"]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        found.append(json.loads(done.stdout))
        assert found[-1]["final_steps"] == found[-1]["net_steps_expected"]
    little, much = found
    assert much["steps"]["e"] == 954_905  # 95.5 steps for a mm, rounded up from the half
    assert much["step_error_us"]["max"] <= 2.0 + 0.5 / 16 + 1e-3
    assert much["process_peak_rss_mb"] - little["process_peak_rss_mb"] < 20


@pytest.mark.parametrize("text", ["G90\n", "n1 g 021\n", "M117 hi\n", "T0\n", "M862.3 P1\n"])
def test_commands_without_a_move_are_a_print(capsys, tmp_path, text):
    path = tmp_path / "a.gcode"
    path.write_text(text)
    assert printed(capsys, str(path))["moves"] == 0


def test_fan_set_repeatedly_in_place_fills_no_board(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nG1 X5 F600\n" + "M106 S50\nM106 S60\n" * 1000 + "G1 X10\n")
    assert printed(capsys, str(path))["errors"] == []
