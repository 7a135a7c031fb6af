"""`passo print` and `passo estimate`: figures, exit statuses, sentences."""

from __future__ import annotations

import errno
import io
import json
import os
import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo import Machine, config
from passo.cli.main import main
from passo.config.load import shipped_text
from passo.errors import InputError
from passo.job.batch.source import chunks

FIELDS = [
    "file", "machine", "lines", "moves", "arcs", "print_time_s", "move_time_s", "heat_time_s",
    "dwell_time_s", "filament_mm", "travel_mm", "layers", "final_position_mm", "steps",
    "final_steps", "net_steps_expected", "reversal_pairs_dropped", "queue_step_commands",
    "wire_bytes", "step_error_us", "limits", "budget", "stream_hash", "warnings", "errors", "cpu_s",
    "process_peak_rss_mb",
]  # fmt: skip


def printed(capsys, *words):
    assert main(["print", *words, "--assume-ready", "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_example_on_the_i3(capsys, unpacked):
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
    ("gear_arcs", "mk3s"): "eaa9b37e5604e29f",
    ("plate_toolchanger", "dual-extruder"): "79c65a015ad8b038",
}


@pytest.mark.parametrize(("file", "machine"), GOLDEN)
def test_golden_streams(capsys, unpacked, file, machine):
    result = printed(capsys, unpacked(file), "--machine", machine, "--levelling", "skip")
    assert result["stream_hash"] == GOLDEN[file, machine]
    assert result["final_steps"] == result["net_steps_expected"]


def test_arcs_and_warnings(capsys, unpacked):
    result = printed(capsys, unpacked("gear_arcs"), "--machine", "mk3s", "--levelling", "skip")
    assert result["arcs"] == 7241
    assert [w.split(": ", 1)[1] for w in result["warnings"]] == [
        "G80 is unknown and was skipped (1 time)",
        "M205: X Y Z E have no effect, because the machine's corners use the junction deviation (J)"
        " (1 time)",
    ]


def test_two_extruders(capsys, unpacked):
    result = printed(capsys, unpacked("plate_toolchanger"), "--machine", "dual-extruder")
    assert sum(result["filament_mm"].values()) == pytest.approx(1662.9, abs=0.1)
    assert result["filament_mm"]["e1"] == pytest.approx(215.4, abs=0.1)


def test_the_table_says_that_the_steps_are_right(capsys, unpacked):
    assert main(["print", unpacked("demo")]) == 0
    out, err = capsys.readouterr()
    assert "net steps at the end        as expected on every motor" in out
    assert err == ""


def test_an_estimate_agrees_with_the_print(capsys, unpacked):
    result = printed(capsys, unpacked("demo"))
    assert main(["estimate", unpacked("demo"), "--json"]) == 0
    estimate = json.loads(capsys.readouterr().out)
    assert estimate["moving_s"] == pytest.approx(result["move_time_s"], rel=1e-9)
    assert estimate["dwell_s"] == 10.0
    assert estimate["heating_s"] == pytest.approx(result["heat_time_s"], abs=1.5)
    parts = estimate["moving_s"] + estimate["heating_s"] + estimate["dwell_s"]
    assert estimate["total_s"] == pytest.approx(parts)
    assert estimate["filament_mm"] == result["filament_mm"]
    assert estimate["layers"] == len(estimate["layers_s"]) == result["layers"] == 15
    unheated = pytest.approx(estimate["moving_s"] + estimate["dwell_s"])
    assert sum(estimate["layers_s"]) + estimate["before_layers_s"] == unheated
    assert sum(estimate["features_s"].values()) == unheated


HEATING = {
    "both heaters at the same time": "M104 S200\nM190 S60\nM109 S200\nG1 X9 F3000\n",
    "one after the other": "M190 S60\nM109 S200\nG1 X9 F3000\n",
    "warm again after a pause that cools": "M109 S200\nM104 S0\nG4 S120\nM109 S210\n",
    "a target that moves delay": "M109 S190\nG1 X100 F600\nM104 S220\nG1 X9\nM116\n",
    "nothing to wait for": "M104 S200\nG1 X9 F3000\nM109 S0\nM190 S20\n",
}


@pytest.mark.parametrize("machine", ["i3", "mk3s", "corexy"])
@pytest.mark.parametrize("text", HEATING.values(), ids=HEATING)
def test_an_estimate_heats_as_long_as_the_print(capsys, tmp_path, text, machine):
    path = tmp_path / "heat.gcode"
    path.write_text(f"G28\n{text}")
    result = printed(capsys, str(path), "--machine", machine)
    estimate = Machine.load(machine).estimate(path)
    assert estimate.heating_s == pytest.approx(result["heat_time_s"], rel=0.015, abs=1.0)
    assert estimate.total_s == pytest.approx(result["print_time_s"], rel=0.015, abs=1.0)
    assert (result["heat_time_s"] > 20) is ("M109 S0" not in text)


def test_an_estimate_names_a_target_out_of_a_heaters_power(tmp_path):
    path = tmp_path / "hot.gcode"
    path.write_text("G28\nM190 S119\nG1 X9 F3000\n")
    weak = shipped_text("i3").replace("full_power_rise_c = 110.0", "full_power_rise_c = 60.0")
    estimate = Machine(config.load_text(weak)).estimate(path)
    assert estimate.warnings == [
        f"{path}: heater bed does not reach 119 °C with the figures of its simulated table, so"
        " heating_s is too short. Correct these figures, or the target."
    ]


def test_estimates_of_several_files_at_once(capsys, tmp_path):
    good, bad, last = (tmp_path / name for name in ("a.gcode", "b.gcode", "c.gcode"))
    good.write_text("G28\nG1 X10 F3000\n")
    bad.write_text("G28\nG1 X999 F3000\n")
    last.write_text("G28\nM190 S50\n")
    paths = [str(path) for path in (good, bad, last, tmp_path / "missing")]
    assert main(["estimate", "--json", *paths]) == 4
    out, err = capsys.readouterr()
    rows = json.loads(out)
    assert [row["file"] for row in rows] == paths
    assert [row["moving_s"] > 0 for row in rows] == [True, False, False, False]
    assert [row["heating_s"] > 60 for row in rows] == [False, False, True, False]
    assert [len(row["errors"]) for row in rows] == [0, 1, 0, 1]
    assert "X 999.000 mm is beyond the limit" in rows[1]["errors"][0]
    assert err.splitlines() == [rows[1]["errors"][0], rows[3]["errors"][0]]
    assert main(["estimate", *paths[:2], paths[2]]) == 4
    assert capsys.readouterr().out.count("\n\nfile  ") == 1
    assert main(["estimate", "--json", paths[0], paths[2]]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2
    assert main(["estimate", "--json", *paths, "--machine", "nothing"]) == 3
    rows = json.loads(capsys.readouterr().out)
    assert ["no machine called" in row["errors"][0] for row in rows] == [True] * 4


def test_layers_of_an_estimate_are_those_of_the_print(capsys, tmp_path):
    path = tmp_path / "layers.gcode"
    layer = ";LAYER_CHANGE\nG1 Z{} F600\nG1 X{} F3000\n"
    path.write_text("G28\nG1 X5 Z1 F3000\n" + layer.format(2, 50) + layer.format(3, 9))
    estimate = Machine.load("i3").estimate(path)
    assert estimate.layers == len(estimate.layers_s) == printed(capsys, str(path))["layers"] == 2
    assert min(estimate.layers_s) > 0 < estimate.before_layers_s


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


BAD = {
    "empty": (b"", [], 4, "holds no command"),
    "noise": (bytes(range(256)) * 40, [], 4, ":1: this is not G-code"),
    "long line": (b"G1 X" + b"1" * 10_000_000, [], 4, "a line is longer than 64 KiB"),
    "nan": (b"G28\nG1 XNaN\n", [], 4, ":2: the word 'X' has no valid number"),
    "huge": (b"G28\nG1 X2000000000\n", [], 4, ":2: the word 'X2000000000'"),
    "F0": (b"G1 X10 F0\n", [], 4, ":1: the feed rate F0 must be above 0"),
    "out of range": (b"G1 X300 F3000\n", [], 4, ":1: X 300.000 mm is beyond the limit of 250.000"),
    "endless": (b"G1 E1000000000\n", [], 4, ":1: extruder e would move 1000000000 mm of filament"),
    "tool": (b"T5\n", [], 4, ":1: tool T5 does not exist: the machine has 1 tool(s)"),
    "delta": (b"G1 X70 Y70 Z10 F3000\n", ["--machine", "delta"], 4, "cannot be reached"),
    "comma": (b"G1 E31,0000\n", [], 4, ":1: 'E31,0000' has a decimal comma. Write a point: E31.0"),
    "target": (b"G28\nM104 S200,5\n", [], 4, ":2: 'S200,5' has a decimal comma"),
    "speed": (b"G28\nSET_VELOCITY_LIMIT ACCEL=5,5\n", [], 4, ":2: '5,5' has a decimal comma"),
    "points": (b"G28\nM104 S1.2.3\n", [], 4, ":2: 'S1.2.3' has two decimal points"),
    "dash": (
        "G28\nM104 S200 — set temp\n".encode(),
        [],
        4,
        ":2: the em dash (U+2014) in '—' is not a character of G-code. Write - for a minus",
    ),
    "blank": (
        "G28\n\xa0G1 X10\n".encode(),
        [],
        4,
        r":2: the no-break space (U+00A0) in '\xa0G1' is not a character of G-code. Replace",
    ),
    "mark": ("G28\n\ufeffG1\n".encode(), [], 4, "the byte order mark (U+FEFF) in"),
    "latin": (b"G28\nM104 S200\xb0\n", [], 4, "the question mark in 'S200?' is not a charac"),
    "latin move": (b"G28\nG1 X\xb05\n", [], 4, "the byte 0xB0 (not UTF-8) in 'X\ufffd5' is"),
    "parameter": (b"G28\n#1=5\n", [], 4, ":2: '#1=5' is a parameter, an expression or a place"),
    "placeholder": (b"M104 S[first_layer]\n", [], 4, ":1: 'S[first_layer]' is a parameter, an ex"),
    "template": (b"M104 S{temp[0]}\n", [], 4, ":1: 'S{temp[0]}' is a parameter, an expression"),
    "utf-16": ("G28\nG1 X5\n".encode("utf-16"), [], 4, ":1: the text is UTF-16, not UTF-8. Save"),
    "hole": (b"G28\n\0\0\nG1 X5\n", [], 4, ":3: text follows the zero bytes of line 2: a part"),
    "ctrl-z": (b"G28\n\x1a\nG1 X5\n", [], 4, ":3: a command follows the Ctrl-Z of line 2"),
    "machine": (b"G1 X1\n", ["--machine", "nothing"], 3, "no machine called 'nothing'"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_sentence(capsys, tmp_path, name):
    data, words, status, sentence = BAD[name]
    path = tmp_path / "bad.gcode"
    path.write_bytes(data)
    assert main(["print", str(path), "--assume-ready", *words]) == status
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert sentence in err


def test_a_print_that_failed_tells_its_warnings_and_its_cost(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nM9999\nG1 X10 F3000\nM9999\nG1 X300\n")
    assert main(["print", str(path), "--assume-ready", "--json"]) == 4
    result = json.loads(capsys.readouterr().out)
    assert result["warnings"] == [f"{path}:2: M9999 is unknown and was skipped (2 times)"]
    assert list(result["cpu_s"]) == ["parse", "plan", "steps", "compress", "wire", "board", "total"]
    assert result["cpu_s"]["total"] > 0
    assert result["process_peak_rss_mb"] > 10
    assert len(result["errors"]) == 1


@pytest.mark.parametrize("command", ["print", "estimate"])
def test_with_json_every_failure_is_an_object(capsys, tmp_path, command):
    assert main([command, "x.gcode", "--machine", "nothing", "--json"]) == 3
    out, err = capsys.readouterr()
    result = json.loads(out)
    assert (result["machine"], len(result["errors"])) == ("nothing", 1)
    assert "no machine called 'nothing'" in result["errors"][0]
    assert err == f"{result['errors'][0]}\n"
    path = tmp_path / "p.gcode"
    path.write_text("G28\n")
    assert main([command, str(path), "--json"]) == 0
    assert (good := json.loads(capsys.readouterr().out))["errors"] == []
    path.write_text("G28\nG1 X300 F3000\n")
    assert main([command, str(path), "--json"]) == 4
    result = json.loads(capsys.readouterr().out)
    assert list(result) == list(good)
    assert [e.split(". ")[0] for e in result["errors"]] == [
        f"{path}:2: X 300.000 mm is beyond the limit of 250.000 mm"
    ]


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("M106 P", "P"),
        ("M106 S255 P ; the second fan", "P"),
        ("M201 X", "X"),
        ("M92 X", "X"),
        ("M104 S", "S"),
        ("M104 Sabc", "S"),
        ("M204 P1000 T", "T"),
        ("M220 S nan", "S"),
        ("M205 J2000000000", "J2000000000"),
        ("m84 s", "S"),
    ],
)
def test_a_word_without_a_number_is_bad_input(capsys, tmp_path, line, word):
    path = tmp_path / "p.gcode"
    path.write_text(f"G28\n{line}\nG1 X10\n")
    for command in ("print", "estimate"):
        assert main([command, str(path)]) == 4
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert f"{path}:2: the word {word!r} has no valid number" in err


def test_letters_that_need_no_number_and_texts(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    lines = ["G28 X Y W", "M84 X Y E", "M220 B", "M220 R", "M104 S nan", "M104 F S20", "M107 F"]
    lines += ["M117 Print X of Y", "M0 Click S", "M20 L", "M23 Part.gco", 'M569 S1 X Y"a"', "M503"]
    path.write_text("\n".join([*lines, "G29 A J", "M862.3 P MK3S"]))
    warnings = printed(capsys, str(path), "--levelling", "skip")["warnings"]
    assert [w.split(": ")[1].split()[0] for w in warnings] == ["M23", "M569", "G29", "M0"]


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("M112", "emergency stop by M112"),
        ("N7 M112*38 ; now", "emergency stop by M112"),
        ("G91 M112", "emergency stop by M112"),
        ("M410", "the print was stopped by M410"),
    ],
)
def test_a_stop_in_a_file_ends_its_print(capsys, tmp_path, line, sentence):
    path = tmp_path / "p.gcode"
    path.write_text(f"G28\nG1 X5 F600\n{line}\nG1 X10\n")
    assert main(["print", str(path), "--assume-ready"]) == 5
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"{path}:3: {sentence}. ")
    code = sentence.split()[-1]
    assert main(["estimate", str(path), "--json"]) == 0  # it tells how long the file would be
    result = json.loads(capsys.readouterr().out)
    assert result["moves"] == 2
    assert result["warnings"] == [
        f"{path}:3: {code} stops a print; the plan goes on behind it (1 time)"
    ]


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("missing.gcode", "No such file or directory"),
        (".", "Is a directory"),
    ],
)
def test_unreadable_paths(capsys, path, why):
    assert main(["print", path, "--assume-ready"]) == 4
    err = capsys.readouterr().err
    assert err == f"{path}: cannot be read: {why}. Check the path and permissions.\n"


