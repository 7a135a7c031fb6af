"""`passo machines`: the machines that come with Passo, and their files."""

from __future__ import annotations

import argparse
import json

from passo.cli.tables import columns
from passo.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo machines`."""
    what = parser.add_mutually_exclusive_group()
    what.add_argument("name", metavar="NAME", nargs="?", help="print the file of this machine")
    what.add_argument("--json", action="store_true", help="print one JSON list")


def run(arguments: argparse.Namespace) -> int:
    """Prints a table with one line for each machine (name, geometry, size, steppers, board), or the
    file of one machine."""
    from passo import config

    if arguments.name is not None:
        print(config.shipped_text(arguments.name), end="")
        return ExitStatus.DONE
    machines = [config.load(name) for name in config.shipped_machines()]
    if arguments.json:
        rows = [
            {
                "name": machine.name,
                "description": machine.description,
                "geometry": machine.geometry.kind,
                "size_mm": machine.size_mm,
                "steppers": list(machine.steppers),
                "board": machine.board.name,
            }
            for machine in machines
        ]
        print(json.dumps(rows, indent=2))
        return ExitStatus.DONE
    table = [("NAME", "GEOMETRY", "SIZE MM", "STEPPERS", "BOARD")]
    for machine in machines:
        size = " x ".join(f"{length:g}" for length in machine.size_mm)
        steppers = " ".join(machine.steppers)
        table.append((machine.name, machine.geometry.kind, size, steppers, machine.board.name))
    print(columns(table))
    return ExitStatus.DONE
