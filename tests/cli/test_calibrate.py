"""`passo calibrate thermistor`: with given points, and as a guide."""

from __future__ import annotations

import fcntl
import io
import os
import re
import signal
import subprocess
import sys
import termios
from functools import partial

import pytest

from passo.cli.main import main


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def guide(monkeypatch, answers, *words):
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers))
    return main(["calibrate", "thermistor", *words])


def test_given_points_become_a_sensor_table(capsys):
    points = ["180:169", "200:177", "220:194", "240:208"]
    assert main(["calibrate", "thermistor", "--points", *points]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[1].split() == ["180.0", "169.0", "-13.4", "-7.6"]
    assert out[4].split() == ["240.0", "208.0", "-5.6", "+3.3"]
    assert out[-2].split() == ["β", "in", "K", "4436", "4304"]
    assert out[-1] == "To use the fit: M305 H0 B4304, then M303 H0 U, then M500."


def test_guided_calibration_asks_for_each_point(capsys, monkeypatch):
    answers = "150\nwarm\n168\n\n204\n222\n"  # 160, 180 (twice), 200 left out, 220, 240
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers + "160\nq\n"))
    assert main(["calibrate", "thermistor"]) == 0
    out = capsys.readouterr().out
    assert "wait two minutes" in out
    assert out.count("M104 S180") == 2  # asked again after what is no number
    assert out.count("M104 S170") == 1  # the second round ends here
    assert "M104 S250" not in out
    assert "'180:warm' is not a pair of temperatures" in out
    first, second = out.split("Round in steps of 10 °C")
    assert "   220.0    204.0" in first
    assert "   160.0    160.0      +0.0      +0.0" in second
    assert out.count("To use the fit") == 2


@pytest.mark.parametrize(
    ("heater", "true", "first", "last", "number"),
    [
        ("hotend1", 150, "M104 T1 S160,", "M104 T1 S240,", "H1"),
        ("bed", 39, "M140 S40,", "M140 S120,", "H-1"),
    ],
)
def test_guide_lists_the_command_for_each_heater(
    capsys, monkeypatch, heater, true, first, last, number
):
    words = ("--machine", "dual-extruder", "--heater", heater)
    assert guide(monkeypatch, f"{true}\n" + 4 * "\n", *words) == 0
    out = capsys.readouterr().out
    asked = re.findall(r"M1\d\d [^,]*,", out)
    assert (asked[0], asked[4]) == (first, last)
    assert f"M305 {number} B" in out
    assert f"M303 {number} U," in out


@pytest.mark.parametrize(
    ("words", "status", "says"),
    [
        (["--heater", "hotnd"], 3, "Did you mean 'hotend'"),
        (["--beta", "4"], 3, "a β from 1000 to 10000 K"),
        (["--points", "180"], 4, "'180' is not a pair of temperatures"),
        (["--points", "180:nan"], 4, "'180:nan' is not a pair of temperatures"),
        (["--points", "180:400"], 4, "400 °C is too far from the 180 °C that is shown: expected 1"),
        (["--points", "180:100"], 4, "expected 120 to 240"),
        (["--points", "200:169", "180:177"], 4, "the true 169 °C at 200 °C shown is not above the"),
    ],
)
def test_wrong_options_are_refused(capsys, words, status, says):
    assert main(["calibrate", "thermistor", *words]) == status
    assert says in capsys.readouterr().err


def test_impossible_answers_are_asked_for_again(capsys, monkeypatch):
    answers = "1600\n16\n150\n149,5\n168,5\n"  # 160 (three times), 180 (twice)
    assert guide(monkeypatch, answers) == 0
    out = capsys.readouterr().out
    assert out.count("M104 S160,") == 3
    assert "'160:1600' is not a pair of temperatures" in out
    assert "from 0 to 400 °C. Type the true one alone, as 187.\n" in out
    assert "16 °C is too far from the 160 °C that is shown: expected 107 to 213" in out
    assert "the true 149.5 °C at 180 °C shown is not above the true 150 °C at 160 °C shown" in out
    assert "   180.0    168.5" in out


