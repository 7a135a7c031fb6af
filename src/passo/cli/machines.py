"""`passo machines`: the machines that come with Passo."""

from __future__ import annotations

import argparse
import json

from passo.cli.tables import columns
from passo.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options of `passo machines`."""
    parser.add_argument("--json", action="store_true", help="print one JSON list")


def run(arguments: argparse.Namespace) -> int:
    """Prints a table, a line a machine: name, geometry, size, steppers, board."""
    from passo import config

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
