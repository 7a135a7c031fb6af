"""`--clock`: how fast virtual time may run."""

from __future__ import annotations

import argparse
import time
from math import inf

_LOOK_S = 0.25
_LEAST = 1e-3  # an hour of print time then takes weeks; years would be too long


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
    """None for virtual time, else print seconds per real second."""
    return None if text == "virtual" else factor(text, "virtual", 1e6)


def factor(text: str, other: str, most: float) -> float:
    """`real`, or a factor up to `most`; `other` is the third word that is allowed. Raises
    ArgumentTypeError."""
    try:
        times = 1.0 if text == "real" else float(text)
    except ValueError:
        times = 0.0
    if not _LEAST <= times <= most:
        limit = f"{other}, real, or a factor from {_LEAST:g} to {most:,.0f}"
        raise argparse.ArgumentTypeError(f"{text!r} is not {limit}")
    return times


class Pace:
    """Keeps print time from running ahead of real time; scale None lets it run."""

    def __init__(self, scale: float | None) -> None:
        self._scale = scale
        self._start = time.monotonic()

    @property
    def every_s(self) -> float:
        """The print time until the next check, so that the machine does not work in bursts."""
        return inf if self._scale is None else _LOOK_S * self._scale

    def keep(self, print_s: float) -> None:
        """Waits until this print time is due."""
        if self._scale is None:
            return
        ahead = print_s / self._scale - (time.monotonic() - self._start)
        if ahead > 0:
            time.sleep(ahead)
