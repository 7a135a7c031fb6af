"""Builds images in a separate process: `python -m passo.toolchain.build_job`.

It reads one JSON object from standard input: `text` with `name`, a machine file and its name in
messages, or `board`, a shipped board; and `output`, the folder of the images. It prints a line for
each step. The exit status is 0 if all images were made.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from passo import config
from passo.errors import FirmwareError, PassoError
from passo.toolchain.build import build
from passo.toolchain.targets import Target, board_target, machine_target

_NICE = 10  # the printer has priority


def main() -> int:
    """Builds the images that standard input asks for."""
    os.nice(_NICE)
    order: dict[str, Any] = json.load(sys.stdin)
    made = 0
    try:
        for aim in targets(order):
            _tell(f"{aim.name}: compiling for {aim.board.mcu} ({aim.board.name})")
            image, about = build(aim, Path(order["output"]))
            _tell(
                f"{image.name}: {about.flash_bytes} of {about.flash_size} bytes of flash,"
                f" {about.ram_bytes} of {about.ram_size} of RAM, by {about.compiler}"
            )
            made += 1
    except PassoError as error:
        _tell(str(error))
        return error.status
    if not made:
        _tell("No board of this machine runs Passo's firmware: there is nothing to build.")
        return 1
    return 0


def targets(order: dict[str, Any]) -> Iterator[Target]:
    """The boards of an order, with a line for each that is left out. Raises PassoError."""
    if order.get("board"):
        yield board_target(order["board"])
        return
    machine = config.load_text(order["text"], order["name"])
    for name in machine.all_boards:
        try:
            yield machine_target(machine, name)
        except FirmwareError as error:
            _tell(f"{name or 'The main board'} is left out: {error}")


def _tell(line: str) -> None:
    print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main())
