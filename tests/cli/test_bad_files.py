"""What `passo print` refuses: exit status, and one sentence with file and line."""

from __future__ import annotations

import errno
import io
import json

import pytest
from tests.support.print_result import printed

from passo.cli.main import main
from passo.errors import InputError
from passo.job.batch.source import chunks

BAD = {
    "empty": (b"", [], 4, "holds no command"),
    "noise": (bytes(range(256)) * 40, [], 4, ":1: this is not G-code"),
    "long line": (b"G1 X" + b"1" * 10_000_000, [], 4, "a line is longer than 64 KiB"),
    "nan": (b"G28\nG1 XNaN\n", [], 4, ":2: the word 'X' has no valid number"),
    "huge": (b"G28\nG1 X2000000000\n", [], 4, ":2: the word 'X2000000000'"),
    "F0": (b"G1 X10 F0\n", [], 4, ":1: the feedrate F0 must be above 0"),
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


def test_a_print_that_failed_reports_its_warnings_and_its_cost(capsys, tmp_path):
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
    lines += ["M117 Print X of Y", "M0 Click S", "M20 L", "M23 Part.gco", "M569 S1 X Y", "M503"]
    path.write_text("\n".join([*lines, "G29 A J", "M862.3 P MK3S"]))
    warnings = printed(capsys, str(path), "--levelling", "skip")["warnings"]
    assert [w.split(": ")[1].split()[0] for w in warnings] == ["M569", "G29", "M0", "M23"]


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
    assert main(["estimate", str(path), "--json"]) == 5
    assert f"{path}:3: {sentence}. " in capsys.readouterr().out
    # a piece: it tells how long the file would be
    assert main(["estimate", str(path), "--assume-ready", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["moves"] == 2
    assert result["warnings"] == [
        f"{path}:3: {code} stops a print; the plan continues after it (1 time)"
    ]


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("missing.gcode", "No such file or directory"),
        (".", "Is a directory"),
    ],
)
def test_unreadable_paths_are_named(capsys, path, why):
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


def test_wrong_options_are_usage_errors(capsys):
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
def test_extreme_clock_scale_is_refused(capsys, words, limit, scale):
    assert main([*words, "--clock", scale]) == 2
    assert f"'{scale}' is not {limit}" in capsys.readouterr().err


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


def test_an_empty_name_is_named(capsys):
    assert main(["print", ""]) == 4
    assert capsys.readouterr().err.startswith("'': cannot be read: the name is empty.")
