"""Temperatures and fans: set, wait, presets, cold extrusion, faults."""

from __future__ import annotations

from collections.abc import Iterable

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.printer.cold_extrusion import ColdExtrusion
from passo.printer.commands.heater_control import ControlCommands
from passo.printer.live_rig import LiveRig
from passo.printer.wait_requests import Handler, Reply, Wait


class HeatCommands:
    """What only a living printer has of heaters and fans; set-points are in `Commands`."""

    def __init__(self, rig: LiveRig, controls: ControlCommands) -> None:
        self._rig, self._controls = rig, controls
        self.cold = ColdExtrusion(rig.machine)
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
        commands = self._rig.commands
        order = commands.fan_order(command)
        commands.set_fan(order)
        if "F" in command.words():
            reply.note("M106 F", "M106 sets no frequency; the machine file has it")
        elif order.share is None:
            reply.note("M106", "M106 sets speeds, by S; the machine file has the settings")
        if order.note:
            reply.note(order.note, order.note)
        return None

    # -- units, presets, cold extrusion ------------------------------------------------------------

    def _unit(self, command: Command, _: Reply) -> Wait | None:
        if command.text.strip().upper() not in ("", "C"):
            raise CommandError.of("command.value", axis="M149", value=command.text, limit="C")
        return None

    def _preset(self, command: Command, reply: Reply) -> Wait | None:
        words, presets = command.words(), self._rig.commands.presets
        if note := presets.set(words):
            reply.say(f"echo:{note}")
        for line in () if "S" in words else presets.lines():
            reply.say(line)
        return None

    def _cold_extrusion(self, command: Command, reply: Reply) -> Wait | None:
        if answer := self.cold.set(command.words()):
            reply.say(f"echo:{answer}")
        self.guard_extrusion()
        return None

    def cold_lines(self) -> Iterable[str]:
        """M302 as it is set."""
        return self.cold.lines(self._controls.number_of)

    def guard_extrusion(self) -> None:
        """Sets in the interpreter which filament may move."""
        self.cold.guard(self._rig.job, self._rig.connection.heaters)

    def warm(self) -> bool:
        """The active tool's hotend lets filament move."""
        return self.cold.warm(self._rig.connection.heaters, self._rig.job.tool)

    # -- faults -----------------------------------------------------------------------------------

    def _rearm(self, _: Command, reply: Reply) -> Wait | None:
        for name, heater in self._rig.connection.heaters.items():
            if heater.fault is not None:
                heater.rearm()
                reply.say(f"echo:Heater {name} is armed again, target {heater.target:g} C")
        return None
