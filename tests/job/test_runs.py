"""Starts with a run id: at most one print each, whatever is lost, killed or full."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import passo
from passo.errors import CardError, CommandError
from passo.job.live import runs

RUN = "0f8fad5b-d9cb-469f-a165-70867728950e"
MOVES = "G28\n" + "".join(f"G1 X{10 + i % 2 * 50} Y20 F3000\n" for i in range(10))


@pytest.fixture
def places(tmp_path: Path):
    card = tmp_path / "card"
    card.mkdir()
    (card / "part.gcode").write_text(MOVES)
    (card / "bad.gcode").write_text("G28\nG1 X999\n")
    return {"card": str(card), "state": str(tmp_path / "state")}


def live(main, places, clock="virtual"):
    async def within():
        async with passo.Printer("i3", **places) as printer:
            return await main(printer, printer._opened.services.jobs)

    return passo.run(within(), clock=clock)


async def over(jobs):
    while jobs.runner.engaged:
        await asyncio.sleep(1)


def stored(places):
    """The runs that hold if the printer is killed now."""
    rows = json.loads(Path(places["state"], "runs.json").read_text())["runs"]
    return {row["run"]: (row["state"], row["reason"]) for row in rows}


def test_a_run_starts_once_and_is_known_over_restarts(places):
    async def first(printer, jobs):
        known = [jobs.start("/part.gcode", run=RUN), jobs.start("/part.gcode", run=RUN.upper())]
        seen = [jobs.runs.find(RUN), stored(places)[RUN]]
        jobs.runner.pause()
        seen.append(jobs.runs.find(RUN).state)
        assert printer.status.job.run == RUN
        await asyncio.sleep(5)
        jobs.runner.start()
        await over(jobs)
        return known, seen, jobs.runs.find(RUN), jobs.statistics.last(9), printer.status.last_print

    known, seen, run, history, last = live(first, places)
    assert known == [False, True]
    assert (seen[0].file, seen[0].state, seen[2]) == ("/part.gcode", "printing", "paused")
    assert seen[1] == ("failed", "Passo ended during the print")
    assert (run.state, run.reason, stored(places)[RUN]) == ("done", "", ("done", ""))
    assert [(row.run, row.ended) for row in history] == [(RUN, "done")]
    assert (last.run, last.result, last.number) == (RUN, "done", history[0].number)

    async def again(printer, jobs):
        known = jobs.start("/part.gcode", run=RUN)
        return known, jobs.runner.engaged, jobs.runs.find(RUN).state, printer.status.last_print

    assert live(again, places) == (True, False, "done", last)


def test_ends_of_runs_have_their_reason(places):
    async def main(_, jobs):
        found = []
        jobs.start("/part.gcode", run=RUN)
        await asyncio.sleep(5)
        jobs.runner.cancel()
        found.append(jobs.runs.find(RUN))
        other = RUN.replace("0f8", "1f8")
        jobs.start("/bad.gcode", run=other)  # waits for the end of the cancelled print
        found.append(jobs.runs.find(other))
        await over(jobs)
        await asyncio.sleep(30)
        found.append(jobs.runs.find(other))
        jobs.start("/part.gcode")
        assert jobs.runs.find(other) == found[-1]  # a print without a run id is not this run
        third = RUN.replace("0f8", "2f8")
        with pytest.raises(CommandError, match="is being printed"):
            jobs.start("/part.gcode", run=third)
        found.append(jobs.runs.find(third))
        assert jobs.start("/part.gcode", run=third)
        jobs.runner.cancel()
        fourth = RUN.replace("0f8", "3f8")
        jobs.start("/part.gcode", run=fourth)
        jobs.runner.cancel()  # before it has begun
        found.append(jobs.runs.find(fourth))
        fifth = RUN.replace("0f8", "4f8")
        with pytest.raises(CardError):
            jobs.start("/none.gcode", run=fifth)
        found.append(jobs.runs.find(fifth))
        return found, stored(places)

    found, kept = live(main, places)
    assert [run.state for run in found] == [
        "cancelled", "printing", "failed", "failed", "cancelled", "failed"
    ]  # fmt: skip
    assert "X 999.000 mm is beyond the limit" in found[2].reason
    assert "is being printed" in found[3].reason
    assert "none.gcode" in found[5].reason
    assert kept == {run.run: (run.state, run.reason) for run in [found[0], *found[2:]]}


def test_a_resumed_print_stays_the_same_run(places):
    Path(places["card"], "bad.gcode").write_text("G28\nG1 X999\nG1 X50 F3000\n")

    async def main(printer, jobs):
        jobs.start("/bad.gcode", run=RUN)
        await over(jobs)
        found = [jobs.runs.find(RUN).state]
        jobs.runner.start()
        found.append(jobs.runs.find(RUN).state)
        await over(jobs)
        return [*found, jobs.runs.find(RUN).state, printer.status.last_print.run]

    assert live(main, places) == ["failed", "printing", "done", RUN]


def test_a_print_resumed_after_a_kill_is_the_same_run(places):
    words = [sys.executable, "-c", KILLED, "in the print", places["card"], places["state"], RUN]
    assert subprocess.run(words, capture_output=True).returncode == -signal.SIGKILL

    async def main(printer, jobs):
        found = [jobs.runs.find(RUN), jobs.start("/part.gcode", run=RUN), printer.status.last_print]
        await printer.send("M1000")
        while not jobs.runner.engaged:
            await asyncio.sleep(1)
        found.append(printer.status.job.run)
        await over(jobs)
        return [*found, jobs.runs.find(RUN).state, printer.status.last_print]

    before, known, last, run, state, end = live(main, places)
    cut = "Passo ended during the print"
    assert (before.state, before.reason, known) == ("failed", cut, True)
    assert (last.run, last.result, last.reason) == (RUN, "failed", cut)
    assert (run, state) == (RUN, "done")
    assert (end.run, end.result) == (RUN, "done")
    assert end.number > last.number


def test_a_run_that_cannot_be_stored_does_not_start(places, monkeypatch):
    def full(path, content):
        raise OSError(28, os.strerror(28), str(path))

    async def main(_, jobs):
        with monkeypatch.context() as patched:
            patched.setattr(runs, "store_json", full)
            with pytest.raises(CommandError, match="No space left on device") as error:
                jobs.start("/part.gcode", run=RUN)
        assert error.value.problems[0].code == "run.unwritable"
        assert not jobs.runner.engaged
        with pytest.raises(CommandError, match="no print was started with the run id"):
            jobs.runs.find(RUN)
        return jobs.start("/part.gcode", run=RUN), jobs.runner.engaged

    assert live(main, places) == (False, True)


@pytest.mark.parametrize("text", ["", "{", '{"runs": [{"run": 5}]}', '{"runs": 3}'])
def test_nothing_starts_while_the_stored_runs_are_unreadable(places, text):
    Path(places["state"]).mkdir()
    Path(places["state"], "runs.json").write_text(text)

    async def main(printer, jobs):
        assert any("runs.json: is damaged" in line for line in printer.start_messages)
        for act in (lambda: jobs.start("/part.gcode", run=RUN), lambda: jobs.runs.find(RUN)):
            with pytest.raises(CommandError) as error:
                act()
            assert error.value.problems[0].code == "run.damaged"
        assert not jobs.runner.engaged
        return jobs.start("/part.gcode")

    assert live(main, places) is False
    assert Path(places["state"], "runs.json").read_text() == text


def test_the_last_hundred_runs_are_kept(places):
    ids = [f"00000000-0000-4000-8000-{i:012}" for i in range(runs.MAX_RUNS + 1)]

    async def main(_, jobs):
        for run in ids:
            with pytest.raises(CardError):
                jobs.start("/none.gcode", run=run)
        with pytest.raises(CommandError, match="keeps the last 100"):
            jobs.runs.find(ids[0])
        with pytest.raises(CommandError, match="expected a UUID"):
            jobs.start("/part.gcode", run="run 1")

    live(main, places)
    assert list(stored(places)) == ids[1:]


KILLED = """
import asyncio, os, signal, sys
import passo
from passo.job import durable_files
from passo.job.live import runs
from passo.job.live.runner import Runner

