"""Flashes an image in a process of its own: `python -m passo.toolchain.flash_job`.

It reads one line of JSON from standard input: `text` with `name`, or `board`, as
`passo.toolchain.build_job` does; `image`, the path of an image of that build; and `port`, or null.
It prints a line for each step. A line that begins with `ASKS` is a manual step: the job continues
when a line arrives on standard input, and ends without flashing at the end of the input. The exit
status is 0 if the board was flashed and verified.
"""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path
from typing import Any

from passo.errors import FirmwareError, PassoError
from passo.toolchain.build_job import targets
from passo.toolchain.flashing import User, flash

ASKS = "\x05"  # the ASCII character for an enquiry


def main() -> int:
    """Flashes the ordered image."""
    order: dict[str, Any] = json.loads(sys.stdin.readline())
    image = Path(order["image"])
    try:
        aim = next(aim for aim in targets(order) if aim.name == image.stem)
        asyncio.run(flash(aim.name, aim.board, order["port"], image, User(_tell, _wait)))
    except PassoError as error:
        _tell(str(error))
        return error.status
    return 0


def _tell(line: str) -> None:
    print(line, flush=True)


def _wait(text: str) -> None:
    _tell(f"{ASKS}{text}")
    if not sys.stdin.readline():
        raise FirmwareError.of("firmware.nobody", value=text.rstrip("."))


if __name__ == "__main__":
    sys.exit(main())
