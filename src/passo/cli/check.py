"""`passo check FILE.toml`: reports the errors of a machine file."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from passo.errors import CommandError, ConfigError, ExitStatus

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo check`."""
    parser.add_argument("file", metavar="FILE.toml", help="machine file, or name of a shipped one")
    parser.add_argument(
        "--state",
        metavar="DIR",
        help="the --state folder of passo serve: list its settings that override the file",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(arguments: argparse.Namespace) -> int:
    """Prints a line on success, and a line for each value that is not used as written, for each pin
    that differs from the board's default, and for each stored setting that overrides the file.
    Raises ConfigError with every problem, and CommandError if the stored settings must not be
    used."""
    from passo import config
    from passo.config.board_defaults import bindings
    from passo.config.notes import notes, unchecked_boards

    try:
        machine, questions, _ = config.load_and_question(arguments.file)
    except ConfigError as error:
        if not arguments.json:
            raise
        problems = [problem.as_dict() for problem in error.problems]
        print(json.dumps({"file": arguments.file, "ok": False, "problems": problems}, indent=2))
        return error.status
    pins = bindings(machine)
    stored, unusable = _stored(machine, arguments.state)
    if arguments.json:
        rows = [asdict(pin) | {"rebound": pin.rebound} for pin in pins]
        asked = [question.as_dict() for question in questions]
        report = {"file": arguments.file, "ok": True, "problems": [], "questions": asked}
        report |= {"unchecked_boards": unchecked_boards(machine), "notes": list(notes(machine))}
        report |= {"pins": rows, "stored": stored}
        if unusable is not None:
            report |= {"ok": False, "problems": [p.as_dict() for p in unusable.problems]}
        print(json.dumps(report, indent=2))
    else:
        axes = len(machine.axes) - (0 if machine.geometry.actuators else 3)
        steppers = len(machine.steppers)
        print(f"{arguments.file}: ok: {machine.name}, {machine.geometry.kind}, ", end="")
        others = [f"{name}: {board.name}" for name, board in machine.boards.items()]
        unchecked = " (pins not checked)" if unchecked_boards(machine) else ""
        boards = ", ".join([machine.board.name, *others])
        print(f"{axes} axes, {steppers} steppers, {boards}{unchecked}")
        for question in questions:
            print(f"  Question: {question}")
        for pin in pins:
            if pin.rebound:
                print(f"  {pin.key}: {_named(pin.name, pin.pin)}", end="")
                print(f", the board's own is {_named(pin.original_name, pin.original)}")
        for note in notes(machine):
            print(f"  Note: {note}")
        for sentence in stored:
            print(f"  {sentence}")
        if unusable is not None:
            raise unusable
    return ExitStatus.DONE if unusable is None else unusable.status


def _stored(machine: MachineConfig, state: str | None) -> tuple[list[str], CommandError | None]:
    """Lines about the settings that are stored in the folder and override the file, or the reason
    why they must not be used."""
    if state is None:
        return [], None
    from passo.library.state_check import stored_overrides

    try:
        return stored_overrides(machine, Path(state)) or [f"Nothing in {state} overrides it"], None
    except CommandError as error:
        return [], error


def _named(name: str | None, pin: str | None) -> str:
    """`D10 (PB4)`, or one name if both are the same."""
    return f"{name} ({pin})" if name != pin else str(pin)
