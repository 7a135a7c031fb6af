"""FORCE_MOVE and STEPPER_BUZZ: move a single motor, whether or not its axis is homed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import isclose
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.motor_roles import axis_order
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Subject, When, command
from passo.geometry.base import Point, Unreachable
from passo.motion.axis_slots import slot_of_axis
from passo.motion.rig import Rig
from passo.motion.triggered_moves import TriggeredMoves
from passo.printer.commands.klipper_commands import number
from passo.printer.klipper.names import stepper_object
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_BUZZ = (1.0, -1.0) * 10  # mm or degrees
_BUZZ_SPEED = 4.0  # mm/s or degrees/s
_BUZZ_PAUSE_S = 0.3
# a trial distance, which shows whether an actuator moves the nozzle on a straight line
_TRIAL_MM = 1.0
_ROUNDING = 1e-6  # mm or degrees, far above the rounding of sums of positions


@dataclass(frozen=True, slots=True)
class _Motor:
    """The effect of a motor. `per_unit` has the axes that move with it, by number, and their travel
    in mm for 1 mm of the motor. It is empty if the motor moves the nozzle on a curve; then `joint`
    is the number of its actuator."""

    together: tuple[str, ...]  # all motors that drive the same axis
    per_unit: dict[int, float]
    joint: int = 0


class MotorMoves:
    """Moves of single motors of one printer, at standstill. A homed axis stays homed, and within
    its limits."""

    def __init__(self, rig: Rig, state: State, triggered: TriggeredMoves) -> None:
        self._rig, self._state, self._triggered = rig, state, triggered
        self._axes = axis_order(rig.machine.axes)

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    @command(
        "FORCE_MOVE",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "STEPPER DISTANCE(mm) VELOCITY(mm/s)",
        "Turns a motor, with those that drive the same, also where the axis is not homed. A homed"
        " axis keeps within its limits. Where motors move the nozzle on curves, as on a delta, home"
        " afterwards. ACCEL is read and ignored.",
        kind=Kind.SERVED,
        bare=None,
    )
    def _force(self, command: Command, reply: Reply) -> Wait | None:
        words = command.pairs()
        motor = self._motor(words.get("STEPPER", ""))
        distance, speed = number(words, "DISTANCE"), number(words, "VELOCITY")
        longest = max(a.max_mm - a.min_mm for a in self._machine.axes.values() if not a.extruder)
        if abs(distance) > longest:
            raise CommandError.bad_value("DISTANCE", distance, f"{-longest:g} to {longest:g} mm")
        if speed <= 0:
            raise CommandError.bad_value("VELOCITY", speed, "more than 0 mm/s")
        self._note(motor, reply)
        return WaitForProcedure(partial(self._turn, motor, (distance,), speed, 0.0))

    @command(
        "STEPPER_BUZZ",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "STEPPER",
        "Turns a motor 1 mm forth and back, ten times, to see which one it is and how it is wired;"
        " the axis need not be homed.",
        kind=Kind.SERVED,
        bare=None,
    )
    def _buzz(self, command: Command, reply: Reply) -> Wait | None:
        motor = self._motor(command.pairs().get("STEPPER", ""))
        self._note(motor, reply)
        by = _BUZZ if self._fits(motor, _BUZZ) else [-mm for mm in _BUZZ]
        return WaitForProcedure(partial(self._turn, motor, by, _BUZZ_SPEED, _BUZZ_PAUSE_S))

    # -- motors -----------------------------------------------------------------------------------

    def _motor(self, name: str) -> _Motor:
        """The motor with this name (Klipper's or the machine file's). Raises CommandError."""
        driven_by = self._machine.driven_by
        movable = [
            n for n in self._machine.steppers if (d := driven_by(n)) and d.drive != "extruder"
        ]
        named = {stepper_object(n): n for n in movable} | {n: n for n in movable}
        if name not in named:
            limit = ", ".join(stepper_object(n) for n in movable)
            raise CommandError.of(
                "command.value", axis="STEPPER", value=name or "missing", limit=limit
            )
        driven = driven_by(named[name])
        assert driven is not None
        together = tuple(n for n in movable if driven_by(n) == driven)
        if driven.drive == "axis":
            return _Motor(together, {driven.index: 1.0})
        straight = self._straight(driven.index)
        per_unit = {i: mm for i, mm in enumerate(straight or ()) if mm}
        return _Motor(together, per_unit, driven.index)

    def _straight(self, actuator: int) -> tuple[float, ...] | None:
        """The travel of X, Y and Z for 1 mm of an actuator; None if it depends on the position."""
        geometry = self._machine.geometry
        found: list[tuple[float, ...]] = []
        home = geometry.inverse(self._machine.home_point)
        for factor in (1.0, -1.0, 2.0):
            moved = [at + factor * _TRIAL_MM * (i == actuator) for i, at in enumerate(home)]
            try:
                a, b, c = moved
                there = geometry.forward((a, b, c))
            except Unreachable:
                return None
            ends = zip(there, self._machine.home_point, strict=True)
            found.append(tuple(round((to - at) / factor, 9) for to, at in ends))
        same = all(
            isclose(a, b, abs_tol=_ROUNDING)
            for a, *others in zip(*found, strict=True)
            for b in others
        )
        return found[0] if same else None

    def _note(self, motor: _Motor, reply: Reply) -> None:
        if len(motor.together) > 1:
            text = f"{' and '.join(motor.together)} drive the same and turn together"
            reply.note(text, text, again=True)

    # -- moves ------------------------------------------------------------------------------------

    def _fits(self, motor: _Motor, by: Sequence[float]) -> bool:
        """Whether all homed axes that move with the motor stay within their limits."""
        try:
            self._require_limits(motor, by)
        except CommandError:
            return False
        return True

    def _require_limits(self, motor: _Motor, by: Sequence[float]) -> None:
        job = self._rig.job
        for index, mm in motor.per_unit.items():
            if index in job.locked_axes:
                continue
            name = self._axes[index]
            axis, at = self._machine.axes[name], job.machine_position[slot_of_axis(index)]
            for distance in by:
                at += mm * distance
                if not axis.min_mm - _ROUNDING <= at <= axis.max_mm + _ROUNDING:
                    limit = f"{axis.min_mm:g} to {axis.max_mm:g} mm, as the axis is homed"
                    raise CommandError.bad_value(name.upper(), round(at, 3), limit)

    async def _turn(
        self, motor: _Motor, by: Sequence[float], speed_mm_s: float, pause_s: float
    ) -> None:
        """Moves the motor by these distances, one after the other. Raises CommandError, Stopped."""
        self._require_limits(motor, by)
        if not self._rig.positions.settled:
            self._rig.positions.settle()
        if motor.per_unit:
            for distance in by:
                await self._go(motor.per_unit, distance, speed_mm_s, pause_s)
        else:
            await self._turn_joint(motor, by, speed_mm_s, pause_s)

    async def _turn_joint(
        self, motor: _Motor, by: Sequence[float], speed_mm_s: float, pause_s: float
    ) -> None:
        """As `_turn`, for an actuator that moves the nozzle on a curve. If it does not return, X, Y
        and Z are not homed afterwards."""
        rig = self._rig
        before = _xyz(rig.job.machine_position)
        at_home = self._machine.geometry.inverse(self._machine.home_point)
        returned = False
        rig.positions.freeze()
        rig.job.use_joints(True)
        rig.job.set_axes(list(enumerate(at_home)))
        try:
            for distance in by:
                await self._go({motor.joint: 1.0}, distance, speed_mm_s, pause_s)
            returned = abs(sum(by)) < _ROUNDING
        finally:
            rig.job.use_joints(False)
            rig.job.set_axes(list(enumerate(before)))
            rig.positions.thaw()
            if not returned:
                rig.lock("xyz")

    async def _go(
        self, per_unit: dict[int, float], distance: float, speed_mm_s: float, pause_s: float
    ) -> None:
        rig = self._rig
        at = rig.job.machine_position
        slots = {slot_of_axis(index): mm for index, mm in per_unit.items()}
        target = {slot: at[slot] + mm * distance for slot, mm in slots.items()}
        rig.queue.move(target, speed_mm_s, Within.ANYTHING)
        rig.queue.flush()
        await self._triggered.standstill()
        self._state.raise_if_interrupted()
        if pause_s:
            await rig.queue.sleep(pause_s)


def _xyz(position: Sequence[float]) -> Point:
    x, y, z = position[:3]
    return x, y, z
