"""The travel of axes by the step counts of the boards, whatever the plan says meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.motion.axis_slots import slot_of_axis

if TYPE_CHECKING:
    from passo.motion.rig import Rig


class RealTravel:
    """Counts from now on. Create it at standstill, while positions of the plan are axis
    positions."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._before = rig.job.machine_position
        lost = rig.positions.lost
        rows = rig.job.motors.statistics()
        self._counts = {r["name"]: r["expected_net"] - lost.get(r["name"], 0) for r in rows}

    def place(self) -> list[float]:
        """The machine position of each axis, mm or degrees: that at the beginning, and what the
        motors have moved since then. Asks the boards. Lets time pass; raises MachineError, and
        Unreachable if arms have been moved where no position belongs to them."""
        rig, machine = self._rig, self._rig.machine
        place = [self._before[slot_of_axis(i)] for i in range(len(machine.axes))]
        x, y, z = place[:3]
        actuators = list(machine.geometry.inverse((x, y, rig.job.bed.nozzle_height(x, y, z))))
        counted: set[tuple[str, int]] = set()
        for row in rig.job.motors.statistics():
            name = row["name"]
            driven = machine.driven_by(name)
            if driven is None or (driven.drive, driven.index) in counted:
                continue
            counted.add((driven.drive, driven.index))
            by = (rig.connection.net_steps(name) - self._counts[name]) / row["steps_per_unit"]
            if driven.drive == "actuator":
                actuators[driven.index] += by
            elif driven.drive == "axis":
                place[driven.index] += by
        x, y, height = machine.geometry.forward(actuators)
        return [x, y, rig.job.bed.plan_z(x, y, height), *place[3:]]
