"""`--clock`: how fast virtual time may run."""

from __future__ import annotations

import argparse
import time


def add_clock(parser: argparse.ArgumentParser) -> None:
    """`--clock virtual|real|SCALE`."""
    parser.add_argument(
        "--clock",
        type=_scale,
        default=None,
        metavar="virtual|real|SCALE",
        help="virtual: as fast as it goes (default); real; or so many times as fast as real",
    )


def _scale(text: str) -> float | None:
    """None for virtual time, else print seconds by real second."""
    if text == "virtual":
        return None
    if text == "real":
        return 1.0
    try:
        scale = float(text)
    except ValueError:
        scale = 0.0
    if not 0 < scale <= 1e6:
        raise argparse.ArgumentTypeError(f"{text!r} is not virtual, real, or a factor above 0")
    return scale


class Pace:
    """Keeps print time from running ahead of real time; scale None lets it run."""

    def __init__(self, scale: float | None) -> None:
        self._scale = scale
        self._start = time.monotonic()

    def keep(self, print_s: float) -> None:
        """Waits until this print time may have come."""
        if self._scale is None:
            return
        ahead = print_s / self._scale - (time.monotonic() - self._start)
        if ahead > 0:
            time.sleep(ahead)
