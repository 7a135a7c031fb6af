"""One run of homing: axes and arms that share no motor home at the same time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from passo.errors import MachineError, PassoError
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import Z
from passo.motion.endstop_search import LOST
from passo.motion.endstops import is_actuator
from passo.motion.real_travel import RealTravel

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.endstop_search import EndstopSearch
    from passo.motion.homed_positions import HomedPositions
    from passo.motion.homing_parts import HomingPart, HomingParts
    from passo.motion.lone_motors import LoneMotors
    from passo.motion.rig import Rig
    from passo.motion.stall_search import StallSearch
    from passo.motion.triggered_moves import Interrupts


class HomingRun:
    """Homes axes and arms of one printer, within `TriggeredMoves.prepared`. Methods raise as those
    of `EndstopSearch`."""

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        parts: HomingParts,
        search: EndstopSearch,
        stalls: StallSearch,
        motors: LoneMotors,
        homed: HomedPositions,
    ) -> None:
        self._rig, self._interrupts, self._parts = rig, interrupts, parts
        self._search, self._stalls = search, stalls
        self._lone_motors, self._homed = motors, homed

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    async def run(
        self,
        homings: Sequence[HomingPart],
        once: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        """Homes axes and arms that share no motor at the same time: fast, back, slowly; or `once`,
        with the maximum distance and the speed for each."""
        rig, job = self._rig, self._rig.job
        arms = any(is_actuator(self._machine, homing.name) for homing in homings)
        of_arms = self._machine.axes_of_arms if arms else ()

        def point_of_arms(joints: Sequence[float]) -> dict[str, float]:
            job.axes.use_joints(False)
            if not arms:
                return {}
            a, b, c = joints
            point = zip("xyz", self._machine.geometry.forward((a, b, c)), strict=True)
            return {name: at for name, at in point if name in of_arms}

        names = [w.name for w in homings if not is_actuator(self._machine, w.name)]
        self._search.joints = arms
        offset_mm = self._homed.offset_mm
        behind = {
            homing.name: self._parts.behind(homing, offset_mm.get(homing.name, 0.0))
            for homing in homings
        }
        real = RealTravel(rig)  # the search lets the positions of the plan be wrong
        try:
            job.axes.use_joints(arms)
            job.axes.set([(i, 0.0) for i in self._parts.unguided() if arms])
            travel = [once[w.name][0] if once else self._parts.travel(w.name) for w in homings]
            speeds = [once[w.name][1] if once else w.config.fast for w in homings]
            for homing, far in zip(homings, travel, strict=True):
                self._search.place(homing, homing.home - homing.sign * far)
            if any(homing.config.stall for homing in homings):
                await self._stalls.home(homings, travel, speeds, once=once is not None)
            else:
                await self._search.seek(homings, travel, speeds)
                if not once:
                    await self._search.again(homings, behind)
        except BaseException as failure:
            self._homed.set(point_of_arms(self._parts.arms_at_home(job.machine_position[Z])))
            try:
                # Boards that have lost each other may not answer for their counts.
                lost = isinstance(failure, PassoError) and failure.problems[0].code == LOST
                if not lost and not isinstance(failure, MachineError):
                    self._keep_count(real, [w for w in homings if w.name in names])
            finally:
                rig.lock([*of_arms, *names])
            raise
        found = {
            w.name: job.machine_position[w.slot] + await self._level(w)
            for w in homings
            if w.name in names
        }
        found |= point_of_arms(job.machine_position[:3])
        self._homed.set_with_offsets(found)

    def _keep_count(self, real: RealTravel, homings: Sequence[HomingPart]) -> None:
        """After a failure, axes are where their motors have really moved them to."""
        if self._interrupts.halted or not homings:
            return
        with suppress(Unreachable):  # the arms stopped where no position belongs to them
            place = real.place()
            for homing in homings:
                self._search.place(homing, place[homing.axis])

    async def _level(self, homing: HomingPart) -> float:
        """Aligns the motors of an axis, each of which is at its own endstop, with the innermost
        motor. Returns the distance of that position from home."""
        offsets_mm = homing.config.offsets_mm
        if not offsets_mm:
            return 0.0
        at = {name: offsets_mm.get(name, 0.0) for name in homing.config.stepper_pins}
        inside = homing.sign * min(homing.sign * mm for mm in at.values())
        by_mm = {name: inside - mm for name, mm in at.items()}
        await self._lone_motors.move(homing.name, by_mm, homing.config.fast)
        return inside
