"""`passo calibrate thermistor`: with given points, and as a guide."""

from __future__ import annotations

import io
import re
import sys

import pytest

from passo.cli.main import main


def test_given_points(capsys):
    points = ["180:169", "200:177", "220:194", "240:208"]
    assert main(["calibrate", "thermistor", "--points", *points]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[1].split() == ["180.0", "169.0", "-13.4", "-7.6"]
    assert out[4].split() == ["240.0", "208.0", "-5.6", "+3.3"]
    assert out[-2].split() == ["β", "in", "K", "4436", "4304"]
    assert out[-1] == "To use the fit: M305 H0 B4304, then M303 H0, then M500."


def test_the_guide(capsys, monkeypatch):
    answers = "150\nwarm\n168\n\n204\n222\n"  # 160, 180 (twice), 200 left out, 220, 240
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers + "160\nq\n"))
    assert main(["calibrate", "thermistor"]) == 0
    out = capsys.readouterr().out
    assert "wait two minutes" in out
    assert out.count("M104 S180") == 2  # asked again after what is no number
    assert out.count("M104 S170") == 1  # the second round ends here
    assert "M104 S250" not in out
    assert "'180:warm' is no pair of temperatures" in out
    first, second = out.split("Round in steps of 10 °C")
    assert "   220.0    204.0" in first
    assert "   160.0    160.0      +0.0      +0.0" in second
    assert out.count("To use the fit") == 2


@pytest.mark.parametrize(
    ("heater", "first", "last", "number"),
    [
        ("hotend1", "M104 T1 S160,", "M104 T1 S240,", "H1"),
        ("bed", "M140 S40,", "M140 S120,", "H-1"),
    ],
)
def test_the_guide_says_how_each_heater_is_heated(capsys, monkeypatch, heater, first, last, number):
    monkeypatch.setattr(sys, "stdin", io.StringIO("50\n" + 4 * "\n"))
    assert main(["calibrate", "thermistor", "--machine", "dual-extruder", "--heater", heater]) == 0
    out = capsys.readouterr().out
    asked = re.findall(r"M1\d\d [^,]*,", out)
    assert (asked[0], asked[4]) == (first, last)
    assert f"M305 {number} B" in out
    assert f"M303 {number}," in out


@pytest.mark.parametrize(
    ("words", "status", "says"),
    [
        (["--heater", "hotnd"], 3, "Did you mean 'hotend'"),
        (["--beta", "4"], 3, "a β from 1000 to 10000 K"),
        (["--points", "180"], 4, "'180' is no pair of temperatures"),
        (["--points", "180:nan"], 4, "'180:nan' is no pair of temperatures"),
    ],
)
def test_what_is_refused(capsys, words, status, says):
    assert main(["calibrate", "thermistor", *words]) == status
    assert says in capsys.readouterr().err
