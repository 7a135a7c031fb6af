"""`passo check FILE.toml`: is this machine file right?"""

from __future__ import annotations

import argparse
import json

from passo.errors import ConfigError, ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo check`."""
    parser.add_argument("file", metavar="FILE.toml", help="machine file, or name of a shipped one")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(arguments: argparse.Namespace) -> int:
    """Prints one line on success; raises ConfigError with every problem otherwise."""
    from passo import config

    try:
        machine = config.load(arguments.file)
    except ConfigError as error:
        if not arguments.json:
            raise
        problems = [problem.as_dict() for problem in error.problems]
        print(json.dumps({"file": arguments.file, "ok": False, "problems": problems}, indent=2))
        return error.status
    if arguments.json:
        print(json.dumps({"file": arguments.file, "ok": True, "problems": []}))
    else:
        axes, steppers = len(machine.axes), len(machine.steppers)
        print(f"{arguments.file}: ok: {machine.name}, {machine.geometry.kind}, ", end="")
        print(f"{axes} axes, {steppers} steppers, {machine.board.name}")
    return ExitStatus.DONE
