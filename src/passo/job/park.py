"""Out of the way while a print is paused, and back to the very point."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_X, _Y, _Z, _E, _SLOTS = 0, 1, 2, 3, 8  # the core's order of positions


class Park:
    """Lifts the nozzle, takes the filament back a little and goes to the machine's parking place,
    while the print stands aside. Its methods are called with the turn, the job being suspended."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._away = False
        self._retracted_mm = 0.0

    async def leave(self) -> None:
        """To the parking place; without one, or if an axis does not know where it is, nowhere."""
        printer = self._printer
        park = printer.machine.park
        self._away = False
        if park is None or printer.job.locked_axes:
            return
        await printer.drive.until(lambda: printer.drive.standing or bool(printer.halted))
        printer.raise_if_halted()
        at = printer.job.stop_position
        self._retracted_mm = park.retract_mm if printer.can_extrude() else 0.0
        top = printer.machine.axes["z"].max_mm
        self._away = True
        self._move({_E: printer.job.machine_position[_E] - self._retracted_mm}, park.retract_mm_s)
        self._move({_Z: min(at[_Z] + park.raise_mm, max(top, at[_Z]))}, math.inf)
        if park.position_mm is not None:
            x, y = park.position_mm
            self._move({_X: x, _Y: y}, park.speed_mm_s)
        await self._still()

    async def come_back(self) -> None:
        """To where the print was left, over it first and then down."""
        printer = self._printer
        park = printer.machine.park
        await self._still()
        printer.raise_if_halted()
        if park is None or not printer.job.suspended:
            return
        at = printer.job.stop_position
        if not printer.job.locked_axes:
            self._move({_X: at[_X], _Y: at[_Y]}, park.speed_mm_s)
            self._move({_Z: at[_Z]}, math.inf)
        if self._away and printer.can_extrude():
            self._move(
                {_E: printer.job.machine_position[_E] + self._retracted_mm}, park.retract_mm_s
            )
        self._away = False
        await self._still()

    def _move(self, target: dict[int, float], speed_mm_s: float) -> None:
        places = [target.get(slot, math.nan) for slot in range(_SLOTS)]
        self._printer.drive.before_moves()
        self._printer.job.move_to(places, speed_mm_s)
        self._printer.drive.after_moves()

    async def _still(self) -> None:
        printer = self._printer
        printer.drive.flush()
        await printer.drive.until(lambda: printer.drive.standing or bool(printer.halted))
