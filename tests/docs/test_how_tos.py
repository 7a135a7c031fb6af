"""What the how-tos show is what their commands print, and their changes to the code work."""

from __future__ import annotations

import ast
import os
import re
import shutil
import site
import subprocess
import sys
from collections.abc import Iterable
from math import ceil
from pathlib import Path

import pytest
from tests.docs.test_tutorial import commands
from tests.support.scenario import Scenario
from tests.support.stall_machine import with_table

import passo._core
from passo.config.load import load_text, shipped_text

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
CHANGES = (
    *("add-a-command", "add-a-sensor", "add-a-geometry", "add-a-motion-filter", "add-a-probe"),
    *("add-an-endpoint", "add-an-importer-row", "add-a-lesson"),
)
SILENT = ("add-a-geometry", "add-a-motion-filter", "add-an-endpoint")  # they show no output


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
    """Applies the changes of a page: in each part the old lines occur once, or the file is new."""
    for block in blocks(text, "diff"):
        path, _, changes = block.removeprefix("--- ").partition("\n")
        target = folder / path
        target.touch()
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
    for test in ("tests/geometry/test_kernels.py", "tests/motion/test_filters.py"):
        (tmp_path / test).parent.mkdir(parents=True)
        shutil.copy(ROOT / test, tmp_path / test)
    return tmp_path


def paths(folder: Path) -> str:
    return os.pathsep.join([str(folder / "src"), *site.getsitepackages(), str(ROOT)])


@pytest.mark.parametrize("name", CHANGES)
def test_changes_of_how_to_apply_and_run(copy, name):
    apply(page(name), copy)
    shown = run(page(name), copy, paths(copy))
    assert shown >= (0 if name in SILENT else 2)
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


def compiled(folder: Path, sources: list[str], words: Iterable[str] = ()) -> str:
    """What the program of main.cpp and sources of the core prints."""
    flags = ["-std=c++20", "-O0", "-ffp-contract=off", "-Icore"]
    build = ["c++", *flags, "main.cpp", *sources, "-o", "main"]
    subprocess.run(build, cwd=folder, check=True)
    done = subprocess.run([folder / "main", *words], capture_output=True, text=True, check=True)
    return done.stdout


def test_added_geometry_compiles_and_agrees_with_its_model(copy):
    apply(page("add-a-geometry"), copy)
    (copy / "main.cpp").write_text(
        '#include <cstdio>\n#include "geometry/registry.hpp"\n'
        "int main() {\n"
        '  auto g = passo::make_geometry("markforged", {});\n'
        "  double p[3] = {30, 20, 5}, q[3], back[3];\n"
        "  for (int i = 0; i < 3; ++i) q[i] = g->inverse(i, p);\n"
        "  g->forward(q, back);\n"
        '  std::printf("%g %g %g %g %g %g", q[0], q[1], q[2], back[0], back[1], back[2]);\n}\n'
    )
    core = compiled(copy, ["core/geometry/registry.cpp", "core/geometry/track.cpp"])
    code = (
        "from pydantic import TypeAdapter\nfrom passo.geometry.registry import AnyGeometry\n"
        'g = TypeAdapter(AnyGeometry).validate_python({"kind": "markforged"})\n'
        "q = g.inverse((30.0, 20.0, 5.0))\n"
        'print(*(f"{v:g}" for v in (*q, *g.forward(q))), end="")'
    )
    environment = {**os.environ, "PYTHONPATH": paths(copy)}
    model = subprocess.run(
        [sys.executable, "-S", "-c", code], env=environment, capture_output=True, text=True
    )
    assert (model.stdout, model.stderr) == (core, "")
    assert core == "50 20 5 30 20 5"


MAIN = """
#include <cstdio>
#include <cstdlib>
#include <string>

#include "filters/law.hpp"
using namespace passo;

struct Print {
  void add(double end, double q, double v0, double v1, double) {
    std::printf("%.4f %.4f %.4f %.4f|", end / 1e6, q, v0 * 1e6, v1 * 1e6);
  }
  template <class... Parts> void bent(Parts...) {}
  template <class... Parts> void counted(Parts...) {}
  template <class... Parts> void cubic(Parts...) {}
  void piece(const Piece&) {}
};

// Each setting: its name, how many numbers it has, and these.
int main(int count, char** words) {
  Filters filters;
  for (int i = 1; i < count;) {
    const std::string name = words[i++];
    Numbers numbers(std::size_t(std::atoi(words[i++])));
    for (double& number : numbers) number = std::atof(words[i++]);
    filters.set(name, 0, numbers);
  }
  Law law(1e6);
  law.follow_axis(filters, kX);
  Move m{};  // 12 mm, 0.1 s each to accelerate to 60 mm/s, to cruise and to brake
  m.kind = MoveKind::travel, m.p1[kX] = m.d = 12, m.vc = 60, m.a = m.b = 600;
  m.d_acc = 3, m.d_cru = 6, m.start = 1e6, m.t_acc = m.t_cru = m.t_dec = 1e5;
  law.begin(m);
  law.start(m.start);
  law.add(m, kNeverTicks);
  law.stand();
  Print sink;
  law.advance(0, true, sink);
  std::printf("%g %g", filters.delay(1e6), filters.memory(1e6));
}
"""
SPEC = """
from passo import config
text = config.shipped_text("i3") + "\\n[shaping.x]\\nfrequency_hz = 47\\nsecond_hz = 80\\n"
filters = config.load_text(text).core_spec()["filters"]
print(filters["shapers"][0], filters["second_shapers"], sep="\\n")
"""


