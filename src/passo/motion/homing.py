"""Homing: each axis moves fast to its endstop, retracts a little, and approaches it again
slowly."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.motor_roles import axis_order
from passo.errors import CommandError, Problem
from passo.geometry.base import Point
from passo.motion.axis_slots import E, X, Y, Z, slot_of_axis
from passo.motion.endstop_search import EndstopSearch
from passo.motion.endstops import homed_axes, is_actuator
from passo.motion.homed_positions import HomedPositions
from passo.motion.homing_parts import HomingPart, HomingParts
from passo.motion.homing_run import HomingRun
from passo.motion.stall_search import StallSearch
from passo.motion.travel import go_back

if TYPE_CHECKING:
    from passo.board.endstops import Endstops
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.lone_motors import LoneMotors
    from passo.motion.offsets import Offsets
    from passo.motion.probing import Prober
    from passo.motion.rig import Rig
    from passo.motion.stall_homing import StallHoming
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves


class Homer:
    """Homes the axes of one printer. Call it with the motion lock held and the machine idle.
    Methods raise CommandError, and MachineError."""

    def __init__(
        self,
        rig: Rig,
        interrupts: Interrupts,
        offsets: Offsets,
        problem: Callable[[], Problem],
        triggered: TriggeredMoves,
        correction: BedCorrection,
        motors: LoneMotors,
        prober: Prober,
        stalls: StallHoming,
    ) -> None:
        self._rig, self._interrupts, self._offsets = rig, interrupts, offsets
        self._triggered, self._correction = triggered, correction
        self._prober = prober
        self._problem_of_job = problem  # gives the error that stopped the job
        self._axes = axis_order(self._machine.axes)
        self._parts, self._homed = HomingParts(rig), HomedPositions(rig, offsets)
        self._search = EndstopSearch(rig, interrupts, triggered)
        self._stalls = StallSearch(self._search, stalls)
        self._run = HomingRun(
            rig, interrupts, self._parts, self._search, self._stalls, motors, self._homed
        )

    def reset(self) -> None:
        """Call this after the boards have been replaced."""
        self._homed.offset_mm = {}

    @property
    def offset_mm(self) -> dict[str, float]:
        """The home offsets of M206, by axis, at the last homing."""
        return self._homed.offset_mm

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    @property
    def active(self) -> bool:
        """Whether homing or probing is in progress."""
        return self._triggered.active

    @property
    def _endstops(self) -> Endstops:
        return self._triggered.endstops

    @property
    def axes(self) -> set[str]:
        """The axes that are homed by endstops."""
        return homed_axes(self._machine)

    def states(self) -> dict[str, bool]:
        """Asks the boards for the state of every endstop: True if triggered."""
        return {
            switch.label: self._endstops.pressed(switch.name) for switch in self._parts.switches
        }

    async def home(self, letters: str) -> None:
        """Homes the axes of these letters, or all. An axis without an endstop is assumed to be at
        home already. An axis that does not reach its endstop counts as not homed. With the letter
        O, axes that are homed are skipped; with B, the nozzle returns to its earlier position if
        all axes were homed."""
        back = "B" in letters and "b" not in self._axes
        letters = letters.replace("B", "") if back else letters
        before = None if self._rig.job.locked_axes else self._rig.job.machine_position
        with self._homing():
            square = self._rig.square(lambda: bool(self._interrupts.halted))
            with self._correction.suspended(), square:
                await self._home(letters)
        if back and before is not None:
            await self._return(before)

    async def _return(self, to: Sequence[float]) -> None:
        """Returns to a machine position."""
        slots = [slot_of_axis(i) for i in range(len(self._axes))]
        reached = go_back(self._rig, {slot: to[slot] for slot in slots}, math.inf)
        self._rig.queue.flush()
        await self._triggered.standstill()
        self._interrupts.raise_if_interrupted()
        if not reached:
            raise CommandError([self._problem_of_job()])

    async def approach(self, travel: Mapping[str, float], speed: float) -> None:
        """G1 H1: axes or arms, by name, move straight by these distances, in mm or degrees, until
        each has triggered its endstops; then they are homed. `speed` is the speed of the fastest
        one. An axis whose endstop does not trigger is not homed any more."""
        among = {name for name in self._machine.homing if self._parts.switches_of(name)}
        arms = set(self._machine.geometry.arms) & among
        for name, far in travel.items():
            if name not in among:
                limit = f"an axis with an endstop: {', '.join(sorted(among)) or 'none has one'}"
                raise CommandError.of("command.value", axis="H1", value=name, limit=limit)
            if arms & set(travel) and not arms <= set(travel):
                limit = f"all of {', '.join(sorted(arms))}, since arms home together"
                raise CommandError.of("command.value", axis="H1", value=name, limit=limit)
            sign = 1.0 if self._machine.homing[name].direction == "max" else -1.0
            if not 0 < sign * far <= self.travel(name):
                limit = f"towards the endstop, and at most {self.travel(name):g}"
                raise CommandError.bad_value(name.upper(), far, limit)
        fastest = max(map(abs, travel.values()))
        once = {name: (abs(far), speed * abs(far) / fastest) for name, far in travel.items()}
        with self._homing():
            square = self._rig.square(lambda: bool(self._interrupts.halted))
            with self._correction.suspended(), square, self._triggered.prepared():
                await self._run.run([self._parts.of(name) for name in travel], once)

    async def stall_within(self, name: str, far: float, back: float | None) -> float | None:
        """Moves an axis by at most `far` towards its end until its motor stalls, and then `back`,
        by default as far as it has moved. Returns the travel until the stall; None if it did not
        stall. The axis is not homed afterwards."""
        arms, homing = self._machine.geometry.arms, self._parts.of(name)
        with self._homing():
            square = self._rig.square(lambda: bool(self._interrupts.halted))
            with self._correction.suspended(), square, self._triggered.prepared():
                job = self._rig.job
                job.axes.use_joints(name in arms)
                try:
                    return await self._stalls.within(homing, far, back)
                finally:
                    job.axes.use_joints(False)
                    self._rig.lock(self._machine.axes_of_arms if name in arms else [name])

    @contextmanager
    def _homing(self) -> Generator[None]:
        """Use it around homing: within the block, reports show the last position of the program."""
        self._triggered.active = True
        self._rig.positions.freeze()
        try:
            yield
        finally:
            self._triggered.active = False
            self._rig.positions.thaw()

    async def swing(self, x: float, y: float) -> None:
        """Moves the nozzle over X, Y (machine coordinates, mm) with an independent move of each
        arm, because the straight line between two reachable places may leave the range of the
        arms."""
        rig, job, geometry = self._rig, self._rig.job, self._machine.geometry

        def point(position: Sequence[float]) -> Point:
            a, b, c = position[:E]
            return a, b, c

        before = point(job.machine_position)
        target = (x, y, before[Z])
        self._triggered.active = True
        rig.positions.freeze()
        job.axes.use_joints(True)
        job.axes.set(list(enumerate(geometry.inverse(before))))
        try:
            a, b, _ = geometry.inverse(target)
            rig.queue.move({X: a, Y: b}, math.inf, Within.ANYTHING)
            rig.queue.flush()
            await self._triggered.standstill()
        finally:
            reached = target
            if self._interrupts.interrupted:
                reached = geometry.forward(point(job.machine_position))
            job.axes.use_joints(False)
            job.axes.set(list(enumerate(reached)))
            self._triggered.active = False
            rig.positions.thaw()
        self._interrupts.raise_if_interrupted()

    async def _home(self, letters: str) -> None:
        moved = self._machine.moved_axes.values()
        homed = [a for a in moved if not self._machine.axes[a].extruder]
        names = [a for a in homed if a.upper() in letters] or homed
        if "O" in letters and self._machine.unhomed_moves == "refuse":
            unknown = [self._axes[i] for i in self._rig.job.locked_axes]
            names = [name for name in names if name in unknown]
        fixed = [name for name in names if name not in self.axes]
        self._homed.set({name: self._machine.home_mm[name] for name in fixed})
        z, everything = self._machine.homing.get("z"), not letters.strip("O")
        by_probe = z is not None and z.probe and "z" in names and (z.by_default or not everything)
        if z is not None and z.probe:
            await self._rise()
            names = [name for name in names if name != "z"]
        await self._by_switches(names, everything=everything)
        if by_probe:
            await self._by_probe()

    async def _rise(self) -> None:
        """Raises a head with a probe to the start height of a descent, before it moves in X and Y.
        If Z is not homed, it rises by that height."""
        start, z = self._prober.probe.start_mm, self._at(Z)
        by = start if Z in self._rig.job.locked_axes else max(0.0, start - z)
        if by > 0:
            self._rig.queue.move({Z: z + by}, self._prober.probe.lift_mm_s, Within.ANYTHING)
            self._rig.queue.flush()
            await self._triggered.standstill()
            self._interrupts.raise_if_interrupted()

    async def _by_probe(self) -> None:
        """Homes Z with the probe."""
        try:
            await self._prober.home(self.travel("z"))
        except BaseException:
            self._rig.lock(["z"])
            raise
        self._homed.set_with_offsets({"z": self._at(Z)})

    async def _by_switches(self, names: Sequence[str], *, everything: bool) -> None:
        """Homes axes and arms by their endstops, at the same time if they do not share a motor. An
        axis that homes by a stall moves alone."""
        batch: list[HomingPart] = []
        with self._triggered.prepared():
            for homing in self._parts.wanted(names, everything=everything):
                arms = is_actuator(self._machine, homing.name)
                alone = not arms and any(w.config.stall for w in (homing, *batch))
                if (batch and alone) or any(homing.steppers & other.steppers for other in batch):
                    await self._run.run(batch)
                    batch = []
                batch.append(homing)
            if batch:
                await self._run.run(batch)

    def travel(self, name: str) -> float:
        """The maximum distance of an axis or arm to its endstop, mm or degrees."""
        return self._parts.travel(name)

    def _at(self, slot: int) -> float:
        return self._rig.job.machine_position[slot]
