"""`passo batch`: many files on many machines under many settings, as a table."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.errors import ExitStatus

if TYPE_CHECKING:
    from passo.study.run import Progress

_NOT_ALL = 1  # the exit status, if a case failed
_REPORT = "report"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo batch`."""
    from passo.study.local_engine import MEMORY_MB, TIMEOUT_S

    parser.add_argument(
        "study",
        metavar="STUDY.toml|report",
        help="the study file; or the word report, to compare the rows of a folder",
    )
    parser.add_argument(
        "folder", nargs="?", metavar="FOLDER", help="the folder with results, after report"
    )
    parser.add_argument(
        "--output",
        metavar="FOLDER",
        help="the folder for the results; if it has results, only what is missing is computed",
    )
    parser.add_argument(
        "--jobs",
        type=_number,
        default=os.cpu_count() or 1,
        metavar="N",
        help="processes that compute at the same time; default: one for each processor",
    )
    parser.add_argument(
        "--on",
        metavar="dask://HOST:PORT",
        help="compute on a cluster of dask.distributed with this scheduler; needs passo[cluster]",
    )
    parser.add_argument(
        "--timeout",
        type=_number,
        default=int(TIMEOUT_S),
        metavar="S",
        help=f"seconds that a case may take; default: {TIMEOUT_S:g}",
    )
    parser.add_argument(
        "--memory",
        type=_number,
        default=MEMORY_MB,
        metavar="MB",
        help=f"memory that a process may use; default: {MEMORY_MB}",
    )
    parser.add_argument(
        "--cache",
        metavar="FILE",
        help="results that several studies share; default: none",
    )
    parser.add_argument(
        "--events",
        action="store_true",
        help="print one JSON object a line: the progress, and each row when it is computed",
    )


def _number(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("it must be at least 1")
    return number


def run(arguments: argparse.Namespace) -> int:
    """Runs a study, or compares its rows. The exit status is 0 if each case was computed, else
    1."""
    wanted = "folder" if arguments.study == _REPORT else "output"
    other = "output" if arguments.study == _REPORT else "folder"
    if getattr(arguments, wanted) is None or getattr(arguments, other) is not None:
        usage = "passo batch STUDY.toml --output FOLDER, or passo batch report FOLDER"
        print(f"Write {usage}.", file=sys.stderr)
        return ExitStatus.USAGE
    if arguments.study == _REPORT:
        return _report(Path(arguments.folder))
    from passo.study.batch import engine_of, run_file

    engine = engine_of(arguments.on, arguments.jobs, arguments.timeout, arguments.memory)
    with _Bar(hidden=arguments.events) as bar:
        watch = _print_event if arguments.events else bar.show
        rows = run_file(arguments.study, arguments.output, engine, watch, arguments.cache)
    counts = Counter(str(row["status"]) for row in rows)
    if not arguments.events:
        print(
            f"{len(rows)} cases: {', '.join(f'{n} {name}' for name, n in sorted(counts.items()))}"
        )
        print(Path(arguments.output, "results.csv"))
    return ExitStatus.DONE if counts["ok"] == len(rows) else _NOT_ALL


def _print_event(progress: Progress, rows: list[dict[str, Any]]) -> None:
    for row in rows:
        print(json.dumps({"row": row}))
    print(json.dumps({"progress": asdict(progress)}), flush=True)


class _Bar:
    """Shows the cases that are done, those that failed, the speed and the remaining time, on a
    terminal."""

    def __init__(self, *, hidden: bool) -> None:
        self._bar = None
        if hidden or not sys.stderr.isatty():
            return
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeRemainingColumn,
        )

        self._bar = Progress(
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[failed]} failed, {task.fields[speed]} cases/s,"),
            TimeRemainingColumn(),
            TextColumn("left"),
            console=Console(stderr=True),
            transient=True,
        )
        self._task = self._bar.add_task("study", total=None, failed=0, speed="?")

    def __enter__(self) -> _Bar:
        """Shows the bar from now on."""
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Removes the bar."""
        if self._bar:
            self._bar.stop()

    def show(self, progress: Progress, rows: list[dict[str, Any]]) -> None:
        """Updates the bar."""
        if not self._bar:
            return
        failed = progress.done - progress.statuses.get("ok", 0)
        speed = self._bar.tasks[0].speed
        self._bar.update(
            self._task,
            completed=progress.done,
            total=progress.cases,
            failed=failed,
            speed="?" if speed is None else f"{speed:.1f}",
        )


def _report(folder: Path) -> int:
    from passo.cli.tables import study_table
    from passo.study.report import compare, write_report_page

    found = compare(folder)
    print(study_table(found))
    print(write_report_page(found, folder))
    return ExitStatus.DONE
