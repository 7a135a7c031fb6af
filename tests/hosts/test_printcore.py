"""Printrun's printcore prints on `passo serve`."""

import json
import subprocess
from pathlib import Path

import pytest
from tests.hosts.noise import Noise

DRIVER = str(Path(__file__).with_name("printcore_print.py"))


@pytest.fixture
def printed(hosts, program):
    """Prints with printcore; returns what it has seen."""

    def run(port, **events):
        options = [x for k, v in events.items() for x in (f"--{k}-at", str(v))]
        words = [str(hosts / "python"), DRIVER, port, str(program.path), *options]
        done = subprocess.run(words, capture_output=True, text=True, timeout=100)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout or "{}")

    return run


def assert_at_end(printer, program):
    at = printer.position()
    for axis, value in program.end.items():
        assert at[axis] == pytest.approx(value, abs=0.0021), axis
    assert at["steps_x"] == pytest.approx(program.end["x"] * 80, abs=1)
    assert at["steps_y"] == pytest.approx(program.end["y"] * 80, abs=1)
    assert at["steps_z"] == pytest.approx(program.end["z"] * 400, abs=1)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_it_prints_to_the_end(printer, program, printed, way):
    seen = printed(getattr(printer, way))
    assert seen["resends"] == 0
    assert_at_end(printer, program)


def test_a_line_that_came_in_damaged_is_printed_once(printer, program, printed, tmp_path):
    noise = Noise(seed=2).on_pty(printer.pty, tmp_path / "noisy")
    try:
        seen = printed(str(tmp_path / "noisy"))
    finally:
        noise.close()
    assert noise.damaged >= 10
    assert seen["resends"] >= noise.damaged
    assert_at_end(printer, program)


def test_a_pause_loses_nothing(printer, program, printed):
    seen = printed(printer.pty, pause=600)
    assert seen["paused_at"] >= 600
    assert seen["sent_in_pause"] <= 1
    assert_at_end(printer, program)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_after_a_cancel_it_prints_again(printer, program, printed, way):
    seen = printed(getattr(printer, way), cancel=600)
    assert seen["cancelled_at"] < program.lines - 100
    printed(getattr(printer, way))
    assert_at_end(printer, program)


@pytest.mark.parametrize("way", ["pty", "tcp"])
def test_a_host_that_vanished_in_mid_print_comes_back(printer, program, printed, way):
    printed(getattr(printer, way), vanish=600)
    printed(getattr(printer, way))
    assert_at_end(printer, program)
