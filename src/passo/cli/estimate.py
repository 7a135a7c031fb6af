"""`passo estimate`: the print time of files, and its causes."""

from __future__ import annotations

import argparse
import json
import sys

from passo.cli.machine_option import add_assume_ready, add_machine, add_policy, add_skips, skips_of
from passo.errors import ExitStatus, PassoError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo estimate`."""
    parser.add_argument("files", nargs="+", metavar="file", help="a G-code file, or several")
    add_machine(parser)
    add_policy(parser)
    add_skips(parser)
    add_assume_ready(parser)
    parser.add_argument(
        "--json",
        action="store_true",
        help="print JSON and nothing else: an object, of several files a list with an object each",
    )


def run(arguments: argparse.Namespace) -> int:
    """Plans the files and prints a table for each, or JSON. If a file fails, the others are still
    planned; the exit status is that of the first failure."""
    from passo import config
    from passo.job.batch.estimate import Estimate, estimate

    status, results = ExitStatus.DONE, list[Estimate]()
    machine, name = None, arguments.machine
    for path in arguments.files:
        try:
            machine = machine or config.load(name)
            result = estimate(
                machine, path, skips=skips_of(arguments), checked=not arguments.assume_ready
            )
        except PassoError as error:
            status = status or error.status
            problems = [str(problem) for problem in error.problems]
            known = name if machine is None else machine.name
            results.append(Estimate(path, known, errors=problems))
            _report(problems)
            if machine is None and not arguments.json:
                break
            continue
        _report(result.warnings)
        if not arguments.json:
            from passo.cli.tables import estimate_table

            print(("\n" if results else "") + estimate_table(result))
        results.append(result)
    if arguments.json:
        objects = [result.as_dict() for result in results]
        print(json.dumps(objects if len(objects) > 1 else objects[0]))
    return status


def _report(lines: list[str]) -> None:
    for line in lines:
        print(line, file=sys.stderr)
