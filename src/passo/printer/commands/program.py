"""Executes the commands that the interpreter of a job does not handle itself, for live and offline
printing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol, Self, cast

from passo.errors import CommandError, Problem
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Role, commands_of, row_of
from passo.printer.commands.backlash import BacklashCommands
from passo.printer.commands.fan_targets import FanTargets
from passo.printer.commands.klipper_commands import KlipperCommands
from passo.printer.commands.lights import Lights, LightSink, NoLights
from passo.printer.commands.limits import Limits
from passo.printer.commands.motion_filters import MotionFilters
from passo.printer.commands.not_yet import NotYet
from passo.printer.commands.output_pins import OutputPins
from passo.printer.commands.outputs import Outputs
from passo.printer.commands.plan import Plan, PlanAhead
from passo.printer.commands.program_flow import ProgramFlow, by_interpreter
from passo.printer.commands.servos import Servos
from passo.printer.commands.set_points import Heat, NoHeat, SetPoints
from passo.printer.commands.speed_and_flow import SpeedAndFlow
from passo.printer.commands.stand_ins import StandInCommands
from passo.printer.commands.tuning_tower import TuningTower
from passo.printer.input_errors import problem, problem_of
from passo.printer.macros import Macros, Respond
from passo.printer.planned_status import PlannedFile, planned_status
from passo.printer.skipped_commands import SkippedCommand, SkippedCommands
from passo.printer.status import HeaterStatus
from passo.printer.unfit_commands import LEVELLING
from passo.printer.wait_requests import (
    Handler,
    NullReply,
    Reply,
    Wait,
    WaitForHoming,
    WaitForMoves,
    WaitForUser,
)

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.status import Status

# The handlers of a job by code: the names of the part and of its method. Parts belong to a
# `Commands` object, and must not refer to it.
_PARTS = {
    "flow": ProgramFlow,
    "set_points": SetPoints,
    "outputs": Outputs,
    "pins": OutputPins,
    "lights": Lights,
    "servos": Servos,
    "fan_targets": FanTargets,
    "limits": Limits,
    "filters": MotionFilters,
    "backlash": BacklashCommands,
    "factors": SpeedAndFlow,
    "klipper": KlipperCommands,
    "tower": TuningTower,
    "macros": Macros,
    "not_yet": NotYet,
    "stand_ins": StandInCommands,
}
_METHODS: dict[Role, dict[str, tuple[str, str]]] = {role: {} for role in Role}
for _name, _part in _PARTS.items():
    for _code, _role, _method in commands_of(_part):
        _METHODS[_role][_code] = (_name, _method)

DECLARED = frozenset(_METHODS[Role.DECLARED])
"""Commands that are declared by these parts. For other commands, the parts only have the handler
within a program."""

FILTER_COMMANDS = frozenset(
    code for part in (MotionFilters, BacklashCommands) for code, _, _ in commands_of(part)
)
"""Commands that set filters of the motion: shapers, limits of jerk, pressure advance, backlash."""


class _Counted(NullReply):
    """A reply that counts the notes of a command, for a program without a console."""

    def __init__(self, omitted: SkippedCommands, line: int) -> None:
        self._omitted, self._line = omitted, line

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Counts the note."""
        self._omitted.count(SkippedCommand.REFUSED, text, self._line)


class Probing(Protocol):
    """Measures the bed for a plan."""

    def wait_for(self, command: Command, commands: Commands) -> Wait | None:
        """The wait of a command that needs a probe; None if it is skipped."""
        ...

    def shown(self, status: Status) -> Status:
        """The status of the plan, with the bed as it was measured."""
        ...