def test_a_round_ends_before_the_true_temperature_is_too_high(capsys, monkeypatch):
    assert guide(monkeypatch, "180\n203\n221\nq\nq\nq\n") == 0
    assert "M104 S220," in capsys.readouterr().out  # a degree is the thermometer's own error
    assert guide(monkeypatch, "180\n203\n222\nq\nq\n") == 0
    out = capsys.readouterr().out
    first = out.partition("Round in steps of 10")[0]
    assert "M104 S220," not in first
    assert "220 °C would truly be 242 °C or so: the round ends here." in first


def test_a_wrong_answer_can_be_taken_back(capsys, monkeypatch):
    answers = "b\n200\n169\nb\n150\n\nb\nb\n151\n169\nq\n"
    assert guide(monkeypatch, answers) == 0
    out = capsys.readouterr().out
    assert "   160.0    151.0" in out
    assert "   180.0    169.0" in out
    assert "200.0" not in out
    assert out.count("M104 S160,") == 5


def test_interrupted_calibration_continues(capsys, monkeypatch, tmp_path):
    whole = "150\n168\nb\n169\n\n204\n222\n" + 9 * "\n" + "155\n"
    assert guide(monkeypatch, whole) == 0
    wanted = capsys.readouterr().out
    file = tmp_path / "thermistor-hotend.txt"
    kept = file.read_text().splitlines()
    assert kept[1:] == whole.splitlines()
    file.unlink()
    for i in range(0, len(whole.splitlines()), 4):
        assert guide(monkeypatch, "".join(whole.splitlines(keepends=True)[i : i + 4])) == 0
        out = capsys.readouterr().out
        assert (f"It holds {i} answers" in out) == (i > 0)
    results = [part for part in out.split("\n\n") if "To use the fit" in part]
    assert [part[part.index("shown") :] for part in results] == [
        part[part.index("shown") :] for part in wanted.split("\n\n") if "To use the fit" in part
    ]
    assert len(results) == 2


def test_a_round_survives_a_terminal_that_closes(tmp_path):
    program = [sys.executable, "-m", "passo", "calibrate", "thermistor"]
    leader, follower = os.openpty()
    default = partial(signal.signal, signal.SIGHUP, signal.SIG_DFL)  # not as who runs the tests

    def own_terminal():
        default()
        os.setsid()
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    guided = subprocess.Popen(
        program, stdin=follower, stdout=follower, stderr=follower, preexec_fn=own_terminal
    )
    os.close(follower)
    heard = b""
    for question, answer in ((b"S160,", b"150\n"), (b"S180,", b"168\n"), (b"S200,", b"")):
        while question not in heard:
            heard += os.read(leader, 1000)
        os.write(leader, answer)
    os.close(leader)
    guided.wait(10)
    done = subprocess.run(program, input="", capture_output=True, text=True)
    assert "It holds 2 answers" in done.stdout
    assert "   180.0    168.0" in done.stdout


def test_finished_calibration_leaves_no_stored_answers(capsys, monkeypatch, tmp_path):
    assert guide(monkeypatch, "150\nq\nq\n155\nq\n") == 0
    assert not list(tmp_path.iterdir())
    assert guide(monkeypatch, "") == 0  # nobody has said anything
    assert not list(tmp_path.iterdir())
    assert capsys.readouterr().out.count("To use the fit") == 2


def test_stored_answers_of_another_run_are_refused(capsys, monkeypatch, tmp_path):
    assert guide(monkeypatch, "150\n") == 0
    assert guide(monkeypatch, "150\n", "--beta", "4000") == 4
    told = capsys.readouterr().err
    assert "thermistor-hotend.txt: it begins with 'passo calibrate thermistor: hotend of i3" in told
    assert "Delete the file, or start in another folder" in told
    (tmp_path / "thermistor-bed.txt").write_bytes(b"\xff\xfe")
    assert guide(monkeypatch, "50\n", "--heater", "bed") == 4
    (tmp_path / "thermistor-bed.txt").unlink()
    (tmp_path / "thermistor-bed.txt").mkdir()
    assert guide(monkeypatch, "50\n", "--heater", "bed") == 4
    assert "cannot be written" in capsys.readouterr().err
