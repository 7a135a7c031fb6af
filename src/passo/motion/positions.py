"""The current position of the machine, from the steps that the boards have counted."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.geometry.base import Unreachable
from passo.motion.axis_slots import E, slot_of_axis

if TYPE_CHECKING:
    from passo import _core
    from passo.board.boards import Boards
    from passo.board.connection import Connection
    from passo.config.machine import MachineConfig


class Positions:
    """The real positions of one printer: the step counts of the boards plus the origins in the
    plan. After an endstop has stopped a motor during a move, `settle` corrects the plan by the
    `lost` steps. `machine` is that of the rig."""

    def __init__(
        self,
        machine: MachineConfig,
        connection: Boards,
        job: _core.Job,
        passed: Callable[[], int],
    ) -> None:
        self.machine = machine
        self._connection, self._job = connection, job
        self._passed = passed  # gives the job's clock up to which the plan is executed
        self._letters = [name.upper() for name in axis_order(machine.axes)]
        self.lost: dict[str, int] = {}
        self.settled = True  # False: a board did not answer the last question
        self.invalidations = 0  # how often motors of axes were switched off
        self.settlings = 0  # how often the origins may have changed
        # True if the motors have been on since another host ran, so that their counts are valid.
        self.held = connection.adopted
        self.known: set[str] = set()  # axes with valid positions, by homing or recovery
        self._loose: set[str] = set()  # homed axes whose motors were switched off after homing
        self._frozen: list[float] | None = None

    def freeze(self) -> None:
        """Call this before homing. Until `thaw`, reports show the last position of the program,
        because the positions of the plan are those of arms or of axes that are not homed."""
        self._frozen = self._job.program_position

    def thaw(self) -> None:
        """Ends `freeze`: the positions of the plan are valid again."""
        self._frozen = None

    @property
    def program(self) -> list[float]:
        """The program's coordinates at the end of the plan, in mm: the axes, then E."""
        return self._frozen or self._job.program_position

    def settle(self) -> None:
        """Sets the plan to the real positions. Call it at standstill, when the boards will not
        execute the rest of the plan. Lets time pass; raises MachineError."""
        self.settled = False
        self.settlings += 1
        for row in self._job.motors.statistics():
            name = row["name"]
            self.lost[name] = row["expected_net"] - self._connection.net_steps(name)
        self.settled = True

    def invalidate(self) -> None:
        """Call this when motors of axes are switched off: the axes can then be moved by hand, which
        step counts do not show."""
        axes = self.machine.axes
        self.held = False
        self.invalidations += 1
        self.settlings += 1
        self.known.clear()
        self._loose = {name for name, axis in axes.items() if not axis.extruder}

    def confirm(self, axes: Iterable[str] | None = None) -> None:
        """Marks the positions of these axes (default: all) as valid, after homing or at the start
        of a print that assumes them."""
        self._loose = set() if axes is None else self._loose.difference(axes)

    def origins(self) -> dict[str, int]:
        """For each motor, the position, in steps, at which the board's step counter is 0. Empty if
        a motor was switched off after homing."""
        if self._loose:
            return {}
        return {
            row["name"]: row["count"] - row["expected_net"] + self.lost.get(row["name"], 0)
            for row in self._job.motors.statistics()
        }

    def restore(self, origins: dict[str, int]) -> bool:
        """Restores the positions from `origins` and the step counts of an adopted board. Returns
        False without any change if the board has no valid counts, or if a motor was switched off in
        the meantime. Lets time pass; raises MachineError."""
        job, connection = self._job, self._connection
        rows = {row["name"]: row for row in job.motors.statistics()}
        if not self.held or set(origins) != set(rows):
            return False
        counts = {name: connection.net_steps(name) + origins[name] for name in rows}
        places = [at for at in self._places(self._real(counts)) if at is not None]
        if len(places) < len(self.machine.axes):
            return False
        job.axes.set(list(enumerate(places)))
        self.settle()
        return True

    def _real(self, counts: dict[str, int]) -> dict[tuple[str, int], float]:
        """The position of each actuator, axis and extruder, mm or degrees."""
        machine = self.machine
        real: dict[tuple[str, int], float] = {}
        for row in self._job.motors.statistics():
            name = row["name"]
            driven = machine.driven_by(name)
            if driven is not None:
                at = counts[name] / row["steps_per_unit"]
                real.setdefault((driven.drive, driven.index), at)
        return real

    def _places(self, real: dict[tuple[str, int], float]) -> list[float | None]:
        """The axis positions in machine mm, with Z above the corrected bed; None if unknown."""
        machine = self.machine
        places: list[float | None] = [None] * len(machine.axes)
        try:
            joints = [real[("actuator", i)] for i in range(len(machine.geometry.actuators))]
            x, y, height = machine.geometry.forward(joints)
            places[:3] = x, y, self._job.bed.plan_z(x, y, height)
        except (Unreachable, KeyError):
            pass
        for i in range(3, len(places)):
            places[i] = real.get(("axis", i))
        return places

    def counts(self, board: Connection | None = None) -> dict[str, int]:
        """The current position in steps of each motor, or of the motors of `board`. Asks the
        boards. Lets time pass; raises MachineError."""
        names = None if board is None else {s.name for s in board.board.steppers}
        found: dict[str, int] = {}
        for row in self._job.motors.statistics():
            name = row["name"]
            if names is not None and name not in names:
                continue
            net = self._connection.net_steps(name) + self.lost.get(name, 0)
            found[name] = net + row["count"] - row["expected_net"]
        return found

    def shown(self) -> dict[str, float]:
        """The program's coordinates of the current position in the plan, mm by axis letter and E.
        Does not ask a board. During homing, the last position of the program."""
        planned = None if self._frozen else self._planned(self._passed())
        return planned or dict(zip([*self._letters, "E"], self.program, strict=True))

    def at(self, clock: int) -> dict[str, float]:
        """The program's coordinates of the plan at a clock of the job, if that was at most about a
        second ago; otherwise those of the current position. Lets time pass; raises MachineError."""
        return self._planned(clock) or self.now()[0]

    def _planned(self, clock: int) -> dict[str, float] | None:
        job = self._job
        found = job.history.position_at(clock)
        if found is None:
            return None
        letters = self._letters
        slots = [*(slot_of_axis(i) for i in range(len(letters))), E]
        ends = job.machine_position
        return {
            letter: place - (ends[slot] - found[slot]) / (job.filament.scale if slot == E else 1)
            for letter, slot, place in zip(
                [*letters, "E"], slots, job.program_position, strict=True
            )
        }

    def now(self) -> tuple[dict[str, float], dict[str, int]]:
        """Asks the boards for their step counts. Returns the program's coordinates of the real
        position, mm by axis letter and E, and the counts of the motors. Lets time pass; raises
        MachineError."""
        machine, job = self.machine, self._job
        counts = self.counts()
        letters = self._letters
        if self._frozen is not None:
            return dict(zip([*letters, "E"], self._frozen, strict=True)), counts
        real = self._real(counts)
        places = self._places(real)
        *ends, e_end = job.program_position
        machine_ends = job.machine_position
        found: dict[str, float] = {}
        for i, letter in enumerate(letters):
            place = places[i]
            if place is not None:
                found[letter] = place + ends[i] - machine_ends[slot_of_axis(i)]
        extruder = machine.tools[job.tool].extruder if machine.tools else None
        index = list(machine.extruders).index(extruder) if extruder else 0
        if ("extruder", index) in real:
            left_mm = machine_ends[E] - real[("extruder", index)]
            found["E"] = e_end - left_mm / job.filament.scale
        return found, counts