def test_added_filter_compiles_and_acts_after_the_shaper(copy):
    apply(page("add-a-motion-filter"), copy)
    (copy / "main.cpp").write_text(MAIN)
    environment = {**os.environ, "PYTHONPATH": paths(copy)}
    done = subprocess.run(
        [sys.executable, "-S", "-c", SPEC], env=environment, capture_output=True, text=True
    )
    first, seconds = (ast.literal_eval(line) for line in done.stdout.splitlines())
    assert (len(first), [len(shaper) for shaper in seconds]) == (3, [2, 0, 0]), done.stderr
    both = sorted((t + u, a * b) for a, t in first for b, u in seconds[0])
    settings = {"shapers": first, "second_shapers": seconds[0]}
    flat = {
        name: [str(x) for impulse in value for x in impulse] for name, value in settings.items()
    }
    words = [word for name, value in flat.items() for word in (name, str(len(value)), *value)]
    sources = [f"core/filters/{name}.cpp" for name in ("law", "planned_laws", "followed_nozzle")]
    *intervals, reach = compiled(copy, sources, words).split("|")
    rows = [[float(number) for number in interval.split()] for interval in intervals]
    mean = sum(t * weight for t, weight in both)
    delay, after = ceil(mean * 1e6), ceil((both[-1][0] - mean) * 1e6)
    assert [float(x) for x in reach.split()] == [delay, delay + after]
    # Each impulse delays the four phases of the move.
    begins = sorted(1 + phase / 10 + t for t, _ in both for phase in range(4))
    assert [end for end, *_ in rows] == pytest.approx(begins, abs=1e-4)
    for end, q, *_ in rows:
        assert q == pytest.approx(sum(a * moved_mm(end - 1 - t) for t, a in both), abs=0.01)


def moved_mm(t: float) -> float:
    """The planned position of the move, t seconds after its begin."""
    t = min(max(t, 0.0), 0.3)
    if t < 0.1:
        return 300 * t * t
    return 3 + 60 * (t - 0.1) if t < 0.2 else 12 - 300 * (0.3 - t) ** 2


def test_added_calibration_task_sets_and_undoes_its_value(copy):
    """The page of the copy, built with the added task, in a browser."""
    shutil.copytree(
        ROOT / "web-ui", copy / "web-ui", ignore=shutil.ignore_patterns("node_modules", "*.test.ts")
    )
    (copy / "web-ui/node_modules").symlink_to(ROOT / "web-ui/node_modules")
    (copy / "tools").mkdir()
    shutil.copy(ROOT / "tools/build_page.py", copy / "tools")
    text = page("add-a-calibration-task")
    apply(text, copy)
    (test,) = blocks(text, "ts")
    (copy / "web-ui/tests/backlash.test.ts").write_text(test, encoding="utf-8")
    (copy / "demo.gcode").write_text("G28\n")
    python = copy / "python"
    python.write_text(f'#!/bin/sh\nPYTHONPATH={paths(copy)} exec "{sys.executable}" -S "$@"\n')
    python.chmod(0o755)
    environment = os.environ | {
        "PASSO_PYTHON": str(python),
        "PASSO_EXAMPLE": str(copy / "demo.gcode"),
        "NO_COLOR": "1",
    }
    command = [sys.executable, "tools/build_page.py", "--test", "browser"]
    done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True)
    assert "1 passed" in done.stdout, done.stdout + done.stderr


def test_homing_without_switches_works_as_shown():
    text = page("home-without-switches")
    stepper, _, homing = blocks(text, "toml")[0].partition("[homing.x]")
    machine = with_table(shipped_text("i3"), "steppers.x", stepper)
    machine = with_table(machine, "homing.x", f"[homing.x]{homing}")
    with Scenario(load_text(machine, "stall.toml")) as s:
        s.board.place("x", 120.0)
        command, *_ = blocks(text, "gcode")[0].splitlines()
        printed = [line for line in s.host.ok(command, 600) if "busy" not in line]
        assert [*shown_lines(text, printed)] == printed[:-1]
        s.host.ok("G1 X80 F6000")
        assert s.host.ok("G28 X", 60)[-1] == "ok"
        assert abs(s.positions()["x"] - 3.0) < 0.05


def shown_lines(text: str, printed: list[str]) -> Iterable[str]:
    """The printed lines that the page shows; … stands for anything."""
    for line, said in zip(blocks(text, "text")[0].splitlines(), printed, strict=False):
        pattern = ".*".join(map(re.escape, line.split("…")))
        assert re.fullmatch(pattern, said), (line, said)
        yield said
