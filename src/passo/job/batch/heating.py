"""Computes the time for which a plan waits for its heaters, with the simulated heat of the machine
file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo import _core
from passo.heat.control import arrival_of, control_of, limits_of, model_of
from passo.job.batch.program import heated
from passo.printer.wait_requests import Wait, WaitForMoves

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.commands.program import Commands

SLICE_S = 0.5  # interval at which a wait reads the temperatures
LEAD_S = 0.25  # delay of the moves after a wait
LONGEST_S = 3600.0  # a heater that takes longer is broken


class Heating:
    """The simulated heaters of one planned job. `seconds` is the time for which the job has waited
    for them so far; `unreached` are the heaters that failed or did not reach a target within an
    hour, each with this target in °C.
    """

    def __init__(self, machine: MachineConfig, job: _core.Job) -> None:
        self._job, self._hz = job, machine.board.clock_hz
        self._names = list(machine.heaters)
        self._fans = {name: heater.fan for name, heater in machine.heaters.items() if heater.fan}
        self._bodies = {
            name: _core.HeatRun(
                _core.HeatModel(
                    heater.simulated.full_power_rise_c,
                    heater.simulated.time_constant_s,
                    heater.simulated.sensor_time_constant_s,
                    heater.simulated.fan_loss,
                ),
                control_of(heater),
                arrival_of(heater),
                heater.max_power,
                limits_of(heater),
                model_of(heater),
            )
            for name, heater in machine.heaters.items()
        }
        self.heaters = {name: body.heater for name, body in self._bodies.items()}
        self._now_s = 0.0  # time of the plan without waits for heaters
        self.seconds = 0.0
        self.unreached: dict[str, float] = {}
        self.targets: list[tuple[float, str, float]] = []
        """The targets so far: the time of the plan in s, the heater, the target in °C."""

    def set_target(self, heater: str, celsius: float, *, at_once: bool = False) -> None:
        """Sets a target when the moves so far are done, or at once."""
        if at_once:
            self._bodies[heater].heater.target = celsius
            self.targets.append((self._now_s, heater, celsius))
        else:
            self._job.outputs.mark(self._names.index(heater), round(celsius * 100))

    def settle(self, wait: Wait, commands: Commands) -> None:
        """Ends a wait of the plan, after the simulated time that its temperatures need."""
        if isinstance(wait, WaitForMoves) and wait.executed:
            self._job.flush()
            self._pass()
        heated(self._job, lambda heaters: self._wait(heaters, commands))(wait)

    def catch_up(self) -> None:
        """Lets the time of the settled plan pass."""
        self._pass()

    def warnings(self, file: str) -> list[str]:
        """One sentence for each of `unreached`."""
        return [
            f"{file}: heater {name} does not reach {celsius:g} °C with the figures of its"
            f" simulated table, so heating_s is too short. Correct these figures, or the target."
            for name, celsius in self.unreached.items()
        ]

    def _wait(self, heaters: list[str], commands: Commands) -> None:
        self._job.flush()
        self._pass()
        for name, fan in self._fans.items():
            self._bodies[name].set_fan(commands.outputs.fans.get(fan, 0.0))
        loops = {name: self._bodies[name].heater for name in heaters}
        # Wait only for heating, not for cooling.
        waited = [h for h in loops.values() if h.celsius <= h.target + h.arrival.window_c]
        took_s = 0.0
        while took_s < LONGEST_S and any(
            h.target > 0 and not h.settled and h.fault is None for h in waited
        ):
            self._run(SLICE_S)
            took_s += SLICE_S
        self.seconds += took_s + (LEAD_S if took_s else 0.0)
        for name, h in loops.items():
            if h.fault is not None or (h in waited and h.target > 0 and not h.settled):
                self.unreached.setdefault(name, h.target)

    def _pass(self) -> None:
        """Simulates the heaters up to the end of the settled plan, with all changes of targets."""
        while (mark := self._job.outputs.next_mark) is not None:
            self._job.outputs.pop_mark()
            clock, heater, centi = mark
            self._until(clock / self._hz)
            self._bodies[self._names[heater]].heater.target = centi / 100
            self.targets.append((clock / self._hz, self._names[heater], centi / 100))
        self._until(self._job.clock / self._hz)

    def _until(self, plan_s: float) -> None:
        self._run(plan_s - self._now_s)
        self._now_s = max(self._now_s, plan_s)

    def _run(self, seconds: float) -> None:
        for body in self._bodies.values():
            body.run(seconds)
