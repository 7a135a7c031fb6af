"""M220 and M221: factors that scale the speeds and the filament of a program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.gcode.parameters import TOOL, flag, ignored, number
from passo.gcode.registry import Subject, When, command, in_program
from passo.printer.commands.ranges import beyond

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.commands.plan import Plan
    from passo.printer.wait_requests import Reply

_SPEED = (10.0, 1000.0)  # range of M220, percent
_FLOW = (1.0, 1000.0)  # range of M221, percent


class SpeedAndFlow:
    """The factors of one job. In a program they apply to later moves; from a console they also
    change planned moves. `kept` is the factor that M220 B has stored for M220 R."""

    def __init__(self, machine: MachineConfig, job: _core.Job, plan: Plan) -> None:
        self._machine, self._job, self._plan = machine, job, plan
        self.kept = 1.0

    @command(
        "M220",
        Subject.SPEED,
        When.IMMEDIATE,
        "Scales the speed. During a print the factor also changes queued moves. B keeps the present"
        " factor, R restores it.",
        number("S", "the factor", "%", *_SPEED, clamped=True, alone=True),
        flag("B", "keeps the present factor"),
        flag("R", "restores the factor that was kept"),
        while_halted=False,
    )
    def _speed_at_once(self, command: Command, reply: Reply) -> None:
        self._set_speed(command, reply, live=True)

    @in_program("M220")
    def _speed(self, command: Command, reply: Reply) -> None:
        self._set_speed(command, reply, live=False)

    def _set_speed(self, command: Command, reply: Reply, *, live: bool) -> None:
        factor, note = self.kept if command.has("R") else None, ""
        if (percent := command.value("S", None)) is not None:
            low, high = _SPEED
            if percent <= 0:
                raise CommandError.bad_value("S", percent, f"{low:g} to {high:g} percent")
            factor = min(max(percent, low), high) / 100
            note = beyond("M220", percent, _SPEED, "%")
        if command.has("B"):
            self.kept = self._job.limits.speed_factor
        if factor is not None:
            self._job.limits.set_speed_factor(factor, live)
            if live:
                self._plan.replan()
        elif not command.text.strip():
            reply.say(f"Speed factor override: {self._job.limits.speed_factor * 100:g}")
        if note:
            reply.note("M220", note, again=True)

    @command(
        "M221",
        Subject.FILAMENT,
        When.IMMEDIATE,
        "Scales the extrusion of a tool. During a print the factor also changes queued moves.",
        TOOL,
        number("S", "the factor", "%", *_FLOW, clamped=True, alone=True),
        ignored("R X Y Z"),
        only_during_print=True,
        while_halted=False,
    )
    def _flow_at_once(self, command: Command, reply: Reply) -> None:
        self._set_flow(command, reply, live=True)

    @in_program("M221")
    def _flow(self, command: Command, reply: Reply) -> None:
        self._set_flow(command, reply, live=False)

    def _set_flow(self, command: Command, reply: Reply, *, live: bool) -> None:
        tools = self._machine.all_tools
        tool = command.integer("T", self._job.tool)
        own = tools[tool].extruder if tool in range(len(tools)) else None
        if own is None and not command.has("T"):
            return  # the active tool has no extruder
        if own is None:
            raise CommandError.bad_value("T", tool, "a tool with an extruder")
        extruder = list(self._machine.extruders).index(own)
        percent, (low, high) = command.value("S", None), _FLOW
        if percent is None:
            reply.say(f"echo:E{tool} Flow: {self._job.filament.flows[extruder] * 100:g}%")
            return
        if percent <= 0:
            raise CommandError.bad_value("S", percent, f"{low:g} to {high:g} percent")
        if note := beyond("M221", percent, _FLOW, "%"):
            reply.note(note, note)
        factor = min(max(percent, low), high) / 100
        if live:
            self._plan.scale_flow(extruder, factor)
        else:
            self._job.filament.set_flow(extruder, factor)