def test_a_file_whose_medium_fails_is_named():
    class Torn(io.BytesIO):
        def read(self, size=-1):
            raise OSError(errno.EIO, "Input/output error")

    with pytest.raises(InputError) as error:
        list(chunks(Torn(), "a.gcode"))
    (problem,) = error.value.problems
    told = "a.gcode: cannot be read: Input/output error. Check the path and permissions."
    assert str(problem) == told


def test_policies(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("T5\nG1 X300 F3000\nM0\nM0\nG777\n")
    words = ["--out-of-range", "clamp", "--missing-tool", "ignore"]
    result = printed(capsys, str(path), *words)
    assert result["final_position_mm"]["x"] == 250.0
    assert [w.partition(": ")[2] for w in result["warnings"]] == [
        "G777 is unknown and was skipped (1 time)",
        "M0 waits for a person; nobody is here, so it took no time (2 times)",
        "tool T5 does not exist and was ignored (1 time)",
        "X 300.000 mm is beyond the limit of 250.000 mm; such targets were moved to the limit"
        " (1 time)",
    ]
    assert main(["estimate", str(path), "--json", *words]) == 0
    estimate = json.loads(capsys.readouterr().out)
    assert estimate["warnings"] == result["warnings"]
    assert estimate["moving_s"] == result["move_time_s"] > 0
    for lacking in (words[:2], words[2:]):
        assert main(["estimate", str(path), *lacking]) == 4


def test_clamp_is_reported_once_for_each_axis(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G1 X9 F3000\nG1 X260\nG1 Y-5 X270\nG1 Y-1 X280\nG1 X300 E1\n")
    assert printed(capsys, str(path), "--out-of-range", "clamp")["warnings"] == [
        f"{path}:2: X 260.000 mm is beyond the limit of 250.000 mm;"
        " such targets were moved to the limit (4 times)",
        f"{path}:3: Y -5.000 mm is beyond the limit of 0.000 mm;"
        " such targets were moved to the limit (2 times)",
    ]


def test_unreachable_target_is_reported_with_its_value(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nG1 Z100 F3000\nG1 X70 Y40\nG1 X0 Y80\nG1 X-54 Y-54 E1\n")
    words = [str(path), "--machine", "delta"]
    # Straight from the middle, tried every 2 mm.
    where = "the point X 66.585, Y 38.049, Z 100.000 mm cannot be reached by this machine"
    measure = "it is 76.690 mm from the middle, of at most 75.100 mm"
    assert main(["print", *words, "--assume-ready"]) == 4
    assert f"{path}:3: {where}: {measure}. Move the model" in capsys.readouterr().err
    assert printed(capsys, *words, "--out-of-range", "clamp")["warnings"] == [
        f"{path}:4: Y 80.000 mm is beyond the limit of 75.100 mm; such targets were moved to the"
        " limit (1 time)",
        f"{path}:3: {where}: {measure}; such moves were left out (2 times)",
    ]


def test_retraction_after_skipped_move_stays_in_place(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G92 X0 Y0 Z50\nM83\nG1 X20 F3000\nG1 X74 Y74 Z160\nG1 E2 F300\n")
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    # The towers stand where the point (20, 0, 50) has them, as without the move out of reach.
    path.write_text("G92 X0 Y0 Z50\nM83\nG1 X20 F3000\nG1 E2 F300\n")
    assert result["final_steps"] == printed(capsys, str(path), "--machine", "delta")["final_steps"]


@pytest.mark.parametrize("lines", ["G4 P10", "M83\nG1 Y-74 E-1\nG4 P10\nG1 E1"])
def test_dwell_after_skipped_move_stays_in_place(capsys, tmp_path, lines):
    path = tmp_path / "p.gcode"
    path.write_text(f"G1 X20 F3000\nG1 X68 Y89\n{lines}\nG90\nG1 X13 Y-36\n")
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    path.write_text("G1 X20 F3000\nG1 X13 Y-36\n")
    assert result["final_steps"] == printed(capsys, str(path), "--machine", "delta")["final_steps"]


@pytest.mark.parametrize("mode", ["M83", "M82"])
def test_filament_of_a_move_that_was_left_out_is_left_out(capsys, tmp_path, mode):
    """The next move does not print it too, whichever way E is counted; a retraction is kept."""
    lines = ["G92 X0 Y0 Z50 E0", mode, "G1 X20 F3000 E1", "G1 X74 Y74 Z160 E5"]
    lines += ["G1 X0 E1", "G1 E-1", "G1 E1"] if mode == "M83" else ["G1 X0 E6", "G1 E5", "G1 E6"]
    path = tmp_path / "p.gcode"
    path.write_text("\n".join(lines))
    result = printed(capsys, str(path), "--machine", "delta", "--out-of-range", "clamp")
    assert sum(result["filament_mm"].values()) == pytest.approx(2.0)
    assert result["final_position_mm"]["e"] == pytest.approx(2.0)


def test_wrong_words_are_usage(capsys):
    assert main(["print"]) == 2
    assert main(["print", "x.gcode", "--clock", "fish"]) == 2
    capsys.readouterr()


@pytest.mark.parametrize(
    ("words", "limit"),
    [
        (["print", "x.gcode"], "virtual, real, or a factor from 0.001 to 1,000,000"),
        (["serve"], "fast, real, or a factor from 0.001 to 1,000"),
    ],
)
@pytest.mark.parametrize("scale", ["1e-9", "0", "1e9", "nan", "inf"])
def test_a_clock_keeps_to_what_a_computer_can_wait(capsys, words, limit, scale):
    assert main([*words, "--clock", scale]) == 2
    assert f"'{scale}' is not {limit}" in capsys.readouterr().err


def test_an_unsafe_temperature_is_a_warning_and_heats_nothing(tmp_path, capsys):
    path = tmp_path / "hot.gcode"
    path.write_text("G28\nM104 S999\nG1 X10 F3000\n")
    assert main(["print", str(path), "--assume-ready", "--json"]) == 0
    (warning,) = json.loads(capsys.readouterr().out)["warnings"]
    assert warning.startswith(f"{path}:2: M104: heater hotend was switched off: 999 °C is outside")


def test_foreign_commands_get_one_warning_each(capsys, tmp_path):
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


def test_codes_without_end_are_counted_together(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("".join(f"O{i}\n" for i in range(1, 1501)) + "M400\n")
    warnings = printed(capsys, str(path))["warnings"]
    assert len(warnings) == 1001
    assert warnings[999] == f"{path}:1000: O1000 is unknown and was skipped (1 time)"
    assert warnings[1000] == f"{path}:1001: any other code is unknown and was skipped (500 times)"


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("G1 X2000000000", "X2000000000"),
        ("G1 X-1000000000.5", "X-1000000000.5"),
        ("G1 X1" + "0" * 20, "X1" + "0" * 20),
        ("G1 X1" + "0" * 40, "X1e+40"),
        ("M204 S2000000000", "S2000000000"),
        ("SET_VELOCITY_LIMIT VELOCITY=1e400", "VELOCITY=1e400"),
        ("SET_VELOCITY_LIMIT ACCEL=inf", "ACCEL=inf"),
        ("SET_VELOCITY_LIMIT ACCEL=2000000000", "ACCEL=2000000000"),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=nan", "SQUARE_CORNER_VELOCITY=nan"),
    ],
)
def test_a_word_beyond_1e9_is_named_as_written(capsys, tmp_path, line, word):
    path = tmp_path / "p.gcode"
    path.write_text(f"G28\n{line}\n")
    assert main(["print", str(path), "--assume-ready"]) == 4
    assert f"{path}:2: the word '{word}' has no valid number" in capsys.readouterr().err


SENSELESS = {
    "M220 S0": "S is 0: expected 10 to 1000 percent",
    "M220 S-5": "S is -5: expected 10 to 1000 percent",
    "M221 S0": "S is 0: expected 1 to 1000 percent",
    "M201 X0": "X is 0: expected at least 0.1 mm/s²",
    "M203 X-5 Y100": "X is -5: expected at least 0.001 mm/s",
    "M204 S0": "S is 0: expected at least 0.1 mm/s²",
    "M204 P500 T-1": "T is -1: expected at least 0.1 mm/s²",
    "M205 J0": "J is 0: expected 1e-05 to 0.3 mm",
    "SET_VELOCITY_LIMIT VELOCITY=0": "VELOCITY is 0: expected at least 0.001 mm/s",
    "SET_VELOCITY_LIMIT ACCEL=-1": "ACCEL is -1: expected at least 0.1 mm/s²",
    "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=1": (
        "MINIMUM_CRUISE_RATIO is 1: expected 0 to less than 1"
    ),
}


@pytest.mark.parametrize("line", SENSELESS)
def test_values_without_sense_are_warnings_and_change_nothing(capsys, tmp_path, line):
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


def test_limits_beyond_the_machines_are_warned_of(capsys, tmp_path):
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


@pytest.mark.parametrize(
    ("line", "option"), [("G1 X999", "--out-of-range clamp"), ("T7", "--missing-tool ignore")]
)
def test_options_are_named_where_there_are_some(line, option, capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text(f"{line}\nG1 X1 F600\n")
    assert main(["print", str(path), "--assume-ready"]) == 4
    assert f"or allow {option}." in capsys.readouterr().err
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        refusal = s.host.ok(line)[0]
        assert refusal.startswith("echo:")
        assert "--" not in refusal


@pytest.mark.parametrize(
    "words",
    [
        ["print", "FILE", "--assume-ready"],
        ["print", "FILE", "--assume-ready", "--json"],
        ["print", "missing.gcode", "--json"],
        ["estimate", "FILE", "--json"],
        ["check", "missing.toml", "--json"],
        ["machines"],
    ],
)
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_standard_output_that_is_full_is_one_sentence(tmp_path, words, unbuffered):
    path = tmp_path / "a.gcode"
    path.write_text("G28\nG1 X10 F6000\n")
    words = [word.replace("FILE", str(path)) for word in words]
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "passo", *words]
        environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
        run = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, text=True, env=environment
        )
    assert run.returncode == 4
    assert run.stderr.splitlines()[-1] == (
        "standard output: cannot be written: No space left on device."
        " Check the path, its permissions and the free space."
    )
    assert "Traceback" not in run.stderr
    assert "ignored" not in run.stderr


def test_a_reader_that_has_gone_is_no_error():
    command = f"{sys.executable} -m passo machines | true; echo ${{PIPESTATUS[0]}}"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert (run.stdout, run.stderr) == ("0\n", "")


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["print", "missing.gcode", "--json"], 4),
        (["check", "missing.toml", "--json"], 3),
    ],
)
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_has_gone_hides_no_error(words, status, unbuffered):
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "passo", *words]
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    run = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, env=environment)
    os.close(writer)
    assert run.returncode == status
    assert "Traceback" not in run.stderr


