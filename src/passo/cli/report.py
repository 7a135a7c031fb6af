"""`passo report`: one page with pictures of a print."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from passo.cli.machine_option import add_machine, add_policy, policy_of, replaces_input
from passo.errors import ExitStatus, InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo report`."""
    parser.add_argument("file", help="the G-code file")
    parser.add_argument(
        "--output",
        default="report.html",
        metavar="PAGE.html",
        help="the page to write; default: report.html",
    )
    add_machine(parser)
    add_policy(parser)


def run(arguments: argparse.Namespace) -> int:
    """Prints the file on the simulated board and writes the page."""
    if replaces_input(arguments):
        return ExitStatus.USAGE
    from passo import config
    from passo.learn.report import write_report

    machine, output = config.load(arguments.machine), Path(arguments.output)
    try:
        result = write_report(machine, arguments.file, output, policy_of(arguments))
    except OSError as error:
        raise InputError.of(
            "output.unwritable", str(output), value=error.strerror or str(error)
        ) from None
    for line in result.warnings:
        print(line, file=sys.stderr)
    size = output.stat().st_size
    shown = f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.0f} kB"
    print(f"{output}: {shown}", file=sys.stderr)
    return ExitStatus.DONE
