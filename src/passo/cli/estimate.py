"""`passo estimate`: how long a file takes, and why."""

from __future__ import annotations

import argparse
import json
import sys

from passo.cli.machine_option import add_machine, add_policy
from passo.errors import ExitStatus, PassoError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo estimate`."""
    parser.add_argument("file", help="the G-code file")
    add_machine(parser)
    add_policy(parser)
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )


def run(arguments: argparse.Namespace) -> int:
    """Plans the file and prints a table, or one JSON object."""
    from passo import config
    from passo.cli.tables import estimate_table
    from passo.job.estimate import Estimate, estimate

    name = arguments.machine
    try:
        machine = config.load(name)
        name = machine.name
        result = estimate(
            machine,
            arguments.file,
            clamp=arguments.out_of_range == "clamp",
            ignore_tools=arguments.missing_tool == "ignore",
        )
    except PassoError as error:
        if arguments.json:
            told = [str(problem) for problem in error.problems]
            print(json.dumps(Estimate(arguments.file, name, errors=told).as_dict()))
        raise
    for line in result.warnings:
        print(line, file=sys.stderr)
    print(json.dumps(result.as_dict()) if arguments.json else estimate_table(result))
    return ExitStatus.DONE
