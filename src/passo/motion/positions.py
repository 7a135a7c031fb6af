"""The current position of the machine, by the steps that the board has made."""

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
    """Real positions of one printer. The board counts steps; the plan knows where counting began.
    An endstop stops a motor in mid-way: `lost` steps are then made up for by `settle`. `machine` is
    that of the rig."""

    def __init__(
        self,
        machine: MachineConfig,
        connection: Boards,
        job: _core.Job,
        passed: Callable[[], int],
    ) -> None:
        self.machine = machine
        self._connection, self._job = connection, job
        self._passed = passed  # the job's clock until which the plan was executed
        self._letters = [name.upper() for name in axis_order(machine.axes)]
        self.lost: dict[str, int] = {}
        self.settled = True  # False: a board did not answer the last time
        self.loosenings = 0  # how often motors of axes went off
        self.settlings = 0  # how often the origins may have changed
        # The motors were on without a break since another host ran: their counts are still valid.
        self.held = connection.adopted
        self.known: set[str] = set()  # axes that homed, or a recovery placed, and held since
        self._loose: set[str] = set()  # homed axes whose motors were off since
        self._frozen: list[float] | None = None

    def freeze(self) -> None:
        """Axes home now. Positions of the plan are those of arms, or of axes that are not homed:
        reports keep to where the program was, until `thaw`."""
        self._frozen = self._job.program_position

    def thaw(self) -> None:
        """Positions are valid again."""
        self._frozen = None

    @property
    def program(self) -> list[float]:
        """The program's coordinates at the end of the plan: the axes, then E."""
        return self._frozen or self._job.program_position

    def settle(self) -> None:
        """The machine is at standstill: the board will not execute the rest of the plan. Lets time
        pass; raises MachineError."""
        self.settled = False
        self.settlings += 1
        for row in self._job.steppers():
            name = row["name"]
            self.lost[name] = row["expected_net"] - self._connection.net_steps(name)
        self.settled = True

    def loosen(self) -> None:
        """Motors of axes are off: the axes may be moved by hand, and step counts do not show it."""
        axes = self.machine.axes
        self.held = False
        self.loosenings += 1
        self.settlings += 1
        self.known.clear()
        self._loose = {name for name, axis in axes.items() if not axis.extruder}

    def trust(self, axes: Iterable[str] | None = None) -> None:
        """These axes, all by default, are where the plan says: they are at home, or a print begins
        with them as they are."""
        self._loose = set() if axes is None else self._loose.difference(axes)

    def origins(self) -> dict[str, int]:
        """Each motor's position, in steps, where the board's count of it is 0. Empty if a motor was
        off since the axes were homed."""
        if self._loose:
            return {}
        return {
            row["name"]: row["count"] - row["expected_net"] + self.lost.get(row["name"], 0)
            for row in self._job.steppers()
        }

    def restore(self, origins: dict[str, int]) -> bool:
        """Restores positions from these origins and the counts of a board that was adopted. False,
        without any change, if the board does not know them, or a motor was off since. Lets time
        pass; raises MachineError."""
        job, connection = self._job, self._connection
        rows = {row["name"]: row for row in job.steppers()}
        if not self.held or set(origins) != set(rows):
            return False
        counts = {name: connection.net_steps(name) + origins[name] for name in rows}
        places = [at for at in self._places(self._real(counts)) if at is not None]
        if len(places) < len(self.machine.axes):
            return False
        job.set_axes(list(enumerate(places)))
        self.settle()
        return True

    def _real(self, counts: dict[str, int]) -> dict[tuple[str, int], float]:
        """The position of each actuator, axis and extruder, mm or degrees."""
        machine = self.machine
        real: dict[tuple[str, int], float] = {}
        for row in self._job.steppers():
            name = row["name"]
            driven = machine.driven_by(name)
            if driven is not None:
                at = counts[name] / row["steps_per_unit"]
                real.setdefault((driven.drive, driven.index), at)
        return real

    def _places(self, real: dict[tuple[str, int], float]) -> list[float | None]:
        """The axes, in machine mm, Z above the corrected bed; None if it is not known."""
        machine = self.machine
        places: list[float | None] = [None] * len(machine.axes)
        try:
            a, b, c = (real[("actuator", i)] for i in range(3))
            x, y, height = machine.geometry.forward((a, b, c))
            places[:3] = x, y, self._job.plan_z(x, y, height)
        except (Unreachable, KeyError):
            pass
        for i in range(3, len(places)):
            places[i] = real.get(("axis", i))
        return places

    def counts(self, board: Connection | None = None) -> dict[str, int]:
        """The position in steps, now, of each motor, or of those of one board. Lets time pass;
        raises MachineError."""
        names = None if board is None else {s.name for s in board.board.steppers}
        found: dict[str, int] = {}
        for row in self._job.steppers():
            name = row["name"]
            if names is not None and name not in names:
                continue
            net = self._connection.net_steps(name) + self.lost.get(name, 0)
            found[name] = net + row["count"] - row["expected_net"]
        return found

    def shown(self) -> dict[str, float]:
        """The program's coordinates of the plan's current position, by axis letter and E, without a
        question to a board; while axes home, those of where the program was."""
        planned = None if self._frozen else self._planned(self._passed())
        return planned or dict(zip([*self._letters, "E"], self.program, strict=True))

    def at(self, clock: int) -> dict[str, float]:
        """The program's coordinates of where the plan was at a clock of the job, at most about a
        second ago; else of where the machine is now. Lets time pass; raises MachineError."""
        return self._planned(clock) or self.now()[0]

    def _planned(self, clock: int) -> dict[str, float] | None:
        job = self._job
        found = job.position_at(clock)
        if found is None:
            return None
        letters = self._letters
        slots = [*(slot_of_axis(i) for i in range(len(letters))), E]
        ends = job.machine_position
        return {
            letter: place - (ends[slot] - found[slot]) / (job.filament_scale if slot == E else 1)
            for letter, slot, place in zip(
                [*letters, "E"], slots, job.program_position, strict=True
            )
        }

    def now(self) -> tuple[dict[str, float], dict[str, int]]:
        """The program's coordinates by the steps made so far, by axis letter and E, and the motors'
        counts. Lets time pass; raises MachineError."""
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
            found["E"] = e_end - left_mm / job.filament_scale
        return found, counts