def test_full_disk_is_reported_only_if_output_was_lost():
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "passo", "check", "missing.toml"]
        run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert run.returncode == 3
    assert [line.partition(":")[0] for line in run.stderr.splitlines()] == ["missing.toml"]


def test_a_closed_standard_output_is_no_error():
    command = f"{sys.executable} -m passo machines >&-"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.parametrize(("text", "status"), [("G1 X1 F600\nM9999\n", 0), ("G1 X-9\n", 4)])
@pytest.mark.parametrize("form", ["", "--json"])
def test_closed_standard_error_loses_only_messages(tmp_path, text, status, form):
    """Nor do they come out elsewhere: with --json there is one object and nothing else."""
    path = tmp_path / "a.gcode"
    path.write_text(text)
    command = f"{sys.executable} -m passo print {path} --assume-ready {form} 2>&-"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert run.returncode == status
    assert "M9999" not in run.stdout or form
    if form:
        told = json.loads(run.stdout)
        assert len(told["warnings"] + told["errors"]) == 1


@pytest.mark.parametrize(("text", "status"), [("G1 X1 F600\nM9999\nM9998\n", 0), ("G1 X-9\n", 4)])
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_standard_error_changes_nothing_else(tmp_path, text, status, unbuffered):
    path = tmp_path / "a.gcode"
    path.write_text(text)
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "passo", "print", str(path), "--assume-ready", "--json"]
        environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
        run = subprocess.run(command, stdout=-1, stderr=full, text=True, env=environment)
    assert run.returncode == status
    told = json.loads(run.stdout)
    assert bool(told["errors"]) == (status == 4)


