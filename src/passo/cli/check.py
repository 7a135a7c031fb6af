"""`passo check FILE.toml`: is this machine file right?"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from passo.errors import ConfigError, ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo check`."""
    parser.add_argument("file", metavar="FILE.toml", help="machine file, or name of a shipped one")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(arguments: argparse.Namespace) -> int:
    """Prints one line on success, one for each value that the file cannot mean, and one for each
    pin that is not the board's own for its part. Raises ConfigError with every problem otherwise.
    """
    from passo import config
    from passo.config.originals import bindings

    try:
        machine, questions = config.load_and_question(arguments.file)
    except ConfigError as error:
        if not arguments.json:
            raise
        problems = [problem.as_dict() for problem in error.problems]
        print(json.dumps({"file": arguments.file, "ok": False, "problems": problems}, indent=2))
        return error.status
    pins = bindings(machine)
    if arguments.json:
        rows = [asdict(pin) | {"rebound": pin.rebound} for pin in pins]
        asked = [question.as_dict() for question in questions]
        report = {"file": arguments.file, "ok": True, "problems": [], "questions": asked}
        report |= {"pins": rows}
        print(json.dumps(report, indent=2))
    else:
        axes, steppers = len(machine.axes), len(machine.steppers)
        print(f"{arguments.file}: ok: {machine.name}, {machine.geometry.kind}, ", end="")
        others = [f"{name}: {board.name}" for name, board in machine.boards.items()]
        print(f"{axes} axes, {steppers} steppers, {', '.join([machine.board.name, *others])}")
        for question in questions:
            print(f"  Question: {question}")
        for pin in pins:
            if pin.rebound:
                print(f"  {pin.key}: {_named(pin.name, pin.pin)}", end="")
                print(f", the board's own is {_named(pin.original_name, pin.original)}")
        for board in machine.all_boards.values():
            for note in board.notes:
                print(f"  Note: {note}")
    return ExitStatus.DONE


def _named(name: str | None, pin: str | None) -> str:
    """`D10 (PB4)`, or one of them where they are the same."""
    return f"{name} ({pin})" if name != pin else str(pin)
