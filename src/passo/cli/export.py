"""`passo export --klipper MACHINE`: converts a machine file to a configuration of another
firmware."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from passo.errors import ExitStatus, InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments of `passo export`."""
    parser.add_argument("machine", metavar="MACHINE", help="a machine file, or a shipped machine")
    parser.add_argument(
        "--klipper", action="store_true", required=True, help="write a printer.cfg of Klipper"
    )
    parser.add_argument(
        "--output", metavar="FILE", default="printer.cfg", help="the file to make: printer.cfg"
    )


def run(arguments: argparse.Namespace) -> int:
    """Writes the configuration, and prints what it cannot contain. Raises ConfigError for a machine
    file with errors or a geometry that cannot be exported, and InputError if an output cannot be
    written."""
    from passo import config
    from passo.config.exporting.klipper import exported

    output = Path(arguments.output)
    if output.exists():
        raise InputError.of("output.exists", str(output))
    machine = config.load(arguments.machine)
    cfg = exported(machine)
    text = cfg.text(f"Made by `passo export` from {machine.name}.")
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        value = error.strerror or os.strerror(error.errno or 0)
        raise InputError.of("output.unwritable", str(output), value=value) from None
    if cfg.left_out:
        print("Left out:", *(f"  {sentence}." for sentence in cfg.left_out), sep="\n")
    print(f"{output}: written. Check serial, nozzle_diameter and filament_diameter in it.")
    return ExitStatus.DONE