@pytest.mark.parametrize("command", ["print", "estimate", "steps", "report"])
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("solid a\nfacet normal 0 0 1\nendsolid a\n", "holds no command that is known."),
        ("Dear printer,\nplease print two.\nG9999\n", "holds no command that is known."),
        ("; nothing\n\n(at all)\n%\n", "holds no command."),
    ],
)
def test_a_text_without_commands_is_bad_input(capsys, tmp_path, command, text, says):
    path, output = tmp_path / "a.gcode", tmp_path / "a.npz"
    path.write_text(text)
    words = ["--output", str(output)] if command in ("steps", "report") else []
    assert main([command, str(path), *words]) == 4
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{path}: {says} ")
    assert not output.exists()


@pytest.mark.parametrize("text", ["G90\n", "n1 g 021\n", "M117 hi\n", "T0\n", "M862.3 P1\n"])
def test_commands_without_a_move_are_a_print(capsys, tmp_path, text):
    path = tmp_path / "a.gcode"
    path.write_text(text)
    assert printed(capsys, str(path))["moves"] == 0


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("G28\nG1 X10 F600\nG1 X2", [3]),
        ("G28\nG1 X10 F600\nN3 g1", [3]),
        ("G28\nG1 X10 F600\nG1 X2\n", []),
        ("G28\nG1 X10 F600\nM84", []),
        ("G28\nG1 X10 F600\nG10", []),
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


