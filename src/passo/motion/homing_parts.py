"""The axes and arms that homing moves, with their endstops and distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.motion.axis_slots import slot_of_axis
from passo.motion.endstops import Switch, is_actuator, steppers_of, switches

if TYPE_CHECKING:
    from passo.config.homing import Homing
    from passo.config.machine import MachineConfig
    from passo.motion.rig import Rig

_FULL_TURN = 360.0  # range of an arm without limits
_OVERRUN = 1.2  # the search for an endstop covers this multiple of the range of the axis


@dataclass(frozen=True, slots=True)
class HomingPart:
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

    @property
    def least_travel(self) -> float:
        """The travel within which a stall does not count."""
        return self.config.stall.min_travel if self.config.stall else 0.0


class HomingParts:
    """All axes and arms of one machine that can be homed."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self.axes = axis_order(rig.machine.axes)
        self.switches = switches(rig.machine)

    @property
    def _machine(self) -> MachineConfig:
        return self._rig.machine

    def wanted(self, names: Sequence[str], *, everything: bool) -> list[HomingPart]:
        """The axes and arms to home, arms first. The Z of a delta with a Z endstop needs the arms
        only for its position."""
        machine, homing = self._machine, self._machine.homing
        of_arms = set(machine.axes_of_arms)
        needed: set[str] = of_arms & set(names)
        if needed == {"z"} and "z" in homing and not self._rig.job.locked_axes:
            needed = set[str]()
        parts = [self.of(name) for name in machine.geometry.arms if needed and name in homing]
        for name in names:
            if name in homing and (homing[name].by_default or not everything):
                parts.append(self.of(name))
        return parts

    def of(self, name: str) -> HomingPart:
        """The axis or arm of this name, which must have a table of its homing."""
        machine, config = self._machine, self._machine.homing[name]
        sign = 1.0 if config.direction == "max" else -1.0
        among = machine.geometry.actuators if is_actuator(machine, name) else self.axes
        return HomingPart(name, among.index(name), sign, config, self.switches_of(name))

    def switches_of(self, name: str) -> tuple[Switch, ...]:
        """Its endstops."""
        return tuple(s for s in self.switches if s.home == name)

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

    def behind(self, part: HomingPart, offset_mm: float) -> float:
        """How far behind its home position an axis may be, where its endstops stay triggered, mm:
        as far as it reaches or, if it is homed, is. `offset_mm` was added at the last homing."""
        axis = self._machine.axes.get(part.name)
        if axis is None or is_actuator(self._machine, part.name):
            return 0.0
        at = axis.max_mm if part.sign > 0 else axis.min_mm
        if part.axis not in self._rig.job.locked_axes:
            at = self._rig.job.machine_position[part.slot] - offset_mm
        return max(0.0, part.sign * (at - part.home))

    def arms_at_home(self, z: float) -> list[float]:
        """The actuator positions with all arms at home; `z` is used if Z moves independently."""
        homing, geometry = self._machine.homing, self._machine.geometry
        home = {n: homing[n].position if n in homing else 0.0 for n in geometry.arms}
        return [home.get(name, z) for name in geometry.actuators]

    def unguided(self) -> list[int]:
        """The numbers of the arms that have no endstop."""
        names, homing = self._machine.geometry.actuators, self._machine.homing
        free = self._machine.geometry.free
        return [i for i, name in enumerate(names) if name in free and name not in homing]
