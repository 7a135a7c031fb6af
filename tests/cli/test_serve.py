"""`passo serve` as a process: how it ends."""

from __future__ import annotations

import argparse
import re
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
from tests.config.test_import_klipper import BASE

from passo.cli import serve
from passo.cli.main import endings, main
from passo.cli.simulated_state import simulated_state
from passo.config import shipped_text

ENDINGS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP]


@pytest.mark.parametrize("number", ENDINGS, ids=lambda number: number.name)
def test_interrupt_ends_serve_in_order(tmp_path, number):
    # Whoever runs the tests in the background may have it ignore some, and its children too.
    heeded = partial(signal.signal, number, signal.SIG_DFL)
    link = tmp_path / "printer"
    words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--pty", str(link)]
    words += ["--http", "none"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, preexec_fn=heeded) as served:
        assert served.stderr is not None
        assert served.stderr.readline().startswith("Serving i3 on")
        assert link.is_symlink()
        served.send_signal(number)
        assert "Traceback" not in served.stderr.read()
        assert served.wait() == 0
    assert not link.is_symlink()


def test_serve_survives_its_terminal_with_nohup():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert endings() == [signal.SIGTERM]
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        assert endings() == [signal.SIGTERM, signal.SIGHUP]
    finally:
        signal.signal(signal.SIGHUP, before)


def test_any_machine_runs_on_simulated_boards(tmp_path):
    """Two serial ports that do not exist; the state of the real printer stays as it is."""
    tool = '\n[boards.tool]\nbase = "ramps"\nlink = "serial"\nport = "/dev/no-tool"\n'
    text = shipped_text("i3").replace("[board]\n", '[board]\nlink = "serial"\nport = "/dev/no"\n')
    machine, state = tmp_path / "mine.toml", tmp_path / "state"
    machine.write_text(text.replace('socket = "E0"', 'socket = "tool:E0"') + tool)
    words = [sys.executable, "-m", "passo", "serve", "--machine", str(machine), "--simulated"]
    words += ["--clock", "fast", "--stdin", "--http", "none", "--state", str(state)]
    lines = "G28\nM109 S200\nG1 X50 E2 F3000\nM400\nM114\nM206 X1\nM500\nM408 S0\n"
    run = subprocess.run(words, input=lines, capture_output=True, text=True)
    assert run.returncode == 0
    assert run.stderr.startswith("Serving i3, simulated, on")
    assert "X:50.000 Y:0.000 Z:0.000 E:2.0000 Count X:4000 Y:0 Z:0" in run.stdout
    assert [path.name for path in state.iterdir()] == ["simulated"]
    assert (state / "simulated" / "settings.json").exists()


def test_simulated_printer_begins_with_copies_of_meshes_and_settings(tmp_path: Path):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "default.json").write_text("imported")
    (tmp_path / "settings.json").write_text("stored")
    (tmp_path / "journal").write_text("a place of the real printer")
    own = simulated_state(tmp_path)
    assert sorted(path.name for path in own.iterdir()) == ["meshes", "settings.json"]
    assert (own / "meshes" / "default.json").read_text() == "imported"
    (own / "settings.json").write_text("changed")
    assert simulated_state(tmp_path) == own  # not copied again
    assert (own / "settings.json").read_text() == "changed"
    assert (tmp_path / "settings.json").read_text() == "stored"


def test_simulated_printer_loads_a_mesh_that_an_import_has_stored(tmp_path: Path):
    source, machine, state = tmp_path / "printer.cfg", tmp_path / "mine.toml", tmp_path / "state"
    mesh = "".join(
        f"#*# {line}\n"
        for line in (
            "<---------------------- SAVE_CONFIG ---------------------->",
            "DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.",
            "",
            "[bed_mesh mine]",
            "version = 1",
            "points =",
            "\t  0.1, 0.1, 0.1",
            "\t  0.1, 0.2, 0.1",
            "\t  0.1, 0.1, 0.1",
            "min_x = 30.0",
            "max_x = 130.0",
            "min_y = 30.0",
            "max_y = 130.0",
            "x_count = 3",
            "y_count = 3",
            "algo = lagrange",
        )
    )
    source.write_text(f"{BASE}[probe]\npin: PC0\nz_offset: 1\n{mesh}")
    assert main(["import", str(source), "--output", str(machine), "--state", str(state)]) == 0
    words = [sys.executable, "-m", "passo", "serve", "--machine", str(machine), "--simulated"]
    words += ["--clock", "fast", "--stdin", "--http", "none", "--state", str(state)]
    lines = "BED_MESH_PROFILE LOAD=mine\nBED_MESH_PROFILE LOAD=other\n"
    run = subprocess.run(words, input=lines, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    loaded, refused = run.stdout.strip().split("ok\n", 1)
    assert "other" in refused and "mine" in refused
    assert "// Mesh mine is in use: 3 × 3 points" in loaded


def options_of(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(exit_on_error=False)
    serve.add_arguments(parser)
    return parser.parse_args(words)


def test_addresses_may_be_automatic_none_or_a_socket():
    found = options_of("--tcp", "auto", "--tcp", "[::1]:auto", "--tcp", ":0", "--tcp", "a.b:7")
    assert found.tcp == [("127.0.0.1", 0), ("::1", 0), ("127.0.0.1", 0), ("a.b", 7)]
    assert found.http is None
    found = options_of("--tcp", "none", "--http", "0.0.0.0:auto")
    assert (found.tcp, found.http) == (["none"], ("0.0.0.0", 0))
    assert options_of("--http", "unix:/run/i3.sock").http == Path("/run/i3.sock")
    assert options_of("--http", "none").http == "none"
    for words in (("--http", "unix:"), ("--tcp", "unix:/a"), ("--tcp", "a:65536"), ("--tcp", "")):
        with pytest.raises(argparse.ArgumentError):
            options_of(*words)


def test_second_printer_with_the_same_state_names_the_first(tmp_path: Path):
    state, unix = tmp_path / "state", tmp_path / "i3.sock"
    words = [sys.executable, "-m", "passo", "serve", "--machine", "i3", "--state", str(state)]
    first = [*words, "--tcp", "none", "--http", f"unix:{unix}"]
    with subprocess.Popen(first, stderr=subprocess.PIPE, text=True) as served:
        assert served.stderr is not None
        assert "programs that may open its socket may do all" in served.stderr.readline()
        assert served.stderr.readline() == f"Serving i3 on unix:{unix}.\n"
        names = f": i3, process {served.pid}, unix:{unix}. Stop the other printer"
        second = subprocess.run([*words, "--http", "none"], capture_output=True, text=True)
        assert (second.returncode, names in second.stderr) == (4, True)
        served.kill()
    words += ["--tcp", "auto", "--http", "auto"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as third:
        assert third.stderr is not None
        third.stderr.readline()
        line = third.stderr.readline()
        assert re.search(r"on tcp 127\.0\.0\.1:\d{4,5}, http://127\.0\.0\.1:\d{4,5}\.\n", line)
        third.terminate()
    assert not (state / "serving").exists()
