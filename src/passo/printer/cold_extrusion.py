"""Cold extrusion: decides which filament may move at the present temperatures of the hotends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from passo.board.faults import FaultKind
from passo.config.heater_numbers import heater_of
from passo.config.motor_roles import axis_order
from passo.errors import CommandError
from passo.gcode.command import numeral

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig

# Readings of such a sensor, for example 400 °C of a short circuit, are not valid.
_NO_TEMPERATURE = (FaultKind.SENSOR_OPEN, FaultKind.SENSOR_SHORT, FaultKind.SENSOR_ERRATIC)


class ColdExtrusion:
    """The settings of M302, and the check of them. `cold_c` is the temperature below which filament
    does not move, °C."""

    def __init__(self, machine: MachineConfig) -> None:
        self._machine = machine
        self.cold_c = machine.limits.min_extrude_c
        # hotends whose filament may move cold
        self._allowed: set[str] = set[str]() if self.cold_c else set(self.hotends)

    @property
    def hotends(self) -> list[str]:
        """All hotends, in the order of the machine file."""
        return [n for n, h in self._machine.heaters.items() if h.kind == "hotend"]

    def hotend(self, tool: int) -> str:
        """The hotend of a tool. Raises CommandError if there is none."""
        name = heater_of(self._machine, "hotend", tool)
        if name is None:
            there = len(self.hotends)
            raise CommandError.of("heat.unknown", axis="hotend", value=tool, limit=there)
        return name

    def set(self, words: Mapping[str, float]) -> str:
        """Executes M302; returns the report that it asks for, or an empty text. Raises
        CommandError."""
        meant = set(self.hotends)
        if "T" in words:
            meant = {self.hotend(int(words["T"]))}
        if "S" in words:
            if words["S"] < 0:
                raise CommandError.bad_value("S", words["S"], "at least 0 C")
            if "T" in words:
                raise CommandError.bad_value("S", words["S"], "no S with T: S is for all tools")
            self.cold_c = words["S"]
            self._allowed = set(self.hotends) if self.cold_c == 0 else set()
        if "P" in words:
            self._allowed = self._allowed - meant | (meant if words["P"] else set())
        if not words.keys() <= {"T"}:
            return ""
        allowed = meant & self._allowed
        state = "enabled" if meant and allowed == meant else "disabled"
        for_some = ""
        if allowed and allowed != meant:
            for_some = f", but enabled for {', '.join(sorted(allowed))}"
        return f"Cold extrudes are {state} (min temp {self.cold_c:g}C){for_some}"

    def lines(self, number_of: Callable[[str], int | None]) -> Iterable[str]:
        """The current settings as M302 commands."""
        every = bool(self.hotends) and set(self.hotends) <= self._allowed
        yield f"M302 S{numeral(self.cold_c)} P{int(every)}"
        if not every:
            for name in sorted(self._allowed):
                yield f"M302 T{number_of(name)} P1"

    def guard(self, job: _core.Job, heaters: Mapping[str, _core.Heater]) -> None:
        """Sets in the interpreter of `job` which filament may move now."""
        job.filament.cold = not self.warm(heaters, job.tool)
        for number, heater in self.axes():
            job.filament.set_cold_axis(number, not self.melts(heater, heaters))

    def warm(self, heaters: Mapping[str, _core.Heater], tool: int) -> bool:
        """Whether the tool's hotend is warm enough to move filament."""
        return not self.hotends or self.melts(self.hotend(tool), heaters)

    def min_c(self, tool: int) -> float:
        """The temperature, °C, below which the tool's hotend moves no filament; 0 without such a
        limit."""
        name = heater_of(self._machine, "hotend", tool)
        return 0.0 if name is None else self.min_c_of(name)

    def min_c_of(self, heater: str) -> float:
        """The minimum temperature of a heater for moving filament; 0 if it is not a hotend."""
        limited = self._machine.heaters[heater].kind == "hotend" and not self.allows(heater)
        return self.cold_c if limited else 0.0

    def axes(self) -> list[tuple[int, str | None]]:
        """The axes that are extruders, with their hotends."""
        axes, first = self._machine.axes, next(iter(self.hotends), None)
        return [
            (number, axes[name].heater or first)
            for number, name in enumerate(axis_order(axes))
            if axes[name].extruder
        ]

    def allows(self, heater: str) -> bool:
        """Whether M302 allows the filament of this hotend to move at any temperature."""
        return heater in self._allowed

    def melts(self, heater: str | None, heaters: Mapping[str, _core.Heater]) -> bool:
        """Whether filament may move through this hotend now; None means an extruder without a
        hotend."""
        if heater is None or self.allows(heater):
            return True
        sensed = heaters[heater]
        if sensed.celsius < self.cold_c:
            return False
        return sensed.fault is None or sensed.fault.kind not in _NO_TEMPERATURE
