"""What the how-tos show is what their commands print, and their changes to the code work."""

from __future__ import annotations

import os
import re
import shutil
import site
import subprocess
import sys
from pathlib import Path

import pytest
from tests.docs.test_tutorial import commands

import passo._core

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "docs/how-to"
FILE = re.compile(r"`([\w.]+\.(?:gcode|txt))`[^`]*?```gcode\n(.*?)```", re.DOTALL)
RUN = (
    "ask-for-help",
    "first-print",
    "connect-octoprint",
    "tune-a-heater",
    "calibrate-a-thermistor",
    "level-a-bed",
    "calibrate-a-delta",
    "level-a-gantry",
    "turn-bed-screws",
)
CHANGES = ("add-a-command", "add-a-sensor", "add-a-geometry")


def page(name: str) -> str:
    return (FOLDER / f"{name}.md").read_text(encoding="utf-8")


def blocks(text: str, kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", text, re.DOTALL)


def run(text: str, folder: Path, paths: str = "") -> int:
    """Runs the commands of a page; each line that it shows must be printed, in this
    order; … stands for anything."""
    python = f'exec "{sys.executable}" {"-S" if paths else ""}'
    (folder / "passo").write_text(f'#!/bin/sh\n{python} -m passo "$@"\n')
    (folder / "passo").chmod(0o755)
    environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "PYTHONUTF8": "1"}
    environment |= {"PYTHONPATH": paths} if paths else {}
    for name, content in FILE.findall(text):
        (folder / name).write_text(content, encoding="utf-8")
    shown = 0
    for command, lines in (pair for block in blocks(text, "console") for pair in commands(block)):
        done = subprocess.run(
            command,
            shell=True,
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert done.returncode == 0, (command, done.stdout)
        printed = iter(done.stdout.splitlines())
        for line in lines:
            pattern = re.escape(line).replace("…", ".*")
            found = any(re.fullmatch(pattern, text) for text in printed)
            assert found, (command, line, done.stdout)
            shown += 1
    return shown


@pytest.mark.parametrize("name", RUN)
def test_commands_of_how_to_print_what_is_shown(tmp_path, name):
    assert run(page(name), tmp_path) >= 2


def apply(text: str, folder: Path) -> None:
    """Applies the changes of a page: in each part the old lines occur once."""
    for block in blocks(text, "diff"):
        path, _, changes = block.removeprefix("--- ").partition("\n")
        target = folder / path
        for change in changes.split("@@\n"):
            lines = change.rstrip("\n").split("\n")
            old = "\n".join(line[1:] for line in lines if not line.startswith("+"))
            new = "\n".join(line[1:] for line in lines if not line.startswith("-"))
            before = target.read_text(encoding="utf-8")
            assert before.count(old) == 1, (path, old)
            target.write_text(before.replace(old, new), encoding="utf-8")


@pytest.fixture
def copy(tmp_path):
    """The sources, with the core that is built."""
    shutil.copytree(ROOT / "src/passo", tmp_path / "src/passo")
    shutil.copy(passo._core.__file__, tmp_path / "src/passo")
    shutil.copytree(ROOT / "core", tmp_path / "core")
    (tmp_path / "tests/geometry").mkdir(parents=True)
    shutil.copy(ROOT / "tests/geometry/test_kernels.py", tmp_path / "tests/geometry")
    return tmp_path


def paths(folder: Path) -> str:
    return os.pathsep.join([str(folder / "src"), *site.getsitepackages(), str(ROOT)])


@pytest.mark.parametrize("name", CHANGES)
def test_changes_of_how_to_apply_and_run(copy, name):
    apply(page(name), copy)
    shown = run(page(name), copy, paths(copy))
    assert shown >= (0 if name == "add-a-geometry" else 2)
    for number, code in enumerate(blocks(page(name), "python")):
        test = copy / f"test_{number}.py"
        test.write_text(code, encoding="utf-8")
        environment = {**os.environ, "PYTHONPATH": paths(copy)}
        pytest_run = [
            sys.executable,
            "-S",
            "-m",
            "pytest",
            "-q",
            str(test),
            "-p",
            "no:cacheprovider",
        ]
        done = subprocess.run(pytest_run, cwd=copy, env=environment, capture_output=True, text=True)
        assert "1 passed" in done.stdout, done.stdout + done.stderr


def test_added_geometry_compiles_and_agrees_with_its_model(copy):
    apply(page("add-a-geometry"), copy)
    (copy / "main.cpp").write_text(
        '#include <cstdio>\n#include "geometry/registry.hpp"\n'
        "int main() {\n"
        '  auto g = passo::make_geometry("hybrid_corexy", {});\n'
        "  double p[3] = {30, 20, 5}, q[3], back[3];\n"
        "  for (int i = 0; i < 3; ++i) q[i] = g->inverse(i, p);\n"
        "  g->forward(q, back);\n"
        '  std::printf("%g %g %g %g %g %g", q[0], q[1], q[2], back[0], back[1], back[2]);\n}\n'
    )
    sources = ["main.cpp", "core/geometry/registry.cpp", "core/geometry/track.cpp"]
    subprocess.run(
        ["c++", "-std=c++20", "-O0", "-Icore", *sources, "-o", "main"], cwd=copy, check=True
    )
    core = subprocess.run([copy / "main"], capture_output=True, text=True, check=True).stdout
    code = (
        "from pydantic import TypeAdapter\nfrom passo.geometry.registry import AnyGeometry\n"
        'g = TypeAdapter(AnyGeometry).validate_python({"kind": "hybrid_corexy"})\n'
        "q = g.inverse((30.0, 20.0, 5.0))\n"
        'print(*(f"{v:g}" for v in (*q, *g.forward(q))), end="")'
    )
    environment = {**os.environ, "PYTHONPATH": paths(copy)}
    model = subprocess.run(
        [sys.executable, "-S", "-c", code], env=environment, capture_output=True, text=True
    )
    assert (model.stdout, model.stderr) == (core, "")
    assert core == "10 20 5 30 20 5"
