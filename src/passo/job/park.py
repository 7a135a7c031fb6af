"""Out of the way while a print is paused, and back to the very point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo.printer.faults import problem_of
from passo.printer.slots import E, X, Y, Z

if TYPE_CHECKING:
    from passo.printer.printer import Printer


LOAD_MM_S, UNLOAD_MM_S = 6.0, 20.0  # as M701 and M702


class Park:
    """Lifts the nozzle, takes the filament back a little and goes to the machine's parking place,
    while the print stands aside. Its methods are called with the turn, the job being suspended."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._away = False
        self._retracted_mm = 0.0
        self._load_mm = 0.0

    async def leave(self, words: Mapping[str, float] = MappingProxyType({})) -> None:
        """To the parking place; without one, or if an axis does not know where it is, nowhere.
        Words of M600 take the place of the machine's: E takes filament back and Z lifts by so many
        mm, X and Y are the place; U unloads so many mm there, and L loads so many before it comes
        back."""
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
        extrudes = printer.can_extrude()
        self._retracted_mm = abs(words.get("E", park.retract_mm)) if extrudes else 0.0
        self._load_mm = abs(words.get("L", 0.0))
        lift_mm = abs(words.get("Z", park.raise_mm))
        top = printer.machine.axes["z"].max_mm
        self._away = True
        self._push(-self._retracted_mm, park.retract_mm_s)
        drive.move({Z: min(at[Z] + lift_mm, max(top, at[Z]))}, math.inf)
        place = dict(zip((X, Y), park.position_mm or (), strict=False))
        place |= {slot: words[letter] for slot, letter in ((X, "X"), (Y, "Y")) if letter in words}
        if place and not drive.move(place, park.speed_mm_s):
            printer.tell(f"echo:The nozzle stays over the print: {problem_of(printer.job, '')}")
        if extrudes:
            self._push(-abs(words.get("U", 0.0)), UNLOAD_MM_S)
        await self._still()

    def _push(self, mm: float, speed_mm_s: float) -> None:
        """So much filament out of the nozzle."""
        if mm:
            at = self._printer.job.machine_position[E]
            self._printer.drive.move({E: at + mm}, speed_mm_s)

    async def come_back(self) -> None:
        """To where the print was left, over it first and then down. A babystep meanwhile
        moves that place, also where there is no parking."""
        printer = self._printer
        park = printer.machine.park
        await self._still()
        printer.raise_if_halted()
        drive, job = printer.drive, printer.job
        if job.suspended:
            job.use_tool_at_stop()  # what was drawn back is its filament
            await printer.warm_again()
        if self._away and job.suspended and printer.can_extrude():
            self._push(self._load_mm, LOAD_MM_S)
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
                self._push(self._retracted_mm, park.retract_mm_s)
            self._away = False
            await self._still()

    async def _still(self) -> None:
        printer = self._printer
        printer.drive.flush()
        await printer.drive.until(lambda: printer.drive.standing or bool(printer.halted))
