"""Homing without switches: axes move until their motors stall."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from passo.errors import CommandError

if TYPE_CHECKING:
    from passo.motion.endstop_search import EndstopSearch
    from passo.motion.homing_parts import HomingPart
    from passo.motion.stall_homing import StallHoming


class StallSearch:
    """Moves axes of one printer to their ends. Methods raise as those of `EndstopSearch`."""

    def __init__(self, search: EndstopSearch, stalls: StallHoming) -> None:
        self._search, self._stalls = search, stalls

    async def home(
        self,
        homings: Sequence[HomingPart],
        travel: Sequence[float],
        speeds: Sequence[float],
        *,
        once: bool,
    ) -> None:
        """Moves axes until their motors stall, and a little back. A stall within the first
        millimetres does not count: the axis was at its end, or the threshold is wrong. Then they
        move away and home once more, unless `once`."""
        of = {
            homing.name: [switch for switch in homing.switches if switch.watched]
            for homing in homings
        }
        watched = [switch for switches in of.values() for switch in switches]
        speed_of = {s: v for w, v in zip(homings, speeds, strict=True) for s in of[w.name]}
        async with self._stalls.detecting(speed_of):
            for last in (once, True):
                stuck = await self._stalls.still_shown(watched)
                if stuck is not None:
                    raise self._search.problem("machine.stall-shown", stuck, 0.0)
                for homing, far in zip(homings, travel, strict=True):
                    self._search.place(homing, homing.home - homing.sign * far)
                before = self._stalls.counts(watched)
                await self._search.seek(homings, travel, speeds)
                moved = {w.name: self._stalls.travel(of[w.name], before) for w in homings}
                early = [w for w in homings if moved[w.name] < w.least_travel]
                if not early:
                    break
                if last:
                    homing = early[0]
                    raise self._search.problem(
                        "machine.stall-early", homing.switches[0], moved[homing.name]
                    )
                await self._search.go([-2 * homing.least_travel for homing in homings], homings)
            if not once:
                await self._search.go([-homing.config.retract for homing in homings], homings)

    async def within(self, homing: HomingPart, far: float, back: float | None) -> float | None:
        """Moves an axis by at most `far` towards its end until its motor stalls, and then `back`,
        by default as far as it has moved. Returns the travel until the stall; None if it did not
        stall."""
        async with self._stalls.detecting(dict.fromkeys(homing.switches, homing.config.fast)):
            moved = await self._at_most(homing, far)
            by = far if moved is None else moved if back is None else back
            await self._search.go([-by], [homing])
        return moved

    async def _at_most(self, homing: HomingPart, far: float) -> float | None:
        stuck = await self._stalls.still_shown(homing.switches)
        if stuck is not None:
            raise self._search.problem("machine.stall-shown", stuck, 0.0)
        self._search.place(homing, homing.home - homing.sign * far)
        before = self._stalls.counts(homing.switches)
        try:
            await self._search.seek([homing], [far], [homing.config.fast])
        except CommandError as error:
            if error.problems[0].code != "machine.stall-missed":
                raise
            return None
        return self._stalls.travel(homing.switches, before)
