"""`--clock`: the speed of virtual time."""

from __future__ import annotations

import argparse
import time
from math import inf

_LOOK_S = 0.25
_LEAST = 1e-3  # at this scale an hour of print time takes six weeks


def add_clock(parser: argparse.ArgumentParser) -> None:
    """`--clock virtual|real|SCALE`."""
    parser.add_argument(
        "--clock",
        type=_scale,
        default=None,
        metavar="virtual|real|SCALE",
        help="virtual: as fast as possible (default); real; or a factor of real time",
    )


def _scale(text: str) -> float | None:
    """The scale in print seconds per real second; None for virtual time."""
    return None if text == "virtual" else factor(text, "virtual", 1e6)


def factor(text: str, other: str, most: float) -> float:
    """The factor: 1 for `real`, or a number up to `most`. `other` is the other allowed word, for
    the error text. Raises ArgumentTypeError."""
    try:
        times = 1.0 if text == "real" else float(text)
    except ValueError:
        times = 0.0
    if not _LEAST <= times <= most:
        limit = f"{other}, real, or a factor from {_LEAST:g} to {most:,.0f}"
        raise argparse.ArgumentTypeError(f"{text!r} is not {limit}")
    return times


class Pace:
    """Delays print time to `scale` times real time; None does not delay."""

    def __init__(self, scale: float | None) -> None:
        self._scale = scale
        self._start = time.monotonic()

    @property
    def every_s(self) -> float:
        """The print time between two checks, short enough that the machine moves evenly."""
        return inf if self._scale is None else _LOOK_S * self._scale

    def keep(self, print_s: float) -> None:
        """Waits until this print time is due."""
        if self._scale is None:
            return
        ahead = print_s / self._scale - (time.monotonic() - self._start)
        if ahead > 0:
            time.sleep(ahead)
