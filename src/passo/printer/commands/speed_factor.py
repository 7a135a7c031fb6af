"""M220: the factor by which a program's speeds are scaled."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.printer.commands.ranges import beyond

if TYPE_CHECKING:
    from passo import _core

_PERCENT = (10.0, 1000.0)


class SpeedFactor:
    """What M220 asks for of one job; `kept` is the factor that B has kept for R."""

    def __init__(self, job: _core.Job) -> None:
        self._job = job
        self.kept = 1.0

    def asked(self, command: Command) -> tuple[float | None, str]:
        """The factor that S gives, or R takes back; None if it is to stay. And a note if S is
        beyond the limits, of which the nearer one is taken. B keeps the one that holds. Raises
        CommandError."""
        words, letters = command.words(), set(re.findall("[BR]", command.text.upper()))
        factor, note = self.kept if "R" in letters else None, ""
        if "S" in words:
            percent, (low, high) = words["S"], _PERCENT
            if percent <= 0:
                raise CommandError.bad_value("S", percent, f"{low:g} to {high:g} percent")
            taken = min(max(percent, low), high)
            factor = taken / 100
            note = beyond("M220", percent, _PERCENT, "%")
        if "B" in letters:
            self.kept = self._job.speed_factor
        return factor, note
