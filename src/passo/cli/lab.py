"""`passo lab`: prints one file under several settings of the motion, and compares them."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from passo.cli.machine_option import add_machine, add_policy, add_skips, policy_of, skips_of
from passo.errors import ExitStatus, InputError, PassoError

if TYPE_CHECKING:
    from passo.job.batch.comparison import Comparison


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo lab`."""
    from passo.job.batch.comparison import WEIGHTS

    parser.add_argument("file", help="the G-code file")
    add_machine(parser)
    add_policy(parser)
    add_skips(parser)
    words = "; ".join(f"{name}: {text}" for name, text in WEIGHTS.items())
    parser.add_argument(
        "--weight",
        choices=tuple(WEIGHTS),
        default="balance",
        help=f"what matters most for the best setting. {words}; default: balance",
    )
    parser.add_argument(
        "--compare",
        metavar="STREAM",
        help="also measure the output of Klipper's batch mode for the same file (klippy.py -o)",
    )
    parser.add_argument(
        "--dictionary",
        metavar="DICT",
        help="the data dictionary of that stream (klippy.py -d); default: its name with .dict",
    )
    parser.add_argument(
        "--output", metavar="PAGE.html", help="also write a page with pictures; default: none"
    )
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )


def run(arguments: argparse.Namespace) -> int:
    """Prints the file under each setting on the simulated machine, and then a table or one JSON
    object. Warnings go to stderr."""
    from dataclasses import replace

    from passo import config
    from passo.cli.machine_option import replaces_input
    from passo.job.batch.laboratory import run_laboratory

    if arguments.output is not None and replaces_input(arguments):
        return ExitStatus.USAGE
    shows = sys.stderr.isatty() and not arguments.json

    def progress(done: int, of: int) -> None:
        if shows:
            print(f"\r\033[K{done} of {of} prints", end="", file=sys.stderr, flush=True)

    machine = config.load(arguments.machine)
    compared = None
    if arguments.compare is not None:
        from passo.job.batch.recorded_stream import RecordedStream

        compared = RecordedStream(arguments.compare, arguments.dictionary)
    policy = replace(policy_of(arguments), skips=skips_of(arguments))
    try:
        found = run_laboratory(
            machine,
            arguments.file,
            arguments.weight,
            policy=policy,
            progress=progress,
            compared=compared,
            workers=os.cpu_count() or 1,
        )
    except PassoError as error:
        if arguments.json:
            print(json.dumps({"errors": [str(problem) for problem in error.problems]}))
        raise
    finally:
        if shows:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
    for line in found.warnings:
        print(line, file=sys.stderr)
    if arguments.output is not None:
        _write(found, Path(arguments.output))
    if arguments.json:
        print(json.dumps(found.as_dict()))
    else:
        from passo.cli.tables import lab_table

        print(lab_table(found))
    return ExitStatus.DONE


def _write(found: Comparison, output: Path) -> None:
    from passo.learn.lab_page import write_lab_page

    try:
        write_lab_page(found, output)
    except OSError as error:
        raise InputError.of(
            "output.unwritable", str(output), value=error.strerror or str(error)
        ) from None
    print(f"{output}: {output.stat().st_size / 1e3:.0f} kB", file=sys.stderr)
