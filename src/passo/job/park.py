"""Out of the way while a print is paused, and back to the very point."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from passo.printer.slots import E, X, Y, Z

if TYPE_CHECKING:
    from passo.printer.printer import Printer


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
        if not printer.job.suspended:
            return  # cancelled meanwhile
        drive, at = printer.drive, printer.job.stop_position
        self._retracted_mm = park.retract_mm if printer.can_extrude() else 0.0
        top = printer.machine.axes["z"].max_mm
        self._away = True
        drive.move({E: printer.job.machine_position[E] - self._retracted_mm}, park.retract_mm_s)
        drive.move({Z: min(at[Z] + park.raise_mm, max(top, at[Z]))}, math.inf)
        if park.position_mm is not None:
            x, y = park.position_mm
            drive.move({X: x, Y: y}, park.speed_mm_s)
        await self._still()

    async def come_back(self) -> None:
        """To where the print was left, over it first and then down. A babystep meanwhile
        moves that place, also where there is no parking."""
        printer = self._printer
        park = printer.machine.park
        await self._still()
        printer.raise_if_halted()
        drive, job = printer.drive, printer.job
        at: list[float] | None = None
        while job.suspended and at != job.stop_position:
            at = job.stop_position
            # Axes that do not know where they are have not been moved by anybody.
            known = [slot for slot in (X, Y, Z) if slot not in job.locked_axes]
            across = {slot: at[slot] for slot in known if slot != Z}
            drive.move(across, park.speed_mm_s if park else math.inf)
            if Z in known:
                drive.move({Z: at[Z]}, math.inf)
            if self._away and park is not None and printer.can_extrude():
                drive.move({E: job.machine_position[E] + self._retracted_mm}, park.retract_mm_s)
            self._away = False
            await self._still()

    async def _still(self) -> None:
        printer = self._printer
        printer.drive.flush()
        await printer.drive.until(lambda: printer.drive.standing or bool(printer.halted))
