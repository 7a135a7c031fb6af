"""The commands of one job that the interpreter hands out, for live and offline printing alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self, cast

from passo.errors import CommandError, Problem
from passo.gcode.command import Command
from passo.gcode.registry import Kind, Role, commands_of, row_of
from passo.printer.commands.klipper_commands import KlipperCommands
from passo.printer.commands.limits import Limits
from passo.printer.commands.motion_filters import MotionFilters
from passo.printer.commands.outputs import Outputs
from passo.printer.commands.plan import Plan, PlanAhead
from passo.printer.commands.program_flow import ProgramFlow, by_interpreter
from passo.printer.commands.set_points import Heat, NoHeat, SetPoints
from passo.printer.commands.speed_and_flow import SpeedAndFlow
from passo.printer.input_errors import problem, problem_of
from passo.printer.macros import Macros, Respond
from passo.printer.skipped_commands import SkippedCommand, SkippedCommands
from passo.printer.status import planned_status
from passo.printer.unfit_commands import ALL
from passo.printer.wait_requests import Handler, NullReply, Reply, Wait, WaitForHoming, WaitForUser

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig
    from passo.printer.status import Status

# The handlers of a job by code, as name of the part and of its method. The parts of a job belong to
# `Commands`, and must not refer to it.
_PARTS = {
    "flow": ProgramFlow,
    "set_points": SetPoints,
    "outputs": Outputs,
    "limits": Limits,
    "filters": MotionFilters,
    "factors": SpeedAndFlow,
    "klipper": KlipperCommands,
    "macros": Macros,
}
_METHODS: dict[Role, dict[str, tuple[str, str]]] = {role: {} for role in Role}
for _name, _part in _PARTS.items():
    for _code, _role, _method in commands_of(_part):
        _METHODS[_role][_code] = (_name, _method)

DECLARED = frozenset(_METHODS[Role.DECLARED])
"""The declarations of these commands are here; the others only have their handler in a program
here."""


class _Counted(NullReply):
    """Counts the notes of one command of a program, whose answers have no reader."""

    def __init__(self, omitted: SkippedCommands, line: int) -> None:
        self._omitted, self._line = omitted, line

    def note(self, about: str, text: str, *, again: bool = False) -> None:
        """Counts it."""
        self._omitted.count(SkippedCommand.REFUSED, text, self._line)


class Commands:
    """Carries out the commands that the job's interpreter hands out. One object a job; not
    thread-safe.

    Its parts are one subject each. `omitted` counts the commands that it leaves out.
    """

    @classmethod
    def of_plan(cls, machine: MachineConfig, job: _core.Job) -> Self:
        """The commands of a job that is only planned: without heat and without a board's
        outputs."""
        return cls(machine, job, NoHeat(), [1] * len(machine.timed_outputs))

    def __init__(
        self,
        machine: MachineConfig,
        job: _core.Job,
        heat: Heat,
        full_scale: list[int],
        plan: Plan | None = None,
        macros: Macros | None = None,
    ) -> None:
        """`full_scale` of each timed output; `plan`: which planned moves commands may change, by
        default none; `macros` are those of a printer: a program has its own."""
        self._machine, self._job = machine, job
        plan = plan or PlanAhead(job)
        self.omitted = SkippedCommands()
        self.macros = macros or Macros(machine)
        self.outputs = Outputs(machine, job, full_scale, plan)
        self.flow = ProgramFlow(machine, job, self.outputs, self.omitted)
        self.set_points = SetPoints(machine, job, heat)
        self.limits = Limits(machine, job, plan)
        self.filters = MotionFilters(machine, job)
        self.factors = SpeedAndFlow(machine, job, plan)
        self.klipper = KlipperCommands(machine, job)
        self.skips = ALL  # what a print without consoles may leave out

    def run(self, command: Command, reply: Reply | None = None) -> Wait | None:
        """Carries out one command in its place, or counts it as unknown; returns its wait. Without
        `reply` its notes are counted. Raises CommandError if it is refused, WordError for a word
        without a number."""
        if command.letter == "T":
            if command.minor:
                self.omitted.count(SkippedCommand.TOOL, f"T{command.number}", command.line)
            else:
                self.set_points.tool_changed(command.number)
            return None
        code = _key(command)
        command.check()
        handler = self._handler(code, Role.IN_PROGRAM, Role.DECLARED)
        if handler is not None:
            return handler(command, reply or _Counted(self.omitted, command.line))
        row = row_of(code)
        if row is None:
            self.omitted.count(SkippedCommand.UNKNOWN, code, command.line)
        elif row.kind is Kind.NOT_BUILT:
            self.omitted.count(SkippedCommand.NOT_BUILT, code, command.line)
        elif row.kind is Kind.SERVED:
            self.omitted.count(SkippedCommand.SERVED, code, command.line)
        elif row.kind is Kind.USER:
            self.omitted.count(SkippedCommand.USER, code, command.line)
            return WaitForUser(row.text)
        return None

    def settled(self, wait: Wait) -> None:
        """A wait of a program without consoles has ended. Raises CommandError."""
        if isinstance(wait, WaitForHoming) and not wait.letters:
            self.flow.homed()

    def expand(self, command: Command, respond: Respond, *, console: bool = False) -> None:
        """A macro is called: the job reads its lines next. See Macros.expand."""
        self.macros.expand(self._job, command, self.status(), respond, console=console)

    def status(self) -> Status:
        """The printer's, or that of the plan, for templates."""
        if self.macros.status is not None:
            return self.macros.status()
        targets_c, fans = self.set_points.targets_c, self.outputs.fans
        return planned_status(self._machine, self._job, targets_c, fans)

    def run_at_once(self, command: Command, reply: Reply) -> Wait | None:
        """Carries out an immediate command of `DECLARED`. Raises CommandError."""
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
        """Records a command of `file` that was not carried out, in a print that continues."""
        del file
        self.omitted.count(SkippedCommand.REFUSED, f"{command.code}: {error}", command.line)

    @property
    def machine(self) -> MachineConfig:
        """The machine that the commands are for."""
        return self._machine

    def use_geometry(self, machine: MachineConfig) -> None:
        """The machine has another geometry from now on."""
        self._machine = machine
        self.flow.use_geometry(machine)

    @property
    def ended(self) -> bool:
        """A command has ended the program."""
        return self.flow.ended

    @ended.setter
    def ended(self, ended: bool) -> None:
        self.flow.ended = ended

    def problem(self, path: str = "") -> Problem:
        """The error that the job stopped at; `path` is the file."""
        return problem_of(self._job, path, self._machine.geometry)

    def warnings(self, file: str) -> list[str]:
        """One sentence for each code that was unknown, waited for the user, or was ignored, for
        each axis whose targets were clamped to the limit, for moves that were left out, and for a
        file that was cut short."""
        return self.omitted.warnings(file, self._clamped())

    def _clamped(self) -> dict[str, tuple[int, int]]:
        geometry = self._machine.geometry
        problems = [(problem(error, "", geometry), times) for error, times in self._job.clamped]
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