where, card, state, run = sys.argv[1:]

def killed(*_, **__):
    os.kill(os.getpid(), signal.SIGKILL)

async def main():
    async with passo.Printer("i3", card=card, state=state) as printer:
        jobs = printer._opened.services.jobs
        if where == "before the store":
            runs.store_json = killed
        elif where == "in the store":
            durable_files.os.fsync = killed
        elif where == "before the start":
            Runner.start = killed
        elif where == "before the end is stored":
            jobs.runner.watchers.insert(0, lambda was, now: now.active or killed())
        jobs.start("/part.gcode", run=run)
        if where == "after the start":
            killed()
        while jobs.runner.engaged:
            await asyncio.sleep(1)
            if where == "in the print":
                killed()
        if where == "after the end":
            killed()

passo.run(main(), clock="virtual")
"""


@pytest.mark.parametrize(
    ("where", "known", "state"),
    [
        ("before the store", False, "printing"),
        ("in the store", False, "printing"),
        ("before the start", True, "failed"),
        ("after the start", True, "failed"),
        ("in the print", True, "failed"),
        ("before the end is stored", True, "failed"),
        ("after the end", True, "done"),
    ],
)
def test_a_kill_at_any_point_causes_no_second_start(places, where, known, state):
    words = [sys.executable, "-c", KILLED, where, places["card"], places["state"], RUN]
    killed = subprocess.run(words, capture_output=True, text=True)
    assert killed.returncode == -signal.SIGKILL, killed.stderr

    async def main(_, jobs):
        begun = len(jobs.statistics.last(9))
        answer = jobs.start("/part.gcode", run=RUN)
        assert jobs.runner.engaged == (not answer)
        assert begun == 0 or answer  # what has begun does not begin again
        return answer, jobs.runs.find(RUN).state

    assert live(main, places) == (known, state)
