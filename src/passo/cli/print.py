"""`passo print`: prints a file to its end on a simulated board."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace

from passo.cli.clock import Pace, add_clock
from passo.cli.machine_option import (
    add_assume_ready,
    add_machine,
    add_policy,
    add_skips,
    policy_of,
    skips_of,
)
from passo.errors import ExitStatus, PassoError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo print`."""
    parser.add_argument("file", help="the G-code file")
    add_machine(parser)
    add_clock(parser)
    add_policy(parser)
    add_skips(parser)
    add_assume_ready(parser)
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )


def run(arguments: argparse.Namespace) -> int:
    """Prints the file, and then a table or one JSON object with the result. Warnings go to
    stderr."""
    from passo import config
    from passo.cli.progress import ProgressBar
    from passo.job.batch.result import PrintResult
    from passo.job.batch.simulated_print import Print, Progress

    pace = Pace(arguments.clock)
    result = PrintResult(file=arguments.file, machine=arguments.machine)
    try:
        machine = config.load(arguments.machine)
        result.machine = machine.name
        with ProgressBar(quiet=arguments.json) as bar:

            def show(at: Progress) -> None:
                pace.keep(at.print_s)
                bar.show(at)

            policy = replace(
                policy_of(arguments),
                checked=not arguments.assume_ready,
                skips=skips_of(arguments),
            )
            job = Print(machine, policy, show, pace.every_s)
            job.run(arguments.file, result=result)
    except PassoError as error:
        if arguments.json:
            result.errors = [str(problem) for problem in error.problems]
            print(json.dumps(result.as_dict()))
        raise
    for line in result.warnings + result.errors:
        print(line, file=sys.stderr)
    if arguments.json:
        print(json.dumps(result.as_dict()))
    else:
        from passo.cli.tables import print_table

        print(print_table(result))
    return ExitStatus.MACHINE_FAULT if result.errors else ExitStatus.DONE
