"""FORCE_MOVE, STEPPER_BUZZ and G1 H: move motors, whether or not their axes are homed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import hypot, isclose
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.klipper_names import motors_by_name, stepper_object
from passo.config.motor_roles import Driven, axis_order
from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import axes, ignored, number, text
from passo.gcode.registry import Kind, Subject, When, command
from passo.geometry.base import Joints, Point, Unreachable
from passo.motion.axis_slots import E, slot_of_axis
from passo.motion.homing import Homer
from passo.motion.rig import Rig
from passo.motion.triggered_moves import TriggeredMoves
from passo.printer.commands.kinematic_position import positions
from passo.printer.state import State
from passo.printer.wait_requests import Reply, Wait, WaitForMoves, WaitForProcedure

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.motion.bed_correction import BedCorrection

_BUZZ = (1.0, -1.0) * 10  # mm or degrees
_BUZZ_SPEED = 4.0  # mm/s or degrees/s
_BUZZ_PAUSE_S = 0.3
# a trial distance, which shows whether an actuator moves the nozzle on a straight line
_TRIAL_MM = 1.0
_ROUNDING = 1e-6  # mm or degrees, far above the rounding of sums of positions
_CHECKS = 32  # places on the way of motors that move the nozzle on a curve
_DEFAULT_F = 600.0  # mm/min


@dataclass(frozen=True, slots=True)
class _Motor:
    """The part that a motor drives, and all motors that drive this part."""

    driven: Driven
    together: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Turn:
    """Motors that turn at the same time. `axes` move with them on a straight line, by these
    distances in mm, by number. For actuators that move the nozzle on a curve, `joints` are the
    distances of the actuators."""

    longest: float  # distance of the motor that turns farthest, mm or degrees
    axes: dict[int, float] = field(default_factory=dict[int, float])
    joints: dict[int, float] = field(default_factory=dict[int, float])

    @property
    def speed_factor(self) -> float:
        """The factor from the speed of the motor with the longest turn to the speed along the
        path."""
        return hypot(*self.axes.values(), *self.joints.values()) / self.longest


def _named(machine: MachineConfig, name: str) -> _Motor:
    """The motor with this name (Klipper's or the machine file's). Raises CommandError."""
    driven_by = machine.driven_by
    movable = [n for n in machine.steppers if (d := driven_by(n)) and d.drive != "extruder"]
    named = motors_by_name(machine, movable)
    if name not in named:
        limit = ", ".join(stepper_object(machine, n) for n in movable)
        raise CommandError.of("command.value", axis="STEPPER", value=name or "missing", limit=limit)
    driven = driven_by(named[name])
    assert driven is not None
    return _Motor(driven, tuple(n for n in movable if driven_by(n) == driven))


def _check_distance(machine: MachineConfig, word: str, distance: float) -> None:
    """Raises CommandError for a distance that no axis has room for."""
    longest = max(a.max_mm - a.min_mm for a in machine.axes.values() if not a.extruder)
    if abs(distance) > longest:
        limit = f"{-longest:g} to {longest:g} mm or degrees at once"
        raise CommandError.bad_value(word, distance, limit)


def _check_motor(command: Command, machine: MachineConfig) -> None:
    """STEPPER and DISTANCE on this machine. Raises CommandError."""
    _named(machine, command.string("STEPPER"))
    _check_distance(machine, "DISTANCE", command.value("DISTANCE", 0.0))


class MotorMoves:
    """Moves of motors of one printer, at standstill. A homed axis stays homed, and within its
    limits."""

    def __init__(
        self,
        rig: Rig,
        state: State,
        triggered: TriggeredMoves,
        correction: BedCorrection,
        homer: Homer,
    ) -> None:
        self._rig, self._state, self._triggered = rig, state, triggered
        self._correction, self._homer = correction, homer
        self._axes = axis_order(rig.machine.axes)

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    @command(
        "FORCE_MOVE",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Turns a motor, with those that drive the same, also where the axis is not homed. A homed"
        " axis keeps within its limits, and stays homed. During a print only its own file may do"
        " so. ACCEL is read and ignored.",
        text("STEPPER", "the name of the motor"),
        number("DISTANCE", "how far", "mm or degrees", required=True),
        number("VELOCITY", "how fast", "mm/s", 0, above=True, required=True),
        ignored("ACCEL"),
        kind=Kind.SERVED,
        valid=_check_motor,
    )
    def _force(self, command: Command, reply: Reply) -> Wait | None:
        motor = _named(self._machine, command.string("STEPPER"))
        distance, speed = command.value("DISTANCE"), command.value("VELOCITY")
        self._require_own_file(command, reply)
        self._note(motor, reply)
        return self._turning({motor: distance}, speed, reply)

    @command(
        "STEPPER_BUZZ",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Turns a motor 1 mm forth and back, ten times, to see which one it is and how it is wired;"
        " the axis need not be homed.",
        text("STEPPER", "the name of the motor"),
        kind=Kind.SERVED,
        valid=_check_motor,
    )
    def _buzz(self, command: Command, reply: Reply) -> Wait | None:
        motor = _named(self._machine, command.string("STEPPER"))
        self._require_no_print(command)
        self._note(motor, reply)
        turn = self._together({motor: 1.0})
        by = _BUZZ if self._fits(turn, _BUZZ) else [-mm for mm in _BUZZ]
        return WaitForProcedure(partial(self._turn, turn, by, _BUZZ_SPEED, _BUZZ_PAUSE_S))

    @command(
        "SET_KINEMATIC_POSITION",
        Subject.POSITIONS,
        When.EXCLUSIVE,
        "Sets the positions of axes in the machine, which count as homed then, without a move; with"
        " SET_HOMED only the axes in its list. CLEAR_HOMED takes that from axes. During a print"
        " only its own file may do so.",
        number("X Y Z", "the position in the machine", "mm"),
        text("SET_HOMED", "the axes that count as homed then, by default all that are given"),
        text("CLEAR_HOMED", "the axes that do not count as homed then"),
        kind=Kind.SERVED,
    )
    def _set_position(self, command: Command, reply: Reply) -> Wait | None:
        job = self._rig.job
        places, lost = positions(command, self._machine, job)
        self._require_own_file(command, reply)

        def place() -> None:
            job.axes.set(list(places.items()))
            self._rig.lock(sorted(lost))

        return WaitForMoves(place)

    # -- G1 H -------------------------------------------------------------------------------------

    @command(
        "G1 H1",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Moves straight until each axis has triggered its endstop, and is homed there, as in"
        " RepRapFirmware. On a delta X, Y and Z are its towers. Not during a print.",
        axes("X Y Z", "how far, or after G90 where to", "mm"),
        number("F", "the feedrate", "mm/min", 0, above=True, default=_DEFAULT_F),
        kind=Kind.SERVED,
    )
    def _approach(self, command: Command, reply: Reply) -> Wait | None:
        words, by = command.words(), dict[str, float]()
        machine = self._machine
        arms = machine.axes_of_arms
        for letter, mm in _of_parts(words).items():
            name = self._part(letter, motors=letter.lower() in arms)
            if "R" not in words:
                order = self._axes
                at = self._rig.job.machine_position
                if name not in order or order.index(name) in self._rig.job.locked_axes:
                    raise CommandError.of("motors.relative", axis=letter)
                mm -= at[slot_of_axis(order.index(name))]
            by[name] = mm
        if not by:
            raise CommandError.of("input.missing-word", axis="G1 H1", value="X, Y or Z")
        self._require_no_print(command)
        speed = command.value("F") / 60

        async def approach() -> None:
            await self._homer.approach(by, speed)
            self._tell(reply)

        return WaitForProcedure(approach)

    @command(
        "G1 H2",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "Moves motors by themselves, as in RepRapFirmware: X is the first motor of the geometry,"
        " whatever it moves. After G91 the axes need not be homed. Homed axes keep within their"
        " limits, and their positions follow. Not during a print.",
        axes("X Y Z", "how far, or after G90 where to", "mm or degrees"),
        number("F", "the feedrate", "mm/min", 0, above=True, default=_DEFAULT_F),
        kind=Kind.SERVED,
    )
    @command(
        "G1 A",
        Subject.MOTORS,
        When.EXCLUSIVE,
        "As G1 H2, with the letters of motors, as in APrinter: `G1 A100` moves the motor A of a"
        " delta or of crossed belts to its position 100.",
        axes("A B C", "how far, or after G90 where to", "mm or degrees"),
        number("F", "the feedrate", "mm/min", 0, above=True, default=_DEFAULT_F),
        kind=Kind.SERVED,
    )
    def _move(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        moves: dict[_Motor, float] = {}
        joints = None if "R" in words else self._joints()
        for letter, at in _of_parts(words).items():
            motor = self._motor_of(self._part(letter, motors=True))
            if joints is None:
                if "R" not in words:
                    raise CommandError.of("motors.relative", axis=letter)
                distance = at
            elif motor.driven.drive == "axis":
                slot = slot_of_axis(motor.driven.index)
                distance = at - self._rig.job.machine_position[slot]
            else:
                distance = at - joints[motor.driven.index]
            _check_distance(self._machine, letter, distance)
            moves[motor] = distance
        if not any(moves.values()):
            return None
        self._require_no_print(command)
        return self._turning(moves, command.value("F") / 60, reply)

    def _part(self, letter: str, *, motors: bool) -> str:
        """The axis with a letter, or the motor of the geometry: X is the first, Y the second, Z the
        third. Raises CommandError."""
        actuators, name = self._machine.geometry.actuators, letter.lower()
        if motors and name in actuators:
            return name
        if motors and letter in "XYZ" and actuators:
            return actuators["XYZ".index(letter)]
        if name in self._axes and not self._machine.axes[name].extruder:
            return name
        known = dict.fromkeys([*self._axes, *actuators])
        limit = f"a letter of {', '.join(n.upper() for n in known)}"
        raise CommandError.of("command.value", axis="the motor", value=letter, limit=limit)

    # -- motors -----------------------------------------------------------------------------------

    def _motor_of(self, part: str) -> _Motor:
        """The motors of an actuator or an axis."""
        driven = self._machine.drivable.by_name[part]
        steppers = self._machine.steppers
        return _Motor(driven, tuple(n for n in steppers if self._machine.driven_by(n) == driven))

    def _note(self, motor: _Motor, reply: Reply) -> None:
        if len(motor.together) > 1:
            text = f"{' and '.join(motor.together)} drive the same and turn together"
            reply.note(text, text, again=True)

    def _together(self, moves: Mapping[_Motor, float]) -> _Turn:
        """The movement of the nozzle or the axis if these motors turn by these distances, mm or
        degrees."""
        axes, joints = dict[int, float](), dict[int, float]()
        for motor, distance in moves.items():
            index = motor.driven.index
            if motor.driven.drive == "axis":
                axes[index] = distance
                continue
            if len(self._machine.geometry.actuators) > E:
                limit = "X, Y and Z: more than three motors hold the nozzle, and none turns alone"
                name = motor.together[0]
                raise CommandError.of("command.value", axis="the motor", value=name, limit=limit)
            straight = self._straight(index)
            if straight is None:
                joints[index] = distance
                continue
            for axis, mm in enumerate(straight):
                if mm:
                    axes[axis] = axes.get(axis, 0.0) + mm * distance
        if axes and joints:
            raise CommandError.of("motors.mixed")
        return _Turn(max(map(abs, moves.values())), axes, joints)

    def _straight(self, actuator: int) -> tuple[float, ...] | None:
        """The travel of X, Y and Z for 1 mm of an actuator; None if it depends on the position."""
        geometry = self._machine.geometry
        found: list[tuple[float, ...]] = []
        home = geometry.inverse(self._machine.home_point)
        for factor in (1.0, -1.0, 2.0):
            moved = [at + factor * _TRIAL_MM * (i == actuator) for i, at in enumerate(home)]
            try:
                there = geometry.forward(moved)
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

    def _joints(self) -> Joints | None:
        """The positions of the actuators, mm or degrees; None if an axis is not homed."""
        job = self._rig.job
        if any(axis < 3 for axis in job.locked_axes):
            return None
        x, y, z = _xyz(job.machine_position)
        return self._machine.geometry.inverse((x, y, job.bed.nozzle_height(x, y, z)))

    # -- limits -----------------------------------------------------------------------------------

    def _require_own_file(self, command: Command, reply: Reply) -> None:
        """Raises CommandError during a print, unless its own file has the command."""
        if self._rig.job.stops.suspended or self._state.is_other_source(reply):
            self._require_no_print(command)

    def _require_no_print(self, command: Command) -> None:
        if self._state.busy():
            raise CommandError.of("motors.print", axis=command.code)

    def _fits(self, turn: _Turn, by: Sequence[float]) -> bool:
        """Whether all homed axes that move with the motors stay within their limits."""
        try:
            self._require_limits(turn, by)
        except CommandError:
            return False
        return True

    def _require_limits(self, turn: _Turn, by: Sequence[float]) -> None:
        """Checks the limits at the positions after `by` times the turn, in this order. Raises
        CommandError."""
        job = self._rig.job
        at = job.machine_position
        for index, mm in turn.axes.items():
            if index not in job.locked_axes:
                place = start = at[slot_of_axis(index)]
                for factor in by:
                    place += mm * factor
                    self._require_place(self._axes[index], place, start)
        joints = self._joints()
        if not turn.joints or joints is None:
            return
        factor = 0.0
        for part in by:
            for k in range(1, _CHECKS + 1):
                self._require_reach(joints, turn, factor + part * k / _CHECKS)
            factor += part

    def _require_reach(self, joints: Joints, turn: _Turn, factor: float) -> None:
        start = self._rig.job.machine_position
        try:
            point = self._point(_moved(joints, turn, factor))
        except Unreachable as error:
            raise CommandError.of("motors.reach", value=str(error)) from None
        for axis, mm, before in zip("xyz", point, start, strict=False):
            self._require_place(axis, mm, before)

    def _require_place(self, name: str, place: float, start: float) -> None:
        axis = self._machine.axes[name]
        low, high = min(axis.min_mm, start), max(axis.max_mm, start)
        if not low - _ROUNDING <= place <= high + _ROUNDING:
            limit = f"{axis.min_mm:g} to {axis.max_mm:g} mm, as the axis is homed"
            raise CommandError.bad_value(name.upper(), round(place, 3), limit)

    def _point(self, joints: Joints) -> Point:
        """The nozzle position in the plan for these positions of the actuators. Raises
        Unreachable."""
        geometry = self._machine.geometry
        point = geometry.forward(joints)
        geometry.inverse(point)  # a delta's rods also meet where its nozzle must not go
        x, y, height = point
        return x, y, self._rig.job.bed.plan_z(x, y, height)

    # -- moves ------------------------------------------------------------------------------------

    def _turning(self, moves: Mapping[_Motor, float], speed: float, reply: Reply) -> Wait:
        turn = self._together(moves)

        async def run() -> None:
            try:
                await self._turn(turn, (1.0,), speed, 0.0)
            finally:
                self._tell(reply)

        return WaitForProcedure(run)

    def _tell(self, reply: Reply) -> None:
        """Reports the position of the nozzle, if it is known."""
        job = self._rig.job
        locked = [name.upper() for i, name in enumerate(self._axes) if i in job.locked_axes]
        at = job.machine_position
        known = [
            f"{name.upper()}{at[slot_of_axis(i)]:.3f}"
            for i, name in enumerate(self._axes)
            if i not in job.locked_axes and not self._machine.axes[name].extruder
        ]
        if known:
            reply.say(f"echo:The nozzle is at {' '.join(known)} of the machine")
        if locked:
            reply.say(f"echo:Not homed: {', '.join(locked)}")

    async def _turn(self, turn: _Turn, by: Sequence[float], speed: float, pause_s: float) -> None:
        """Turns by these factors, one after the other. Raises CommandError, Stopped."""
        self._require_limits(turn, by)
        if not self._rig.positions.settled:
            self._rig.positions.settle()
        speed *= turn.speed_factor
        if turn.joints:
            await self._turn_joints(turn, by, speed, pause_s)
            return
        with self._correction.suspended():
            for factor in by:
                await self._go(turn.axes, factor, speed, pause_s)

    async def _turn_joints(
        self, turn: _Turn, by: Sequence[float], speed: float, pause_s: float
    ) -> None:
        """Like `_turn`, for actuators that move the nozzle on a curve. Axes that were not homed are
        not homed afterwards."""
        rig, geometry = self._rig, self._machine.geometry
        before, joints = rig.job.machine_position, self._joints()
        known = joints is not None
        joints = joints or geometry.inverse(self._machine.home_point)
        locked = [self._axes[axis] for axis in rig.job.locked_axes]
        rig.positions.freeze()
        rig.job.axes.use_joints(True)
        rig.job.axes.set(list(enumerate(joints)))
        try:
            for factor in by:
                await self._go(turn.joints, factor, speed, pause_s)
        finally:
            ended = _xyz(rig.job.machine_position)
            rig.job.axes.use_joints(False)
            place = _xyz(before)
            if known:
                try:
                    place = self._point(ended)
                except Unreachable:  # stopped beyond what the way back would allow
                    locked = [*self._machine.axes_of_arms]
            rig.job.axes.set(list(enumerate(place)))
            rig.positions.thaw()
            rig.lock(locked)

    async def _go(
        self, travel: Mapping[int, float], factor: float, speed: float, pause_s: float
    ) -> None:
        rig = self._rig
        at = rig.job.machine_position
        slots = {slot_of_axis(index): mm for index, mm in travel.items()}
        target = {slot: at[slot] + mm * factor for slot, mm in slots.items()}
        rig.queue.move(target, speed, Within.ANYTHING)
        rig.queue.flush()
        await self._triggered.standstill()
        self._state.raise_if_interrupted()
        if pause_s:
            await rig.queue.sleep(pause_s)


def _of_parts(words: Mapping[str, float]) -> dict[str, float]:
    """The words that are positions."""
    return {letter: at for letter, at in words.items() if letter not in "FR"}


def _moved(joints: Joints, turn: _Turn, factor: float) -> Joints:
    return tuple(q + factor * turn.joints.get(i, 0.0) for i, q in enumerate(joints))


def _xyz(position: Sequence[float]) -> Point:
    x, y, z = position[:3]
    return x, y, z
