"""`passo batch`: many files on many machines under many settings, as a table."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.errors import ExitStatus

if TYPE_CHECKING:
    from passo.study.run import Progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo batch`."""
    from passo.study.local_engine import MEMORY_MB, TIMEOUT_S

    parser.add_argument("study", metavar="STUDY.toml", help="the study file")
    parser.add_argument(
        "--output",
        required=True,
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
        "--timeout",
        type=_number,
        default=TIMEOUT_S,
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
    """Runs the study. The exit status is 0 if each case was computed, else 1."""
    from passo.study.local_engine import LocalEngine
    from passo.study.plan import plan_study
    from passo.study.run import run_study
    from passo.study.study_file import load_study

    plan = plan_study(load_study(arguments.study), Path(arguments.study).parent)
    engine = LocalEngine(arguments.jobs, arguments.timeout, arguments.memory)
    output = Path(arguments.output)
    progress = run_study(
        plan, engine, output, arguments.jobs, _print_event if arguments.events else _silent
    )
    if not arguments.events:
        counts = ", ".join(f"{n} {status}" for status, n in sorted(progress.statuses.items()))
        print(f"{progress.cases} cases: {counts}")
        print(output / "results.csv")
    return ExitStatus.DONE if progress.statuses["ok"] == progress.cases else 1


def _silent(progress: Progress, rows: list[dict[str, Any]]) -> None:
    pass


def _print_event(progress: Progress, rows: list[dict[str, Any]]) -> None:
    from dataclasses import asdict

    for row in rows:
        print(json.dumps({"row": row}))
    print(json.dumps({"progress": asdict(progress)}), flush=True)