@pytest.mark.parametrize(("text", "status"), [("G28\nG1 X10 F600\n", 0), ("", 4)])
def test_a_pipe_is_a_file(text, status):
    command = [sys.executable, "-m", "passo", "estimate", "/dev/stdin"]
    run = subprocess.run(command, input=text, capture_output=True, text=True)
    assert run.returncode == status
    assert run.stderr.startswith("/dev/stdin: holds no command.") == (status == 4)


def test_an_empty_name_is_named(capsys):
    assert main(["print", ""]) == 4
    assert capsys.readouterr().err.startswith("'': cannot be read: the name is empty.")


def test_commands_that_need_passo_serve_are_named(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("M302 S0\nG28\nM92 E415\nM206 X1\nG1 X5 F600\nM92 E95.5\nM81\n")
    assert printed(capsys, str(path))["warnings"] == [
        f"{path}:3: M92 is for a printer that is served and was skipped (2 times)",
        f"{path}:4: M206 is for a printer that is served and was skipped (1 time)",
        f"{path}:7: M81 is for a printer that is served and was skipped (1 time)",
    ]


def test_fan_set_repeatedly_in_place_fills_no_board(capsys, tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text("G28\nG1 X5 F600\n" + "M106 S50\nM106 S60\n" * 1000 + "G1 X10\n")
    assert printed(capsys, str(path))["errors"] == []
