"""Homing: axes find their switches, fast, then back a little, then slowly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.board.endstops import Endstops
from passo.config.drives import axis_order
from passo.errors import CommandError, Problem
from passo.geometry.base import Unreachable
from passo.printer.slots import Z, slot_of_axis
from passo.printer.switches import Switch, home_point, is_actuator, steppers_of, switches

if TYPE_CHECKING:
    from passo.config.homing import Homing
    from passo.printer.printer import Printer

_REST_S = 0.001  # the board looks at a switch at least this often
_ARMED_S = 0.005  # switches count from so long before the first step
_OVERRUN = 1.2  # a switch is sought this far beyond the axis' whole range
_SLOW_OVERRUN = 2.0  # and this many times the retraction on the slow way


@dataclass(frozen=True, slots=True)
class _Way:
    """One axis on its way to its switches, or all arms of a delta together as Z. Lengths along the
    axis: `sign` is the direction of its end, `scale` turns the speeds and lengths of the machine
    file into mm of it."""

    name: str
    axis: int
    slot: int
    sign: float
    home: float
    scale: float
    config: Homing
    switches: tuple[Switch, ...]

    @property
    def steppers(self) -> set[str]:
        return {stepper for switch in self.switches for stepper in switch.steppers}


class Homer:
    """Homes the axes of one printer. Its methods must be called by who has the turn, the machine
    standing; they raise CommandError, and MachineError."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._machine = printer.machine
        self._axes = axis_order(self._machine.axes)
        self._switches = switches(self._machine)
        self._order = [row["name"] for row in self._machine.core_spec()["steppers"]]
        self._endstops = Endstops(printer.connection)

    @property
    def axes(self) -> set[str]:
        """The axes that find their place by switches."""
        found: set[str] = set()
        for name in self._machine.homing:
            found |= {"x", "y", "z"} if is_actuator(self._machine, name) else {name}
        return found

    def states(self) -> dict[str, bool]:
        """All switches: whether they are pressed."""
        return {switch.name: self._endstops.pressed(switch.name) for switch in self._switches}

    async def home(self, letters: str) -> None:
        """Homes the axes of these letters, all by default. An axis without a switch is taken to be
        at home already. An axis that does not find its switch no longer knows where it is."""
        names = [a for a in self._axes if a.upper() in letters] if letters else self._axes
        for name in names:
            if name not in self.axes:
                self._set(name, self._home_of(name))
        self._printer.endstops.pause()
        ways = self._ways(names, everything=not letters)
        batch: list[_Way] = []
        for way in ways:
            if any(way.steppers & other.steppers for other in batch):
                await self._together(batch)
                batch = []
            batch.append(way)
        if batch:
            await self._together(batch)

    def _home_of(self, name: str) -> float:
        axis = self._machine.axes[name]
        return axis.min_mm if axis.home_mm is None else axis.home_mm

    def _ways(self, names: Sequence[str], *, everything: bool) -> list[_Way]:
        machine = self._machine
        ways: list[_Way] = []
        arms = [n for n in machine.homing if is_actuator(machine, n)]
        if arms and {"x", "y", "z"} & set(names):
            ways.append(self._lift(arms))
        for name in names:
            homing = machine.homing.get(name)
            if homing is None or name in arms or (everything and not homing.by_default):
                continue
            axis = self._axes.index(name)
            own = tuple(s for s in self._switches if s.home == name)
            sign = 1.0 if homing.direction == "max" else -1.0
            ways.append(
                _Way(name, axis, slot_of_axis(axis), sign, homing.position, 1.0, homing, own)
            )
        return ways

    def _lift(self, arms: Sequence[str]) -> _Way:
        """All arms of a delta move alike while Z moves in the middle."""
        homing = self._machine.homing[arms[0]]
        top = home_point(self._machine)[2]
        low = self._lifted(-self._travel(homing, arms[0]))
        scale = abs(top - low) / self._travel(homing, arms[0])
        own = tuple(s for s in self._switches if s.home in arms)
        return _Way("z", Z, Z, math.copysign(1.0, top - low), top, scale, homing, own)

    def _lifted(self, by: float) -> float:
        """Z with all arms so far beyond home."""
        homes = [self._machine.homing[a] for a in self._machine.geometry.actuators]
        a, b, c = (h.position + (by if h.direction == "max" else -by) for h in homes)
        try:
            return self._machine.geometry.forward((a, b, c))[2]
        except Unreachable:
            return home_point(self._machine)[2]

    def _travel(self, homing: Homing, name: str) -> float:
        if homing.max_travel is not None:
            return homing.max_travel
        if is_actuator(self._machine, name):
            stepper = self._machine.steppers[steppers_of(self._machine, name)[0]]
            ends = (stepper.min_mm, stepper.max_mm, stepper.min_deg, stepper.max_deg)
            given = [end for end in ends if end is not None]
            if len(given) == 2:
                return given[1] - given[0]
        axis = self._machine.axes[name if name in self._machine.axes else "z"]
        return _OVERRUN * (axis.max_mm - axis.min_mm)

    async def _together(self, ways: Sequence[_Way]) -> None:
        """Homes axes that share no motor at the same time."""
        lift = any(is_actuator(self._machine, s.home) for way in ways for s in way.switches)
        names = ["x", "y", "z"] if lift else [way.name for way in ways]
        try:
            for way in ways:
                if lift:
                    for name, at in zip("xyz", (0.0, 0.0, 0.0), strict=True):
                        self._set(name, at)
                far = self._travel(way.config, way.switches[0].home) * way.scale
                self._set(way.name, way.home - way.sign * far)
            await self._seek(ways, [self._travel(w.config, w.switches[0].home) for w in ways], True)
            for way in ways:
                self._set(way.name, way.home)
            await self._go([-w.config.retract for w in ways], ways)
            for way in ways:
                for switch in way.switches:
                    if self._endstops.pressed(switch.name):
                        raise self._problem("machine.switch-stuck", switch, way.config.retract)
            slow = [_SLOW_OVERRUN * w.config.retract for w in ways]
            await self._seek(ways, slow, False)
        except BaseException:
            self._printer.lock(names)
            raise
        for way in ways:
            self._set(way.name, way.home + self._printer.motion.home_offset_mm[way.name])
        if lift:
            for name, at in zip("xyz", home_point(self._machine), strict=True):
                self._set(name, at)

    async def _seek(self, ways: Sequence[_Way], travel: Sequence[float], fast: bool) -> None:
        """All ways at once, each at its own speed, until each has met all its switches."""
        printer = self._printer
        speeds = [(w.config.fast if fast else w.config.slow) for w in ways]
        stops = {s.name: s.steppers for w in ways for s in w.switches}
        finest = max(speed * self._steps(w) for speed, w in zip(speeds, ways, strict=True))
        drive = printer.drive
        drive.before_moves()
        start = drive.base + int(printer.job.clock - _ARMED_S * drive.hz)
        self._endstops.arm(stops, start, min(_REST_S, max(1.0 / finest, 5e-5)))
        times = [t / v for t, v in zip(travel, speeds, strict=True)]
        passed = 0.0
        for end in sorted(set(times)):
            target: dict[int, float] = {}
            square = 0.0
            for way, time, speed in zip(ways, times, speeds, strict=True):
                if time >= end:
                    v = speed * way.scale
                    target[way.slot] = self._at(way.slot) + way.sign * v * (end - passed)
                    square += v * v
            drive.move(target, math.sqrt(square), limited=False)
            passed = end
        printer.drive.flush()
        try:
            await drive.until(
                lambda: self._endstops.all_hit() or drive.standing or printer.interrupted
            )
            if not drive.standing:
                drive.stop()
                await drive.until(lambda: drive.standing or bool(printer.halted))
            self._endstops.all_hit()
        finally:
            self._endstops.disarm()
            moved = {stepper for way in ways for stepper in way.steppers}
            printer.job.renew_steppers([self._order.index(stepper) for stepper in moved])
        if not printer.halted:
            printer.positions.settle()
        printer.raise_if_interrupted()
        for way in ways:
            for switch in way.switches:
                if switch.name not in self._endstops.hit:
                    far = travel[list(ways).index(way)]
                    raise self._problem("machine.switch-missed", switch, far)

    async def _go(self, by: Sequence[float], ways: Sequence[_Way]) -> None:
        """A move of all these axes, by so much towards their switches."""
        printer = self._printer
        target: dict[int, float] = {}
        square = 0.0
        for way, distance in zip(ways, by, strict=True):
            target[way.slot] = self._at(way.slot) + way.sign * distance * way.scale
            square += (way.config.fast * way.scale) ** 2
        printer.drive.move(target, math.sqrt(square), limited=False)
        printer.drive.flush()
        await printer.drive.until(lambda: printer.drive.standing or printer.interrupted)
        printer.raise_if_interrupted()

    def _steps(self, way: _Way) -> float:
        return max(self._machine.steppers[s].steps_per_unit for s in way.steppers)

    def _at(self, slot: int) -> float:
        return self._printer.job.machine_position[slot]

    def _set(self, name: str, at: float) -> None:
        self._printer.job.set_axis(self._axes.index(name), at)

    def _problem(self, code: str, switch: Switch, limit: float) -> CommandError:
        homing = self._machine.homing[switch.home]
        values = {
            "axis": switch.home.upper(),
            "value": f"switch {switch.name} at {switch.pin}",
            "limit": f"{limit:g}",
            "position": f"{homing.position:g}",
        }
        return CommandError([Problem(code, values=values)])
