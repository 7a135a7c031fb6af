"""Moves of a single motor, while the other motors of the same axis do not move."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from passo._core import Within
from passo.config.motor_roles import axis_order
from passo.motion.axis_slots import slot_of_axis
from passo.motion.endstops import steppers_of

if TYPE_CHECKING:
    from passo.motion.rig import Rig
    from passo.motion.triggered_moves import Interrupts, TriggeredMoves


class LoneMotors:
    """Moves single motors of one printer. Call it with the motion lock held, the machine idle, and
    boards that do not brake without the host (`TriggeredMoves.prepared`)."""

    def __init__(self, rig: Rig, interrupts: Interrupts, triggered: TriggeredMoves) -> None:
        self._rig, self._interrupts, self._triggered = rig, interrupts, triggered
        self._order = [row["name"] for row in rig.machine.core_spec()["steppers"]]

    async def move(self, axis: str, by_mm: Mapping[str, float], speed_mm_s: float) -> None:
        """Moves each of these motors of a linear axis by its distance, one after the other. The
        position of the axis in the plan stays. Raises Stopped after M108 or M410, and MachineError;
        after an error, a motor may have made only a part of its move."""
        rig, job = self._rig, self._rig.job
        number = axis_order(rig.machine.axes).index(axis)
        slot = slot_of_axis(number)
        at = job.machine_position[slot]
        for name, mm in by_mm.items():
            if not mm:
                continue
            others = [n for n in steppers_of(rig.machine, axis) if n != name]
            job.motors.leave_out([self._order.index(n) for n in others])
            try:
                rig.queue.move({slot: at + mm}, speed_mm_s, Within.ANYTHING)
                rig.queue.flush()
                await self._triggered.standstill()
            finally:
                job.motors.leave_out([])
                job.axes.set([(number, at)])
            self._interrupts.raise_if_interrupted()
