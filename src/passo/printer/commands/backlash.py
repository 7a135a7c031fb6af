"""M425: backlash compensation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.motion import MAX_GAP_MM, SMOOTHS_MM
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.gcode.parameters import number
from passo.gcode.registry import Subject, When, command
from passo.printer.wait_requests import Wait, WaitForMoves

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.wait_requests import Reply


class BacklashCommands:
    """The backlash compensation of one job. A new value takes effect at standstill, after the moves
    before the command; positions stay. `gaps_mm` has the gaps of the axes that have their own
    motors, by letter; `share` of them is compensated, over `smooth_mm` after each turn."""

    def __init__(self, machine: MachineConfig, job: _core.Job) -> None:
        self._job = job
        own = machine.geometry.actuators
        self.gaps_mm = {axis.upper(): mm for axis, mm in machine.gaps_mm.items() if axis in own}
        self.smooth_mm = machine.backlash.smooth_mm
        self.share = 1.0

    @command(
        "M425",
        Subject.SPEED,
        When.PLANNED,
        "Sets the gaps in the drives of axes, the share of them that is compensated (F, 0 to 1) and"
        " the distance over which a motor takes up a gap after a turn (S); without a word reports"
        " them. The machine stops for a change.",
        number("X Y Z", "the gap", "mm", 0, MAX_GAP_MM),
        number("F", "the share that is compensated", low=0, high=1),
        number("S", "the distance over which a motor takes up a gap", "mm", *SMOOTHS_MM),
    )
    def _set(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        if not words:
            reply.say(self.line())
            return None
        share, smooth_mm = words.get("F", self.share), words.get("S", self.smooth_mm)
        gaps_mm = dict(self.gaps_mm)
        for axis in "XYZ":
            mm = words.get(axis)
            if mm is not None and (axis in gaps_mm or mm != 0):
                if axis not in gaps_mm:
                    limit = f"0, as no motor moves {axis} alone on this machine"
                    raise CommandError.bad_value(axis, mm, limit)
                gaps_mm[axis] = mm
        for axis, mm in gaps_mm.items():
            if not 0 <= mm <= min(MAX_GAP_MM, smooth_mm):
                limit = f"0 to {MAX_GAP_MM:g} mm, and at most S, {numeral(smooth_mm)} mm"
                raise CommandError.bad_value(axis, mm, limit)
        if (gaps_mm, share, smooth_mm) == (self.gaps_mm, self.share, self.smooth_mm):
            return None
        self.gaps_mm, self.share, self.smooth_mm = gaps_mm, share, smooth_mm

        def apply() -> None:
            for axis, mm in gaps_mm.items():
                self._job.filters.set("gaps", "XYZ".index(axis), [share * mm, smooth_mm])

        return WaitForMoves(apply)

    def line(self) -> str:
        """M425 with the current values."""
        gaps = "".join(f" {axis}{numeral(mm)}" for axis, mm in self.gaps_mm.items())
        return f"M425 F{numeral(self.share)} S{numeral(self.smooth_mm)}{gaps}"
