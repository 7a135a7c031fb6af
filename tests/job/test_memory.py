"""What a print leaves behind: nothing that would wait for Python to look for garbage. And what it
costs: its own processor time."""

from __future__ import annotations

import gc
import time
import weakref
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.support.scenario import Scenario

from passo import Machine, config
from passo.errors import PassoError
from passo.job.batch.policy import Policy
from passo.job.batch.simulated_print import Print
from passo.learn.explain import explain
from passo.learn.report import write_report
from passo.printer.commands.program import Commands

PRINT = "G92 X0 Y0 Z0 E0\nM302 P1\nM83\nG1 X10 E1 F3000\nG1 Y10 E1\n"


def test_the_plans_of_a_card_file_go_when_it_is_done(tmp_path: Path) -> None:
    card = tmp_path / "card"
    card.mkdir()
    (card / "a.g").write_text(PRINT)
    with Scenario(card=str(card)) as s:

        def prints() -> None:
            s.host.send("M23 a.g", "M24")
            s.host.expect("Done printing", within=60)

        prints()
        gc.collect()
        before = plans()
        gc.disable()
        try:
            prints()
            assert plans() == before
        finally:
            gc.enable()


def plans() -> int:
    return sum(isinstance(x, Commands) for x in gc.get_objects())


JOBS = {
    "done": "G28\nM104 S60\nM109 S60\nM106 S99\nG1 X20 F3000\nM400\n",
    "beyond a limit": "G28\nG1 X10 F3000\nG1 X9999\n",
    "stopped": "G28\nG1 X10 F3000\nM112\n",
    "without a number": "G28\nM104 S\n",
}


@pytest.mark.parametrize("text", JOBS.values(), ids=JOBS)
@pytest.mark.parametrize("machine", ["i3", "dual-extruder", "laser"])
def test_finished_print_frees_its_memory_at_once(machine: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / "p.gcode"
    path.write_text(text)
    it = config.load(machine)

    def prints() -> list[weakref.ref[object]]:
        job = Print(it, progress=lambda progress: job.job.line, every_s=0.5)
        job.watch(lambda: job.job.line)
        parts = (job, job.connection, job.board, job._commands)
        try:
            job.run(path)
        except PassoError:
            assert text != JOBS["done"]
        return [weakref.ref(part) for part in parts]

    assert leftovers(prints) == 0
    gc.disable()
    try:
        assert [part() for part in prints()] == [None] * 4
    finally:
        gc.enable()


@pytest.mark.parametrize("text", JOBS.values(), ids=JOBS)
@pytest.mark.parametrize("use", [Machine.estimate, Machine.trace, Machine.plan])
def test_library_uses_leave_no_reference_cycles(
    use: Callable[[Machine, Path], object], text: str, tmp_path: Path
) -> None:
    path = tmp_path / "p.gcode"
    path.write_text(text)
    machine = Machine.load("i3")

    def works() -> None:
        try:
            found = use(machine, path)
            if use is Machine.plan:
                list(found)  # pyright: ignore[reportArgumentType]
        except PassoError:
            assert text != JOBS["done"]

    assert leftovers(works) == 0


@pytest.mark.parametrize("text", JOBS.values(), ids=JOBS)
@pytest.mark.parametrize("machine", ["i3", "dual-extruder", "laser"])
def test_a_report_leaves_no_cycles(machine: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / "p.gcode"
    path.write_text(text)
    it = config.load(machine)

    def works() -> None:
        try:
            write_report(it, path, tmp_path / "p.html", Policy())
        except PassoError:
            assert text != JOBS["done"]

    assert leftovers(works) == 0


@pytest.mark.parametrize("line", [1, 2, 5])
@pytest.mark.parametrize("text", JOBS.values(), ids=JOBS)
@pytest.mark.parametrize("machine", ["i3", "laser"])
def test_an_explained_line_leaves_no_cycles(
    machine: str, text: str, line: int, tmp_path: Path
) -> None:
    path = tmp_path / "p.gcode"
    path.write_text(text)
    it = config.load(machine)

    def works() -> None:
        try:
            explain(it, path, line, Policy())
        except PassoError:
            assert text != JOBS["done"]

    assert leftovers(works) == 0


def leftovers(work: Callable[[], object]) -> int:
    """Objects in cycles after the second time; what is kept for good was made the first time."""
    work()
    gc.collect()
    gc.disable()
    try:
        work()
        return gc.collect()
    finally:
        gc.enable()


def test_processor_time_is_the_jobs_own(tmp_path: Path) -> None:
    path = tmp_path / "p.gcode"
    path.write_text("G28\n" + "G1 X10 F3000\nG1 X50\n" * 200)
    machine = config.load("i3")
    for _ in range(2):
        begin = time.thread_time()
        result = Print(machine).run(path)
        spent = time.thread_time() - begin
        stages = sum(seconds for stage, seconds in result.cpu_s.items() if stage != "total")
        assert 0 < stages <= result.cpu_s["total"] <= spent
