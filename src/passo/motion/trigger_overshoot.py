"""The travel of motors between the trigger of an endstop on another board and their stop."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import floor
from typing import TYPE_CHECKING

from passo.config.pin_names import placed
from passo.geometry.base import Joints
from passo.motion.axis_slots import slot_of_axis
from passo.motion.endstops import Switch

if TYPE_CHECKING:
    from passo.board.endstops import Endstops
    from passo.config.motor_roles import Driven
    from passo.motion.rig import Rig


class TriggerOvershoot:
    """Computes the overshoot of one search, in steps: from the plan's position at the trigger to
    the stop of the motor. So the trigger position is as exact as with an endstop on the motor's own
    board; only the stop is later. With `joints`, positions of the plan are actuator positions.
    """

    def __init__(self, rig: Rig, endstops: Endstops, *, joints: bool) -> None:
        self._rig, self._endstops, self._joints = rig, endstops, joints
        self._machine = rig.machine
        self._lost = dict(rig.positions.lost)
        self._travels: dict[Driven, float] = {}
        self._hit_at: dict[str, Sequence[float]] = {}

    def look(self) -> None:
        """Call within a second after a trigger, because the plan keeps its past positions for about
        that long."""
        for name, clock in self._endstops.hit.items():
            if name not in self._hit_at:
                found = self._rig.job.history.position_at(clock - self._rig.queue.base)
                if found is not None:
                    self._hit_at[name] = found

    def measure(self, switches: Iterable[Switch]) -> None:
        """Call after the search. For an actuator with several motors, it uses those on the board of
        the endstop, which stopped at once."""
        for switch in switches:
            at_once = [self._driven(s) for s in switch.steppers if self._is_beside(s, switch)]
            for stepper in switch.steppers:
                driven = self._driven(stepper)
                if driven not in at_once and switch.name in self._hit_at:
                    self._travels[driven] = self._travel(stepper, driven, self._hit_at[switch.name])

    def places(self) -> list[tuple[int, float]]:
        """The axes (or actuators) that moved on after the trigger: their positions by number,
        relative to a plan that assumes the trigger positions."""
        if not any(self._travels.values()):
            return []
        position = self._rig.job.machine_position
        joints = self._actuators(position)
        places: list[tuple[int, float]] = []
        for driven, by in self._travels.items():
            if driven.drive == "axis":
                places.append((driven.index, position[slot_of_axis(driven.index)] + by))
            else:
                joints[driven.index] += by
        point = joints if self._joints else self._machine.geometry.forward(joints)
        return [*enumerate(point), *places]

    def stopped(self) -> Joints:
        """The actuator positions at which the motors have stopped, mm or degrees, from the counts
        of their boards. Their drives have taken up their gaps in the direction of the search. Only
        for moves of the axes."""
        found: dict[int, float] = {}
        for row in self._rig.job.motors.statistics():
            driven = self._machine.driven_by(row["name"])
            if driven is not None and driven.drive == "actuator":
                steps = row["count"] - self._lost_steps(row["name"]) + row["taken_up"]
                found.setdefault(driven.index, steps / row["steps_per_unit"])
        return tuple(found[i] for i in range(len(self._machine.geometry.actuators)))

    def triggered(self, switch: Switch) -> Joints:
        """The actuator positions when this endstop triggered, mm or degrees. Motors that it does
        not stop have their final positions."""
        self.measure([switch])
        joints = list(self.stopped())
        for driven, by in self._travels.items():
            if driven.drive == "actuator":
                joints[driven.index] -= by
        return tuple(joints)

    def _lost_steps(self, stepper: str) -> int:
        """The steps of the plan that the stop has cut off."""
        return self._rig.positions.lost[stepper] - self._lost.get(stepper, 0)

    def _travel(self, stepper: str, driven: Driven, hit_at: Sequence[float]) -> float:
        """The travel of an actuator, or an axis, from the trigger to the stop."""
        row = next(r for r in self._rig.job.motors.statistics() if r["name"] == stepper)
        lost = self._lost_steps(stepper)
        if driven.drive == "axis":
            at = hit_at[slot_of_axis(driven.index)]
        else:
            at = self._actuators(hit_at)[driven.index]
        steps = row["count"] - lost - floor(at * row["steps_per_unit"] + 0.5)
        return steps / row["steps_per_unit"]

    def _actuators(self, position: Sequence[float]) -> list[float]:
        x, y, z = position[:3]
        return [x, y, z] if self._joints else list(self._machine.geometry.inverse((x, y, z)))

    def _driven(self, stepper: str) -> Driven:
        driven = self._machine.driven_by(stepper)
        if driven is None:
            raise KeyError(stepper)
        return driven

    def _is_beside(self, stepper: str, switch: Switch) -> bool:
        return self._machine.board_of_stepper(stepper) == placed(switch.pin)[0]
