"""The progress bar: on a terminal, and nowhere else."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from itertools import pairwise
from math import inf

import pytest

from passo import config
from passo.cli.clock import Pace
from passo.cli.tables import duration
from passo.job.batch.simulated_print import Print

PROGRAM = "M109 S50\nG28\n;LAYER:0\nG1 X50 F6000\n;LAYER:1\nG1 X90 Z1 E1\n;LAYER:2\nG1 X20 E3\n"


@pytest.fixture
def command(tmp_path):
    path = tmp_path / "p.gcode"
    path.write_text(PROGRAM)
    return [sys.executable, "-m", "passo", "print", str(path), "--assume-ready"]


def test_a_terminal_shows_layer_time_left_and_temperatures(command):
    ours, theirs = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "200", "LANG": "C.UTF-8"}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=theirs, env=environment, text=True
    ) as printing:
        os.close(theirs)
        shown = b""
        while piece := _read(ours):
            shown += piece
        table = printing.stdout.read()
    os.close(ours)
    assert printing.returncode == 0
    assert "as expected on every motor" in table
    last = shown.decode().rpartition("layer")[2]
    assert last.split()[0] == "3"
    assert " printed, " in last
    assert "s left" in last
    assert "100%" in last
    assert re.search("hotend (49|50|51) °C", last)
    assert "bed 25 °C" in last


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # nobody has the other end any more
        return b""


def test_progress_waits_for_the_print_clock(monkeypatch):
    now, slept = [100.0], []

    def sleep(seconds):
        slept.append(seconds)
        now[0] += seconds

    monkeypatch.setattr("passo.cli.clock.time.monotonic", lambda: now[0])
    monkeypatch.setattr("passo.cli.clock.time.sleep", sleep)
    pace = Pace(2.0)
    now[0] += 0.5
    pace.keep(3.0)
    pace.keep(3.0)
    pace.keep(4.0)
    now[0] += 60
    pace.keep(5.0)  # it is late, and does not wait
    Pace(None).keep(1e9)
    assert slept == [1.0, 0.5]
    assert (pace.every_s, Pace(None).every_s) == (2 * Pace(1.0).every_s, inf)


def test_progress_is_even_with_a_slow_clock(unpacked):
    """However much is planned at once, the board advances in small parts of print time."""
    path, seen = unpacked("demo"), []
    machine = config.load("i3")
    stream = Print(machine).run(path).stream_hash
    assert Print(machine, None, seen.append, 0.5).run(path).stream_hash == stream
    times, shares, layers = zip(*((at.print_s, at.share, at.layer) for at in seen), strict=True)
    assert max(b - a for a, b in pairwise([0.0, *times])) <= 0.5 + 1e-6
    assert list(shares) == sorted(shares)
    assert list(layers) == sorted(layers)
    assert (shares[-1], layers[-1]) == (1.0, 15)
    # Of what is read the board has done so much: no jumps ahead.
    printing = [s for s in shares if 0 < s < 1]
    assert max(b - a for a, b in pairwise(printing)) < 0.02


def test_a_short_file_is_read_at_once_and_printed_slowly(tmp_path):
    path, seen = tmp_path / "a.gcode", []
    path.write_text("G1 X10 F60\nG1 X20\nG1 X30\nG1 X40\n")
    Print(config.load("i3"), None, seen.append, 1.0).run(path)
    shares = [{at.share for at in seen if t < at.print_s < t + 8} for t in (1, 11, 21, 31)]
    assert shares == [{0.0}, {0.25}, {0.5}, {0.75}]
    assert seen[-1].share == 1


def test_time_left_does_not_include_heating(tmp_path):
    """A hundred strokes, of which as many a second are done."""
    path, seen = tmp_path / "a.gcode", []
    path.write_text("M109 S200\nG28\n" + "G1 X10 F600\nG1 X0\n" * 50)
    result = Print(config.load("i3"), None, seen.append, 1.0).run(path)
    assert result.heat_time_s > 0.4 * result.move_time_s
    assert seen[0].left_s is None
    told = [(at.left_s, result.print_time_s - at.print_s) for at in seen if at.share > 0.1]
    assert len(told) > 80
    assert [left for left, _ in told] == pytest.approx([true for _, true in told], abs=10)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.0 s"),
        (59.94, "59.9 s"),
        (59.96, "1 min 00 s"),
        (60.0, "1 min 00 s"),
        (3599.4, "59 min 59 s"),
        (3599.6, "1 h 00 min 00 s"),
        (90_061.0, "25 h 01 min 01 s"),
    ],
)
def test_durations_are_shown_in_readable_units(seconds, text):
    assert duration(seconds) == text


def test_the_progress_of_a_pipe_is_unknown():
    read, write = os.pipe()
    os.write(write, b"G1 X10 F600\nG1 X20\n")
    os.close(write)
    seen = []
    Print(config.load("i3"), None, seen.append, 0.5).run(f"/dev/fd/{read}")
    os.close(read)
    assert {(at.share, at.left_s) for at in seen} == {(0.0, None)}
    assert seen[-1].print_s > 2


def test_no_progress_bar_goes_into_a_pipe(command):
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert "layer " not in done.stdout
    assert "\x1b" not in done.stdout