class Commands:
    """Executes the commands that a job's interpreter does not handle itself; one object for each
    job. Not thread-safe. Each part has the commands of one subject. `omitted` counts skipped
    commands.
    """

    @classmethod
    def of_plan(cls, machine: MachineConfig, job: _core.Job) -> Self:
        """The commands of a job that is only planned, without heaters and outputs."""
        return cls(machine, job, NoHeat(), [1] * len(machine.timed_outputs))

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        heat: Heat,
        full_scale: list[int],
        plan: Plan | None = None,
        *,
        macros: Macros | None = None,
        status: Callable[[], Status] | None = None,
        probing: Probing | None = None,
        lights: LightSink | None = None,
        left_out: frozenset[str] = frozenset(),
    ) -> None:
        """`full_scale` has the value for fully on of each timed output. `plan` decides which
        planned moves commands may change; by default none. `macros` and `status` are those of a
        printer; by default the job has its own. `probing` measures the bed for a plan. `lights`
        show frames; by default none does. The commands `left_out` have no effect."""
        self._machine, self._job = machine, job
        self._status, self._probing, self._left_out = status, probing, left_out
        plan = plan or PlanAhead(job)
        self.omitted = SkippedCommands()
        self.macros = macros or Macros(machine)
        self.outputs = Outputs(machine, job, full_scale, plan)
        self.flow = ProgramFlow(machine, job, self.outputs, self.omitted)
        self.set_points = SetPoints(machine, job, heat)
        self.limits = Limits(machine, job, plan)
        self.filters = MotionFilters(machine, job)
        self.backlash = BacklashCommands(machine, job)
        self.factors = SpeedAndFlow(machine, job, plan)
        stand_ins = self.macros.stand_ins
        self.klipper = KlipperCommands(machine, job, self.flow.babysteps_mm, stand_ins)
        self.tower = TuningTower(machine, job)
        self.not_yet = NotYet()
        self.stand_ins = StandInCommands(machine, stand_ins, self.omitted)
        self.fan_targets = FanTargets(machine)
        self.pins = OutputPins(machine, job, self.outputs, stand_ins, self.omitted)
        self.lights = Lights(
            machine, job, self.outputs, lights or NoLights(), stand_ins, self.omitted
        )
        self.servos = Servos(machine, job, self.outputs, stand_ins, self.omitted)
        self.file: PlannedFile | None = None  # the file of a plan

    def run(self, command: Command, reply: Reply | None = None) -> Wait | None:
        """Executes one command in program order, or counts it as unknown. Returns the wait that the
        command needs, or None. Without `reply`, notes are counted. Raises CommandError if the
        command is refused, and WordError for a word without a number."""
        if command.letter == "T":
            if command.minor:
                self.omitted.count(SkippedCommand.TOOL, f"T{command.number}", command.line)
            else:
                self.tool_changed(command.number)
            # Moves of another tool may be planned again, so the correction of the bed waits for
            # them.
            return WaitForMoves(self._job.bed.follow_tool) if self._job.bed.is_apart else None
        code = _key(command)
        command.check(self._machine, in_file=reply is None)
        if reply is None:
            for name in command.unknown():
                self.omitted.count(SkippedCommand.PARAMETER, f"{name[:30]} of {code}", command.line)
        if code in self._left_out:
            return None
        handler = self._handler(code, Role.IN_PROGRAM, Role.DECLARED)
        if handler is not None:
            answers = reply or _Counted(self.omitted, command.line)
            wait = handler(command, answers)
            due, self.tower.due = self.tower.due, None
            return wait if due is None else self.run(due, answers)
        if self._probing is not None:
            wait = self._probing.wait_for(command, self)
            if wait is not None:
                return wait
        row = row_of(code)
        if row is None:
            self.omitted.count(SkippedCommand.UNKNOWN, code, command.line)
        elif row.kind is Kind.NOT_BUILT:
            self.omitted.count(SkippedCommand.NOT_BUILT, code, command.line)
        elif code in LEVELLING:
            self.omitted.count(SkippedCommand.LEVELLING, code, command.line)
        elif row.kind in (Kind.SERVED, Kind.PROBED):
            self.omitted.count(SkippedCommand.SERVED, code, command.line)
        elif row.kind is Kind.USER:
            self.omitted.count(SkippedCommand.USER, code, command.line)
            return WaitForUser(row.text)
        return None

    def tool_changed(self, tool: int) -> None:
        """Sets the temperatures and the fans for a change to this tool."""
        self.set_points.tool_changed(tool)
        self.outputs.tool_changed(tool)

    def follow_tool(self) -> None:
        """Call this when the active tool has changed without a command, because a program was
        suspended, stopped or resumed."""
        self.set_points.follow_tool()
        self.outputs.follow_tool()

    def settled(self, wait: Wait) -> None:
        """Call this when a wait of a program without consoles has ended. Raises CommandError."""
        if isinstance(wait, WaitForHoming) and not wait.letters:
            self.flow.homed()

    def expand(self, command: Command, respond: Respond, *, console: bool = False) -> None:
        """Calls a macro: its lines are the next that the job reads. See Macros.expand."""
        self.macros.expand(self._job, command, self.status(), respond, console=console)

    def status(self) -> Status:
        """The status for templates: that of the printer, or of the plan."""
        steps_mm = self.flow.babysteps_mm
        if self._status is not None:
            status = self._status()
            axes = {
                name: replace(axis, babystep_mm=axis.babystep_mm + steps_mm.get(name, 0.0))
                for name, axis in status.axes.items()
            }
            return replace(status, axes=axes)
        planned = planned_status(
            self._machine,
            self._job,
            self.file,
            self.heaters(),
            self.outputs.fans,
            self.outputs.values,
            steps_mm,
        )
        planned = replace(
            planned,
            shapers=self.filters.shaper_status(),
            advances=self.filters.advance_status(),
            fan_targets_c=dict(self.fan_targets.targets_c),
            servos_us=dict(self.servos.widths_us),
            lights={name: tuple(colors) for name, colors in self.lights.colors.items()},
            filament_sensors=self.stand_ins.filament_sensors,
            buttons=dict.fromkeys(self._machine.buttons, False),
        )
        return planned if self._probing is None else self._probing.shown(planned)

    def heaters(self) -> dict[str, HeaterStatus]:
        """The heaters of a plan. Their targets count as reached."""
        targets_c = self.set_points.targets_c
        reached = {name: targets_c.get(name, 0.0) for name in self._machine.heaters}
        return {name: HeaterStatus(c if c > 0 else None, c, 0.0) for name, c in reached.items()}

    def run_at_once(self, command: Command, reply: Reply) -> Wait | None:
        """Executes an immediate command of `DECLARED`. Raises CommandError."""
        handler = self._handler(command.code, Role.DECLARED)
        return handler(command, reply) if handler is not None else None

    def _handler(self, code: str, *roles: Role) -> Handler | None:
        for role in roles:
            if code in _METHODS[role]:
                part, method = _METHODS[role][code]
                return cast("Handler", getattr(getattr(self, part), method))
        return None

    def knows(self, command: Command) -> bool:
        """Whether a command is known, even if it has no effect here."""
        code = _key(command)
        if code == "G92.1":
            return by_interpreter(command)
        return command.letter == "T" or code == "S" or row_of(code) is not None

    def refuse(self, command: Command, error: CommandError, file: str) -> None:
        """Records a refused command of `file`, in a print that continues."""
        del file
        self.omitted.count(SkippedCommand.REFUSED, f"{command.code}: {error}", command.line)

    @property
    def machine(self) -> MachineConfig:
        """The machine that the commands are for."""
        return self._machine

    def use_geometry(self, machine: MachineConfig) -> None:
        """Replaces the machine by one with another geometry."""
        self._machine = machine
        self.flow.use_geometry(machine)

    @property
    def ended(self) -> bool:
        """Whether a command has ended the program."""
        return self.flow.ended

    @ended.setter
    def ended(self, ended: bool) -> None:
        """Ends the program, or with False lets the next one start."""
        self.flow.ended = ended

    def problem(self, path: str = "") -> Problem:
        """The error that stopped the job; `path` is the file."""
        return problem_of(self._job, path, self._machine.geometry)

    def warnings(self, file: str) -> list[str]:
        """One sentence for each code that was unknown, waited for the user or was ignored, for each
        axis with clamped targets, for skipped moves, and for a truncated file."""
        return self.omitted.warnings(file, self._clamped())

    def clamped(self, file: str) -> list[str]:
        """One sentence for each axis with clamped targets, and for skipped moves."""
        return SkippedCommands().warnings(file, self._clamped())

    def _clamped(self) -> dict[str, tuple[int, int]]:
        geometry = self._machine.geometry
        problems = [
            (problem(error, "", geometry), times) for error, times in self._job.options.clamped
        ]
        moved, left_out = "such targets were moved to the limit", "such moves were left out"
        return {
            f"{p.sentence}; {moved if p.code == 'input.out-of-range' else left_out}": (
                p.line or 0,
                times,
            )
            for p, times in problems
        }


def _key(command: Command) -> str:
    return "S" if command.letter == "S" else command.code
