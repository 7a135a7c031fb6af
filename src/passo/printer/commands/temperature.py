"""Temperatures and fans: set, wait, presets, cold extrusion, faults."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from passo.board.faults import FaultKind
from passo.config.motor_roles import axis_order
from passo.errors import CommandError
from passo.gcode.command import Command, numeral
from passo.printer.wait_requests import Handler, Reply, Wait

if TYPE_CHECKING:
    from passo.printer.printer import Printer

_COLD_C = 170.0  # filament does not move below it, unless M302 says otherwise
# What such a sensor says, 400 °C of a short circuit maybe, melts nothing.
_NO_TEMPERATURE = (FaultKind.SENSOR_OPEN, FaultKind.SENSOR_SHORT, FaultKind.SENSOR_ERRATIC)


class HeatCommands:
    """What only a living printer has of heaters and fans; set-points are in `Commands`."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._machine = printer.machine
        self.cold_c = _COLD_C
        self._cold_allowed: set[str] = set()  # hotends whose filament may move cold
        self.planned: dict[str, Handler] = {
            "M106": self._fan,
            "M107": self._fan,
        }
        self.immediate: dict[str, Handler] = {
            "M145": self._preset,
            "M149": self._unit,
            "M302": self._cold_extrusion,
            "M922": self._rearm,
        }

    # -- fans -------------------------------------------------------------------------------------

    def _fan(self, command: Command, reply: Reply) -> Wait | None:
        """Raises CommandError if P names no fan; a machine without fans lets the rest pass."""
        commands = self._printer.commands
        order = commands.fan_order(command)
        numbers = [self._machine.fans[name].number for name in commands.commanded_fans]
        if order.number is not None and order.number not in numbers:
            limit = ", ".join(map(str, numbers)) or "no fan"
            raise CommandError.bad_value("P", order.number, limit)
        if "F" in command.words():
            reply.note("M106 F", "M106 sets no frequency; the machine file has it")
        elif order.share is None:
            reply.note("M106", "M106 sets speeds, by S; the machine file has the settings")
        commands.set_fan(order)
        if order.note:
            reply.note(order.note, order.note)
        return None

    # -- units, presets, cold extrusion ------------------------------------------------------------

    def _unit(self, command: Command, _: Reply) -> Wait | None:
        if command.text.strip().upper() not in ("", "C"):
            raise CommandError.of("command.value", axis="M149", value=command.text, limit="C")
        return None

    def _preset(self, command: Command, reply: Reply) -> Wait | None:
        words, presets = command.words(), self._printer.commands.presets
        if note := presets.set(words):
            reply.say(f"echo:{note}")
        for line in () if "S" in words else presets.lines():
            reply.say(line)
        return None

    def _cold_extrusion(self, command: Command, reply: Reply) -> Wait | None:
        words = command.words()
        meant = set(self._hotends)
        if "T" in words:
            meant = {self._printer.commands.heater("hotend", int(words["T"]))}
        if "S" in words:
            if words["S"] < 0:
                raise CommandError.bad_value("S", words["S"], "0 C or more")
            if "T" in words:
                raise CommandError.bad_value("S", words["S"], "no S beside T: it is of all tools")
            self.cold_c = words["S"]
            self._cold_allowed = set(self._hotends) if self.cold_c == 0 else set()
        if "P" in words:
            self._cold_allowed = self._cold_allowed - meant | (meant if words["P"] else set())
        if words.keys() <= {"T"}:
            allowed = meant & self._cold_allowed
            state = "enabled" if meant and allowed == meant else "disabled"
            for_some = ""
            if allowed and allowed != meant:
                for_some = f", but enabled for {', '.join(sorted(allowed))}"
            reply.say(f"echo:Cold extrudes are {state} (min temp {self.cold_c:g}C){for_some}")
        self.guard_extrusion()
        return None

    def cold_lines(self) -> Iterable[str]:
        """M302 as it is set."""
        every = bool(self._hotends) and set(self._hotends) <= self._cold_allowed
        yield f"M302 S{numeral(self.cold_c)} P{int(every)}"
        if not every:
            for name in sorted(self._cold_allowed):
                yield f"M302 T{self._printer.controls.number_of(name)} P1"

    def guard_extrusion(self) -> None:
        """Tells the interpreter which filament may move."""
        job, axes = self._printer.job, self._machine.axes
        job.cold = not self.warm()
        first = next(iter(self._hotends), None)
        for number, name in enumerate(axis_order(axes)):
            if axes[name].extruder:
                job.set_cold_axis(number, not self._melts(axes[name].heater or first))

    def warm(self) -> bool:
        """The active tool's hotend lets filament move."""
        hotends = self._hotends
        return not hotends or self._melts(self._printer.commands.heater("hotend"))

    @property
    def _hotends(self) -> list[str]:
        return [n for n, h in self._machine.heaters.items() if h.kind == "hotend"]

    def _melts(self, heater: str | None) -> bool:
        if heater is None or heater in self._cold_allowed:
            return True
        sensed = self._printer.connection.heaters[heater]
        if sensed.celsius < self.cold_c:
            return False
        return sensed.fault is None or sensed.fault.kind not in _NO_TEMPERATURE

    # -- faults -----------------------------------------------------------------------------------

    def _rearm(self, _: Command, reply: Reply) -> Wait | None:
        for name, heater in self._printer.connection.heaters.items():
            if heater.fault is not None:
                heater.rearm()
                reply.say(f"echo:Heater {name} is armed again, target {heater.target:g} C")
        return None
