"""A study gives the same bytes however it is computed: by processes that die, in pieces, again."""

import json
import multiprocessing
import os
import signal
from contextlib import suppress
from pathlib import Path

import pytest
from tests.support import faulty_cases

from passo.errors import InputError, MachineError
from passo.study.engine import Inline
from passo.study.local_engine import LocalEngine
from passo.study.plan import plan_study
from passo.study.run import run_study
from passo.study.study_file import Study
from passo.study.work import Shard

PART = """G28
M109 S200
G1 X{x} Y20 F6000
G1 X80 E2.4
G1 Y80 E4.8
"""
_MB = 1024


def study(folder, **keys):
    """Six good files and three bad ones, on three machines under four settings."""
    for i in range(6):
        (folder / f"part{i}.gcode").write_text(PART.format(x=20 + i))
    (folder / "corrupt.gcode").write_text(PART.format(x="20.3.5"))
    (folder / "empty.gcode").write_text("")
    (folder / "binary.gcode").write_bytes(bytes(range(256)) * 8)
    grid = {
        "axes.x.accel_mm_s2": [1000.0, 3000.0],
        "limits.junction_deviation_mm": [0.01, 0.02],
    }
    machines = ["i3", "corexy", "ender3"]
    return Study.model_validate({"files": ["*.gcode"], "machines": machines, "grid": grid, **keys})


class StoppedClock:
    """A clock that runs only while another process is stopped: half a second at each look."""

    s = 0.0

    def __call__(self):
        for process in multiprocessing.active_children():
            with suppress(OSError):
                state = Path(f"/proc/{process.pid}/stat").read_text().rpartition(") ")[2][0]
                self.s += 0.5 if state == "T" else 0.0
        return self.s


def run(folder, output, engine, watch=lambda progress, rows: None):
    """The last progress, and the table."""
    seen = []

    def see(progress, rows):
        seen.append(progress)
        watch(progress, rows)

    run_study(plan_study(study(folder), folder), engine, folder / output, see)
    return seen[-1], (folder / output / "results.csv").read_bytes()


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="module")
def expected(files):
    """The table that this process computes by itself."""
    progress, table = run(files, "inline", Inline())
    assert progress.cases == 9 * 3 * 4
    assert progress.statuses == {"ok": 72, "input": 36}
    return table


def test_rows_have_figures_or_code_and_line(files, expected):
    rows = [json.loads(row) for row in (files / "inline/results.jsonl").read_text().splitlines()]
    bad = {row["file"]: (row["code"], row["line"]) for row in rows if row["status"] == "input"}
    assert bad == {
        "binary.gcode": ("input.garbage", 1),
        "corrupt.gcode": ("input.decimal-points", 3),
        "empty.gcode": ("input.empty", None),
    }
    slow, fast = (
        next(row for row in rows if row["file"] == "part0.gcode" and row["setting"] == setting)
        for setting in (
            {"axes.x.accel_mm_s2": accel, "limits.junction_deviation_mm": 0.01}
            for accel in (1000.0, 3000.0)
        )
    )
    assert slow["moving_s"] > fast["moving_s"] > 1.0
    assert str(files) not in expected.decode()


def test_processes_give_the_same_bytes_as_one(files, expected):
    assert run(files, "two", LocalEngine(2))[1] == expected


def test_killed_process_costs_no_row(files, expected):
    """One process is killed, another one stopped, as soon as there are rows."""
    struck = []

    def strike(progress, rows):
        if rows and len(struck) < 2:
            for process in multiprocessing.active_children():
                if process.pid not in struck and len(struck) < 2:
                    os.kill(process.pid, signal.SIGSTOP if struck else signal.SIGKILL)
                    struck.append(process.pid)

    engine = LocalEngine(2, timeout_s=10, now=StoppedClock())
    progress, table = run(files, "struck", engine, watch=strike)
    assert len(struck) == 2
    assert (progress.done, table) == (108, expected)


