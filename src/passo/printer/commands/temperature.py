"""Temperatures: units, cold extrusion, faults."""

from __future__ import annotations

from collections.abc import Iterable

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import TOOL, flag, number
from passo.gcode.registry import Kind, Subject, When, command
from passo.printer.cold_extrusion import ColdExtrusion
from passo.printer.commands.heater_control import ControlCommands
from passo.printer.live_rig import LiveRig
from passo.printer.wait_requests import Reply, Wait


def _check_unit(command: Command, _: object) -> None:
    """M149. Raises CommandError for another unit than °C."""
    if command.has("K", "F"):
        raise CommandError.of("command.value", axis="M149", value=command.text, limit="C")


class HeatCommands:
    """Heater commands of a live printer; `SetPoints` has those for temperatures."""

    def __init__(self, rig: LiveRig, controls: ControlCommands) -> None:
        self._rig, self._controls = rig, controls
        self.cold = ColdExtrusion(rig.machine)

    # -- units, cold extrusion --------------------------------------------------------------------

    @command(
        "M149",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Sets the unit of temperatures; only °C (C) is supported.",
        flag("C", "°C"),
        flag("K F", "another unit: refused"),
        kind=Kind.QUIET,
        valid=_check_unit,
    )
    def _unit(self, _: Command, __: Reply) -> Wait | None:
        return None

    @command(
        "M302",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Allows cold extrusion (S, or P of tool T alone). Without parameters it reports it.",
        number("S", "the lowest temperature at which filament moves; 0: any", "°C", alone=True),
        number("P", "1: any temperature, 0: that of S"),
        TOOL,
        kind=Kind.QUIET,
    )
    def _cold_extrusion(self, command: Command, reply: Reply) -> Wait | None:
        if answer := self.cold.set(command.words()):
            reply.say(f"echo:{answer}")
        self.guard_extrusion()
        return None

    def cold_lines(self) -> Iterable[str]:
        """The current settings as M302 commands."""
        return self.cold.lines(self._controls.number_of)

    def guard_extrusion(self) -> None:
        """Sets in the interpreter which filament may move now."""
        self.cold.guard(self._rig.job, self._rig.connection.heaters)

    def can_extrude(self) -> bool:
        """Whether the machine has filament, and the active tool's hotend is warm enough to move
        it."""
        rig = self._rig
        return bool(rig.machine.extruders) and self.cold.warm(rig.connection.heaters, rig.job.tool)

    # -- faults -----------------------------------------------------------------------------------

    @command(
        "M922",
        Subject.HEATERS,
        When.IMMEDIATE,
        "Rearms heaters that a fault has switched off.",
        kind=Kind.SERVED,
        while_halted=False,
    )
    def _rearm(self, _: Command, reply: Reply) -> Wait | None:
        for name, heater in self._rig.connection.heaters.items():
            if heater.fault is not None:
                heater.rearm()
                reply.say(f"echo:Heater {name} is armed again, target {heater.target:g} C")
        return None
