"""Homing: each axis moves fast to its endstop, retracts a little, and approaches it again
slowly."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.motor_roles import axis_order
from passo.errors import CommandError, MachineError, PassoError, Problem
from passo.geometry.base import Point, Unreachable
from passo.motion.axis_slots import E, X, Y, Z, slot_of_axis
from passo.motion.endstops import (
    Switch,
    homed_axes,
    is_actuator,
    steppers_of,
    switches,
)
from passo.motion.real_travel import RealTravel
from passo.motion.travel import go_back

if TYPE_CHECKING:
    from passo.board.endstops import Endstops
    from passo.config.homing import Homing
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection
    from passo.motion.lone_motors import LoneMotors
    from passo.motion.offsets import Offsets
    from passo.motion.probing import Prober
    from passo.motion.rig import Rig
    from passo.motion.stall_homing import StallHoming
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves

_FULL_TURN = 360.0  # range of an arm without limits
_OVERRUN = 1.2  # the search for an endstop covers this multiple of the range of the axis
_LOST = "machine.switch-lost"  # boards have lost each other
SLOW_OVERRUN = 2.0  # and the slow approach this multiple of the retraction


@dataclass(frozen=True, slots=True)
class _HomingAxis:
    """An axis or arm that is being homed. Lengths are in its unit: mm, or degrees of an arm. `axis`
    is its number among the axes, or among the actuators for an arm; `sign` is the direction to the
    endstop."""

    name: str
    axis: int
    sign: float
    config: Homing
    switches: tuple[Switch, ...]

    @property
    def home(self) -> float:
        """Its position when its endstops trigger."""
        return self.config.position

    @property
    def slot(self) -> int:
        """Its index in the core's position lists."""
        return slot_of_axis(self.axis)

    @property
    def steppers(self) -> set[str]:
        """The motors that its endstops stop."""
        return {stepper for switch in self.switches for stepper in switch.steppers}


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
        self._lone_motors, self._prober, self._stalls = motors, prober, stalls
        self._problem_of_job = problem  # gives the error that stopped the job
        self._axes = axis_order(self._machine.axes)
        self._switches = switches(self._machine)
        self._joints = False
        self.reset()

    def reset(self) -> None:
        """Call this after the boards have been replaced."""
        self.offset_mm: dict[str, float] = {}  # of M206, by axis, at the last homing

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
        return {switch.label: self._endstops.pressed(switch.name) for switch in self._switches}

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
        among = {name for name in self._machine.homing if self._switches_of(name)}
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
                geometry = self._machine.geometry
                homings = [
                    self._homing_of(
                        name, geometry.actuators if name in geometry.arms else self._axes
                    )
                    for name in travel
                ]
                await self._together(homings, once)

    async def stall_within(self, name: str, far: float, back: float | None) -> float | None:
        """Moves an axis by at most `far` towards its end until its motor stalls, and then `back`,
        by default as far as it has moved. Returns the travel until the stall; None if it did not
        stall. The axis is not homed afterwards."""
        actuators, arms = self._machine.geometry.actuators, self._machine.geometry.arms
        homing = self._homing_of(name, actuators if name in arms else self._axes)
        speed_of = dict.fromkeys(homing.switches, homing.config.fast)
        with self._homing():
            square = self._rig.square(lambda: bool(self._interrupts.halted))
            with self._correction.suspended(), square, self._triggered.prepared():
                job = self._rig.job
                job.axes.use_joints(name in arms)
                try:
                    async with self._stalls.detecting(speed_of):
                        moved = await self._stall_at_most(homing, far)
                        by = far if moved is None else moved if back is None else back
                        await self._go([-by], [homing])
                    return moved
                finally:
                    job.axes.use_joints(False)
                    self._rig.lock(self._machine.axes_of_arms if name in arms else [name])

    async def _stall_at_most(self, homing: _HomingAxis, far: float) -> float | None:
        stuck = await self._stalls.still_shown(homing.switches)
        if stuck is not None:
            raise self._problem("machine.stall-shown", stuck, 0.0)
        self._place(homing, homing.home - homing.sign * far)
        before = self._stalls.counts(homing.switches)
        try:
            await self._seek([homing], [far], [homing.config.fast])
        except CommandError as error:
            if error.problems[0].code != "machine.stall-missed":
                raise
            return None
        return self._stalls.travel(homing.switches, before)

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
        homed = [a for a in self._axes if not self._machine.axes[a].extruder]
        names = [a for a in homed if a.upper() in letters] or homed
        if "O" in letters and self._machine.unhomed_moves == "refuse":
            unknown = [self._axes[i] for i in self._rig.job.locked_axes]
            names = [name for name in names if name in unknown]
        fixed = [name for name in names if name not in self.axes]
        self._set({name: self._machine.home_mm[name] for name in fixed})
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
        self.offset_mm["z"] = self._offsets.home_mm["z"]
        self._set({"z": self._at(Z) + self.offset_mm["z"]})

    async def _by_switches(self, names: Sequence[str], *, everything: bool) -> None:
        """Homes axes and arms by their endstops, at the same time if they do not share a motor. An
        axis that homes by a stall moves alone."""
        batch: list[_HomingAxis] = []
        with self._triggered.prepared():
            for homing in self._homings(names, everything=everything):
                arms = is_actuator(self._machine, homing.name)
                alone = not arms and any(w.config.stall for w in (homing, *batch))
                if (batch and alone) or any(homing.steppers & other.steppers for other in batch):
                    await self._together(batch)
                    batch = []
                batch.append(homing)
            if batch:
                await self._together(batch)

    def _homings(self, names: Sequence[str], *, everything: bool) -> list[_HomingAxis]:
        """The axes and arms to home, arms first. The Z of a delta with a Z endstop needs the arms
        only for its position."""
        machine, homing = self._machine, self._machine.homing
        of_arms = set(machine.axes_of_arms)
        wanted: set[str] = of_arms & set(names)
        if wanted == {"z"} and "z" in homing and not self._rig.job.locked_axes:
            wanted = set[str]()
        homings = [
            self._homing_of(n, machine.geometry.actuators) for n in machine.geometry.arms if wanted
        ]
        for name in names:
            if name in homing and (homing[name].by_default or not everything):
                homings.append(self._homing_of(name, self._axes))
        return homings

    def _homing_of(self, name: str, among: Sequence[str]) -> _HomingAxis:
        config = self._machine.homing[name]
        sign = 1.0 if config.direction == "max" else -1.0
        return _HomingAxis(name, among.index(name), sign, config, self._switches_of(name))

    def _switches_of(self, name: str) -> tuple[Switch, ...]:
        return tuple(s for s in self._switches if s.home == name)

    def travel(self, name: str) -> float:
        """The maximum distance of an axis or arm to its endstop, mm or degrees."""
        longest = self._machine.homing[name].max_travel
        if longest is not None:
            return longest
        if is_actuator(self._machine, name):
            stepper = self._machine.steppers[steppers_of(self._machine, name)[0]]
            ends = (stepper.min_mm, stepper.max_mm, stepper.min_deg, stepper.max_deg)
            given = [end for end in ends if end is not None]
            return given[1] - given[0] if len(given) == 2 else _FULL_TURN
        axis = self._machine.axes[name]
        return _OVERRUN * (axis.max_mm - axis.min_mm)

    async def _together(
        self,
        homings: Sequence[_HomingAxis],
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
        self._joints = arms
        behind = {homing.name: self._behind(homing) for homing in homings}
        real = RealTravel(rig)  # the search lets the positions of the plan be wrong
        try:
            job.axes.use_joints(arms)
            travel = [once[w.name][0] if once else self.travel(w.name) for w in homings]
            speeds = [once[w.name][1] if once else w.config.fast for w in homings]
            for homing, far in zip(homings, travel, strict=True):
                self._place(homing, homing.home - homing.sign * far)
            if any(homing.config.stall for homing in homings):
                await self._by_stall(homings, travel, speeds, once=once is not None)
            else:
                await self._seek(homings, travel, speeds)
                if not once:
                    await self._again(homings, behind)
        except BaseException as failure:
            self._set(point_of_arms(self._arms_at_home(job.machine_position[Z])))
            try:
                # Boards that have lost each other may not answer for their counts.
                lost = isinstance(failure, PassoError) and failure.problems[0].code == _LOST
                if not lost and not isinstance(failure, MachineError):
                    self._keep_count(
                        real,
                        [homing for homing in homings if homing.name in names],
                    )
            finally:
                rig.lock([*of_arms, *names])
            raise
        found = {
            w.name: self._at(w.slot) + await self._level(w) for w in homings if w.name in names
        }
        found |= point_of_arms(job.machine_position[:3])
        self.offset_mm |= {n: self._offsets.home_mm[n] for n in found}
        self._set({n: at + self.offset_mm[n] for n, at in found.items()})

    def _keep_count(self, real: RealTravel, homings: Sequence[_HomingAxis]) -> None:
        """After a failure, axes are where their motors have really moved them to."""
        if self._interrupts.halted or not homings:
            return
        with suppress(Unreachable):  # the arms stopped where no position belongs to them
            place = real.place()
            for homing in homings:
                self._place(homing, place[homing.axis])

    def _behind(self, homing: _HomingAxis) -> float:
        """How far behind its home position an axis may be, where its endstops stay triggered, mm:
        as far as it reaches or, if it is homed, is."""
        axis = self._machine.axes.get(homing.name)
        if axis is None or is_actuator(self._machine, homing.name):
            return 0.0
        at = axis.max_mm if homing.sign > 0 else axis.min_mm
        if homing.axis not in self._rig.job.locked_axes:
            at = self._at(homing.slot) - self.offset_mm.get(homing.name, 0.0)
        return max(0.0, homing.sign * (at - homing.home))

    async def _again(self, homings: Sequence[_HomingAxis], behind: Mapping[str, float]) -> None:
        """Moves back from the endstops, which must open, and then slowly to them. An axis that was
        `behind` its endstops moves on in the same steps until they open."""
        pressed, steps = list(homings), 0
        while pressed:
            await self._go([-w.config.retract for w in pressed], pressed)
            steps += 1
            for homing in [*pressed]:
                stuck = [s for s in homing.switches if self._endstops.pressed(s.name)]
                if not stuck:
                    pressed.remove(homing)
                elif steps * homing.config.retract >= behind[homing.name] + homing.config.retract:
                    far = steps * homing.config.retract
                    raise self._problem("machine.switch-stuck", stuck[0], far)
        slow = [SLOW_OVERRUN * w.config.retract for w in homings]
        await self._seek(homings, slow, [w.config.slow for w in homings])

    async def _by_stall(
        self,
        homings: Sequence[_HomingAxis],
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
                    raise self._problem("machine.stall-shown", stuck, 0.0)
                for homing, far in zip(homings, travel, strict=True):
                    self._place(homing, homing.home - homing.sign * far)
                before = self._stalls.counts(watched)
                await self._seek(homings, travel, speeds)
                moved = {w.name: self._stalls.travel(of[w.name], before) for w in homings}
                early = [w for w in homings if moved[w.name] < _least_travel(w)]
                if not early:
                    break
                if last:
                    homing = early[0]
                    raise self._problem(
                        "machine.stall-early", homing.switches[0], moved[homing.name]
                    )
                await self._go([-2 * _least_travel(homing) for homing in homings], homings)
            if not once:
                await self._go([-homing.config.retract for homing in homings], homings)

    async def _level(self, homing: _HomingAxis) -> float:
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

    def _arms_at_home(self, z: float) -> list[float]:
        """The actuator positions with all arms at home; `z` is used if Z moves independently."""
        machine = self._machine
        return [
            machine.homing[n].position if n in machine.geometry.arms else z
            for n in machine.geometry.actuators
        ]

    async def _seek(
        self, homings: Sequence[_HomingAxis], travel: Sequence[float], speeds: Sequence[float]
    ) -> None:
        """Moves all axes at the same time, each at its own speed, until all their endstops are
        triggered."""
        rig = self._rig
        finest = max(speed * self._steps(w) for speed, w in zip(speeds, homings, strict=True))
        times = [t / v for t, v in zip(travel, speeds, strict=True)]

        def move() -> None:
            passed = 0.0
            for end in sorted(set(times)):
                target: dict[int, float] = {}
                square = 0.0
                for homing, time, speed in zip(homings, times, speeds, strict=True):
                    if time >= end:
                        target[homing.slot] = self._at(homing.slot) + homing.sign * speed * (
                            end - passed
                        )
                        square += speed * speed
                rig.queue.move(target, math.sqrt(square), Within.ANYTHING)
                passed = end

        switches = [switch for homing in homings for switch in homing.switches]
        overshoot = await self._triggered.run(switches, finest, move, joints=self._joints)
        self._interrupts.raise_if_interrupted()
        for homing in homings:
            for switch in homing.switches:
                if switch.name in self._endstops.expired:
                    raise self._problem(_LOST, switch, 0.0)
                if switch.name not in self._endstops.hit:
                    far = travel[list(homings).index(homing)]
                    missed = "machine.stall-missed" if switch.watched else "machine.switch-missed"
                    raise self._problem(missed, switch, far)
        overshoot.measure(switches)
        for homing in homings:
            rig.job.axes.set([(homing.axis, homing.home)], triggered=True)
        rig.job.axes.set(overshoot.places())

    async def _go(self, by: Sequence[float], homings: Sequence[_HomingAxis]) -> None:
        """Moves these axes together, each by its distance towards its endstops."""
        rig = self._rig
        target: dict[int, float] = {}
        square = 0.0
        for homing, distance in zip(homings, by, strict=True):
            target[homing.slot] = self._at(homing.slot) + homing.sign * distance
            square += homing.config.fast**2
        rig.queue.move(target, math.sqrt(square), Within.ANYTHING)
        rig.queue.flush()
        await self._triggered.standstill()
        self._interrupts.raise_if_interrupted()

    def _steps(self, homing: _HomingAxis) -> float:
        return max(self._machine.steppers[s].steps_per_unit for s in homing.steppers)

    def _at(self, slot: int) -> float:
        return self._rig.job.machine_position[slot]

    def _place(self, homing: _HomingAxis, at: float) -> None:
        self._rig.job.axes.set([(homing.axis, at)])

    def _set(self, places: dict[str, float]) -> None:
        self._rig.job.axes.set([(self._axes.index(n), at) for n, at in places.items()], homed=True)
        self._rig.positions.confirm(places)
        self._offsets.homed(places)
        self._rig.positions.known.update(places)

    def _problem(self, code: str, switch: Switch, limit: float) -> CommandError:
        geometry, home = self._machine.geometry, switch.home
        arm = is_actuator(self._machine, home)
        turns = arm and home in geometry.rotary
        unit = " degrees" if turns else " mm"
        return CommandError.of(
            code,
            axis=f"{'arm' if turns else 'carriage' if arm else 'axis'} {home.upper()}",
            value=f"{'driver' if switch.watched else 'switch'} {switch.label} at {switch.pin}",
            limit=f"{round(limit, 2):g}{unit}",
            position=f"{self._machine.homing[home].position:g}{unit}",
        )


def _least_travel(homing: _HomingAxis) -> float:
    """The travel within which a stall of an axis does not count."""
    return homing.config.stall.min_travel if homing.config.stall else 0.0
