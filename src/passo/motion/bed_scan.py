"""Heights of the bed from a probe that measures while it moves over it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import hypot
from statistics import fmean
from typing import TYPE_CHECKING

from passo._core import Within
from passo.errors import CommandError
from passo.motion.axis_slots import X, Y, Z

if TYPE_CHECKING:
    from passo.motion.eddy_gauge import EddyGauge
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

WITHIN_MM = 2.0  # the values of a place are those of the nozzle within this distance
_POLL_S = 0.1
_AHEAD_S = 1.0  # of planned motion
_LAST_S = 0.1  # for the values of the last place


class BedScan:
    """One move over places, in their order, at the present height of the nozzle. `nozzle_mm` are X
    and Y of the nozzle at each place. Each value of the probe belongs to the place that the nozzle
    was nearest to by the plan when the value was measured, if that is within `WITHIN_MM`. Raises
    as the gauge does."""

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        triggered: TriggeredMoves,
        gauge: EddyGauge,
        nozzle_mm: Sequence[tuple[float, float]],
    ) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self._gauge, self._places = gauge, nozzle_mm
        self._found: list[list[float]] = [[] for _ in nozzle_mm]
        self._here = 0  # the place that the nozzle is nearest to
        self._from_s = 0.0  # earlier values are not of this move

    async def run(self, speed_mm_s: float, passed: Callable[[int, float], None]) -> None:
        """Moves over all places. Calls `passed` with the number of each place and Z of the nozzle
        minus its height above the bed there, mm, in their order."""
        queue, next_move, told = self._rig.queue, 0, 0
        self._from_s = queue.now_s
        while next_move < len(self._places) or not queue.standing:
            while next_move < len(self._places) and queue.ahead_s < _AHEAD_S:
                x, y = self._places[next_move]
                queue.move({X: x, Y: y}, speed_mm_s, Within.ANYTHING)
                next_move += 1
            if next_move == len(self._places):
                queue.flush()
            await self._pass(_POLL_S)
            while told < self._here:
                passed(told, self._height(told))
                told += 1
        await self._pass(_LAST_S)
        for place in range(told, len(self._places)):
            passed(place, self._height(place))

    async def _pass(self, seconds: float) -> None:
        """Lets time pass, and assigns the values that have arrived."""
        queue = self._rig.queue
        end = queue.now + seconds * queue.hz
        await queue.until(lambda: queue.now >= end or self._interrupts.interrupted)
        if self._interrupts.interrupted:
            await self._triggered.standstill()
            self._interrupts.raise_if_interrupted()
        curve = self._gauge.curve
        for at_s, hz in self._gauge.take():
            if at_s < self._from_s:
                continue
            at = self._rig.job.history.position_at(at_s * queue.hz)
            height = curve.height_mm(hz)
            if at is not None:
                self._assign(at[X], at[Y], None if height is None else at[Z] - height)

    def _assign(self, x: float, y: float, mm: float | None) -> None:
        while self._here + 1 < len(self._places) and (
            self._distance(self._here + 1, x, y) < self._distance(self._here, x, y)
        ):
            self._here += 1
        if mm is not None and self._distance(self._here, x, y) <= WITHIN_MM:
            self._found[self._here].append(mm)

    def _distance(self, place: int, x: float, y: float) -> float:
        at_x, at_y = self._places[place]
        return hypot(at_x - x, at_y - y)

    def _height(self, place: int) -> float:
        found = self._found[place]
        if not found:
            x, y = self._places[place]
            raise CommandError.of("probe.no-values", value=f"X{x:g} Y{y:g}")
        return fmean(found)
