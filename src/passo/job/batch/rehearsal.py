"""The checks of the served printer in a print without consoles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

from passo.config.motor_roles import axis_order
from passo.errors import CommandError, InputError
from passo.gcode.command import Command
from passo.job.batch.program import with_option
from passo.motion.endstops import axes_lost, homed_axes, named_axes, named_motors
from passo.printer.cold_extrusion import ColdExtrusion
from passo.printer.commands.kinematic_position import positions
from passo.printer.commands.program import Commands, Probing
from passo.printer.commands.set_points import Heat
from passo.printer.status import HeaterStatus
from passo.printer.wait_requests import Reply, Wait, WaitForHoming, WaitForMoves

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.macros import Macros


@dataclass(slots=True)
class _Target:
    """The last target of a hotend, °C, and the clock of the plan up to which an earlier, warm
    target applies."""

    celsius: float = 0.0
    warm_until: float = -inf


def _plan_end(job: _core.Job) -> float:
    return job.clock + job.plan.queued_ticks


class _WatchedHeat:
    """Notes each target that waits for the moves before it, and passes it on to `heat`."""

    def __init__(
        self, heat: Heat, job: _core.Job, targets: dict[str, _Target], cold_c: float
    ) -> None:
        self._heat, self._job, self._targets, self._cold_c = heat, job, targets, cold_c

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """As `Heat.set_target`."""
        if not at_once:
            target = self._targets[heater]
            if target.celsius >= self._cold_c:
                target.warm_until = _plan_end(self._job)
            target.celsius = celsius
        self._heat.set_target(heater, celsius, at_once=at_once)


class RehearsedCommands(Commands):
    """The commands of a print with the checks of the served printer. The print fails at the errors
    that stop a print from the SD card: at moves of axes that are not homed, at cold extrusion, and
    at each refused command.

    A hotend that is cold and has no warm target blocks filament when a line is read. A hotend that
    is still heating up when a line is read is checked later, when the board moves the filament. So
    the plan need not wait, and its steps equal those of a print without checks.
    """

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        heat: Heat,
        full_scale: list[int],
        heaters: Mapping[str, _core.Heater],
        catch_up: Callable[[], None] = lambda: None,
        *,
        macros: Macros | None = None,
        probing: Probing | None = None,
        left_out: frozenset[str] = frozenset(),
    ) -> None:
        """`catch_up` is called before macros see the heaters. The others are as for `Commands`."""
        self.cold = ColdExtrusion(machine)
        self._targets = {name: _Target() for name in machine.heaters}
        watched = _WatchedHeat(heat, job, self._targets, self.cold.cold_c)
        super().__init__(
            machine, job, watched, full_scale, macros=macros, probing=probing, left_out=left_out
        )
        self._heaters, self._catch_up = heaters, catch_up
        self.unsure = False  # whether lines since the last check may move cold filament
        self._now = 0.0
        self.unsure_until = -1.0  # clock of the plan up to which this was so
        self._axes = axis_order(machine.axes)
        self._lock(homed_axes(machine))

    def run(self, command: Command, reply: Reply | None = None) -> Wait | None:
        """Like `Commands.run`."""
        if command.code == "M302":
            return self._guard_set(command)
        if command.code == "SET_KINEMATIC_POSITION":
            return self._position_set(command)
        wait = super().run(command, reply)
        if command.code in ("M18", "M84") and "S" not in command.words():
            self._lock(axes_lost(self._machine, named_motors(self._machine, command.text)))
        self.guard(self._now)  # the tool or a target may have changed
        return wait

    def heaters(self) -> dict[str, HeaterStatus]:
        """The simulated heaters as they are now, while the plan is ahead."""
        self._catch_up()
        targets_c = self.set_points.targets_c
        return {
            name: HeaterStatus(
                heater.celsius,
                targets_c.get(name, 0.0),
                heater.power,
                min_extrude_c=self.cold.min_c_of(name),
            )
            for name, heater in self._heaters.items()
        }

    def refuse(self, command: Command, error: CommandError, file: str) -> None:
        """Raises InputError, because a print from the card would stop here too."""
        placed = (replace(p, file=file, line=command.line) for p in error.problems)
        raise InputError([with_option(problem) for problem in placed])

    def settled(self, wait: Wait) -> None:
        """See `Commands.settled`."""
        if not isinstance(wait, WaitForHoming):
            return
        names, point = named_axes(self._machine, wait.letters), self._machine.rest_mm
        numbers = [number for number, name in enumerate(self._axes) if name in names]
        if "O" in wait.letters:
            lost = [number for number in self._job.locked_axes if number in numbers]
            places = [(number, point[self._axes[number]]) for number in lost]
            self._job.axes.set(places, homed=True)
            if lost and wait.letters == "O":
                self.flow.homed()
            return
        for number in numbers:
            self._job.axes.lock(number, False)
        super().settled(wait)

    def guard(self, now: float) -> None:
        """Allows later lines to move filament only if its hotend is warm, or may become warm. `now`
        is the board's clock within the job."""
        self._now = now
        if self.unsure:
            self.unsure_until = _plan_end(self._job)
        heaters, cold = self._heaters, self.cold
        self.unsure = False

        def holds(heater: str | None) -> bool:
            if heater is None or cold.allows(heater):
                return False
            melts, target = cold.melts(heater, heaters), self._targets[heater]
            warms = max(target.celsius, heaters[heater].target) >= cold.cold_c
            warms = warms or now < target.warm_until
            self.unsure = self.unsure or melts != (target.celsius >= cold.cold_c)
            return not (melts or warms)

        self._job.filament.cold = bool(cold.hotends) and holds(cold.hotend(self._job.tool))
        for number, heater in cold.axes():
            self._job.filament.set_cold_axis(number, holds(heater))

    def cold_filament(self) -> list[tuple[str, bool]]:
        """For each motor of an extruder, whether its filament is too cold to move now."""
        machine, heaters, cold = self._machine, self._heaters, self.cold
        of_extruder: dict[str, list[str]] = {}
        for number, tool in enumerate(machine.all_tools if cold.hotends else ()):
            if tool.extruder:
                of_extruder.setdefault(tool.extruder, []).append(cold.hotend(number))
        of_axis = {self._axes[number]: heater for number, heater in cold.axes()}
        found: list[tuple[str, bool]] = []
        for stepper in machine.steppers:
            driven = machine.driven_by(stepper)
            if driven is None:
                continue
            if driven.drive == "extruder":
                hotends = of_extruder.get(list(machine.extruders)[driven.index], [])
                if hotends:
                    melts = any(cold.melts(heater, heaters) for heater in hotends)
                    found.append((stepper, not melts))
            elif driven.drive == "axis" and self._axes[driven.index] in of_axis:
                heater = of_axis[self._axes[driven.index]]
                found.append((stepper, not cold.melts(heater, heaters)))
        return found

    def _guard_set(self, command: Command) -> Wait:
        """Sets M302 when the earlier lines are done, because the old setting applies to them."""
        command.check()
        return WaitForMoves(lambda: self.cold.set(command.words()), executed=True)

    def _position_set(self, command: Command) -> Wait:
        places, lost = positions(command, self._machine, self._job)

        def place() -> None:
            self._job.axes.set(list(places.items()))
            self._lock(lost)

        return WaitForMoves(place)

    def _lock(self, names: set[str]) -> None:
        if self._machine.unhomed_moves == "refuse":
            for name in names:
                self._job.axes.lock(self._axes.index(name), True)
