"""Standard input, output and error that are full, closed or a pipe."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest


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


def test_closed_reader_of_output_is_not_an_error():
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
def test_closed_reader_of_output_hides_no_error(words, status, unbuffered):
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


def test_a_closed_standard_output_is_not_an_error():
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


@pytest.mark.parametrize(("text", "status"), [("G28\nG1 X10 F600\n", 0), ("", 4)])
def test_pipe_is_accepted_as_a_file(text, status):
    command = [sys.executable, "-m", "passo", "estimate", "/dev/stdin"]
    run = subprocess.run(command, input=text, capture_output=True, text=True)
    assert run.returncode == status
    assert run.stderr.startswith("/dev/stdin: holds no command.") == (status == 4)