def faulty(folder, compute, *names, jobs=2, **options):
    """The results by file of one case a file."""
    for name in names:
        (folder / name).write_text(PART.format(x=30))
    plan = plan_study(Study.model_validate({"files": [*names], "machines": ["i3"]}), folder)
    works = [case.work._replace(id=str(i)) for i, case in enumerate(plan.cases)]
    engine = LocalEngine(jobs, compute=compute, **options)
    found = {}
    try:
        # one shard, so that a deadly case has neighbours
        engine.submit(Shard(tuple(works), plan.machines.pickled, plan.order))
        while engine.busy:
            for done in engine.completed():
                for work, result in zip(done.shard.works, done.results, strict=True):
                    found[Path(work.file.path).name] = result
    finally:
        engine.close()
    return found


def test_case_that_kills_its_process_is_a_crash(tmp_path):
    found = faulty(tmp_path, faulty_cases.dies_at_name, "a.gcode", "deadly.gcode", "b.gcode")
    assert {name: r["status"] for name, r in found.items()} == {
        "a.gcode": "ok",
        "deadly.gcode": "crash",
        "b.gcode": "ok",
    }
    assert "SIGKILL" in found["deadly.gcode"]["message"]


def test_case_that_stops_is_a_timeout(tmp_path):
    names, clock = ("a.gcode", "stuck.gcode"), StoppedClock()
    found = faulty(tmp_path, faulty_cases.stops_at_name, *names, jobs=1, timeout_s=10, now=clock)
    assert {name: r["status"] for name, r in found.items()} == {
        "a.gcode": "ok",
        "stuck.gcode": "timeout",
    }
    assert "10 s" in found["stuck.gcode"]["message"]


def test_memory_of_a_process_has_a_limit(tmp_path):
    found = faulty(tmp_path, faulty_cases.needs_memory, "a.gcode", jobs=1, memory_mb=_MB)
    assert found["a.gcode"]["status"] == "memory"


def test_processes_that_cannot_start_end_the_study(tmp_path):
    with pytest.raises(MachineError) as raised:
        faulty(tmp_path, faulty_cases.needs_memory, "a.gcode", jobs=1, memory_mb=1)
    assert raised.value.problems[0].code == "study.no-process"


def test_next_run_computes_only_what_is_missing(files, expected):
    def interrupt(progress, rows):
        if progress.done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(files, "again", Inline(), watch=interrupt)
    rows = files / "again/results.jsonl"
    kept = rows.read_bytes()
    rows.write_bytes(kept + b'{"id": "cut by a power c')
    progress, table = run(files, "again", Inline())
    assert progress.reused == kept.count(b"\n")
    assert table == expected
    assert rows.read_bytes().startswith(kept)
    ids = [json.loads(row)["id"] for row in rows.read_text().splitlines()]
    assert len(ids) == len(set(ids))


def test_equal_cases_are_computed_once(tmp_path):
    for name in ("a.gcode", "b.gcode"):
        (tmp_path / name).write_text(PART.format(x=20))
    two = Study.model_validate({"files": ["*.gcode"], "machines": ["i3"]})
    reused = []
    run_study(
        plan_study(two, tmp_path),
        Inline(),
        tmp_path / "out",
        lambda progress, _: reused.append(progress.reused),
    )
    assert reused[-1] == 1
    assert len((tmp_path / "out/results.jsonl").read_text().splitlines()) == 1
    assert len((tmp_path / "out/results.csv").read_text().splitlines()) == 3


def test_folder_of_a_running_study_is_refused(tmp_path):
    codes = []

    def start_again(progress, rows):
        if not rows:
            with pytest.raises(InputError) as raised:
                run(tmp_path, "out", Inline())
            codes.append(raised.value.problems[0].code)

    run(tmp_path, "out", Inline(), start_again)
    assert codes == ["study.busy"]


def test_folder_of_other_results_is_refused(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out/results.jsonl").write_text('{"name": "bracket"}\n')
    with pytest.raises(InputError) as raised:
        run(tmp_path, "out", Inline())
    assert raised.value.problems[0].code == "study.other-rows"
