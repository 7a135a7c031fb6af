"""How long studies take: many tiny cases, and estimates of the example.

Usage: python bench/studies.py [--tiny 10000] [--estimates 1000] [--jobs 2]. The tiny cases are
files of one layer under 100 settings. They are computed in this process and then in `--jobs`
processes; the table names both times and the difference, which may be at most 10 s. The estimates
are those of examples/demo.gcode.xz, which has 25 000 moves, each under its own setting. Exit status
1 if the difference is larger, or if the tables of both engines differ.
"""

from __future__ import annotations

import argparse
import lzma
import resource
import sys
import tempfile
import time
from math import ceil
from pathlib import Path

from passo.study.engine import Engine, Inline
from passo.study.local_engine import LocalEngine
from passo.study.plan import plan_study
from passo.study.run import run_study
from passo.study.study_file import Study

_EXAMPLE = Path(__file__).parents[1] / "examples" / "demo.gcode.xz"
_SETTINGS = 100
_MAX_MORE_S = 10.0


def study(folder: Path, pattern: str, settings: int) -> Study:
    values = [round(500 + i, 1) for i in range(settings)]
    grid = {"limits.print_accel_mm_s2": [float(value) for value in values]}
    return Study(files=[pattern], machines=["i3"], grid=grid)


def timed(study: Study, folder: Path, output: str, engine: Engine) -> tuple[float, bytes]:
    """The wall time of a study with its plan, and its table. Prints the processor time, too."""
    start_s, start_cpu_s = time.monotonic(), cpu_s()
    run_study(plan_study(study, folder), engine, folder / output)
    wall_s = time.monotonic() - start_s
    print(f"  {output}: {wall_s:.1f} s, {cpu_s() - start_cpu_s:.1f} s of processors", flush=True)
    return wall_s, (folder / output / "results.csv").read_bytes()


def cpu_s() -> float:
    """The processor time of this process and of those that have ended."""
    times = [resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(t.ru_utime + t.ru_stime for t in times)


def main() -> int:
    """Prints the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tiny", type=int, default=10_000)
    parser.add_argument("--estimates", type=int, default=1_000)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for i in range(ceil(arguments.tiny / _SETTINGS)):
            line = f"G28\nM109 S200\nG1 X{20 + i % 50} Y{20 + i // 50} F6000\nG1 X80 E2.4\n"
            (folder / f"tiny{i}.gcode").write_text(line)
        tiny = study(folder, "tiny*.gcode", _SETTINGS)
        inline_s, expected = timed(tiny, folder, "inline", Inline())
        jobs_s, table = timed(tiny, folder, "jobs", LocalEngine(arguments.jobs))
        cases = expected.count(b"\n") - 1
        print(
            f"{cases} tiny cases: {inline_s:.1f} s in one process, {jobs_s:.1f} s in"
            f" {arguments.jobs}: {jobs_s - inline_s:+.1f} s"
        )
        (folder / "demo.gcode").write_bytes(lzma.decompress(_EXAMPLE.read_bytes()))
        demo = study(folder, "demo.gcode", arguments.estimates)
        demo_s, _ = timed(demo, folder, "demo", LocalEngine(arguments.jobs))
        each_s = arguments.jobs * demo_s / arguments.estimates
        print(
            f"{arguments.estimates} estimates of the example: {demo_s:.1f} s,"
            f" {1000 * each_s:.0f} ms of a process each"
        )
    return int(jobs_s - inline_s > _MAX_MORE_S or table != expected)


if __name__ == "__main__":
    sys.exit(main())
