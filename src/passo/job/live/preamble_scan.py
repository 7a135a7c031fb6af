"""Scans a program up to a resume point to recover the state of machine and program there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from passo import _core
from passo.config.motor_roles import axis_order
from passo.errors import InputError
from passo.gcode.command import Command, numeral
from passo.job.batch.program import Settle, at_rest, read_program
from passo.job.live.journal import Program
from passo.job.live.overrides import override
from passo.job.live.reader import Reader
from passo.job.preflight import prepare, survey
from passo.printer.commands.program import Commands
from passo.printer.commands.set_points import NoHeat
from passo.printer.unfit_commands import ALL
from passo.printer.wait_requests import Reply, Wait, WaitForHoming

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_CHUNK = 1 << 16
# Settings of the printer that a plan does not have. They do not depend on the tool.
_OF_PRINTER = (
    *("M85", "M145", "M301", "M302", "M304", "M305", "M306", "M540", "M569", "M906"),
    *("M913", "M917"),
    *("M18", "M84"),  # with S
)


def _filters(commands: Commands) -> Iterator[str]:
    """The motion filters and the backlash compensation of a job as commands."""
    yield from commands.filters.lines()
    if commands.backlash.gaps_mm:
        yield commands.backlash.line()


class _Observed(Commands):
    """The commands of a plan; each is passed to `observe` first."""

    def __init__(
        self, machine: MachineConfig, job: _core.Job, observe: Callable[[Command], None]
    ) -> None:
        super().__init__(machine, job, NoHeat(), [1] * len(machine.timed_outputs))
        self._observe = observe

    def run(self, command: Command, reply: Reply | None = None) -> Wait | None:
        """Like `Commands.run`."""
        self._observe(command)
        return super().run(command, reply)


class PreambleScan:
    """Interprets the first `end` bytes of a program without motion. It starts with the settings of
    the printer and the state at the start of the print, and applies the later changes by consoles.
    `job` has the position and the modal state at the end. `settings` are commands for the printer
    settings that the program has changed, without home offsets; `homed_mm` are the home offsets at
    the last homing, `home_offset_mm` those at the end. `unhomed` are the axes at the end whose
    position only a command has set, not an endstop. Raises CardError."""

    def __init__(
        self,
        control: Control,
        parts: MachineParts,
        program: Program,
        reader: Reader,
        end: int,
        overrides: dict[str, tuple[int, float]],
    ) -> None:
        self._control, self._outputs, self._motion = control, parts.outputs, parts.motion
        self._settings, self._reader, self._end = parts.settings, reader, end
        machine = control.machine
        skips = control.skips.allowing(program.allow)
        self.job = job = _core.Job(machine.core_spec(), False, skips.clamp, skips.ignore_tools)
        reader.seek(0)
        prepare(job, survey(machine, iter(partial(reader.read, _CHUNK), b"")), "", ALL)
        self._rest = at_rest(job)
        self.commands = _Observed(machine, job, self._observe)
        self.commands.set_points.take_tool_temperatures(control.rig.commands.set_points)
        self.settings: list[str] = []
        self.home_offset_mm = dict(self._motion.offsets.home_mm)
        self.homed_mm = dict(self.home_offset_mm)
        self._known = set[str]()  # axes that were homed, and whose motors have been on since
        self._order = axis_order(machine.axes)
        self.unhomed = {self._order[axis] for axis in program.unhomed}
        self._reads = False  # the settings of the printer are applied
        self._set_up(program)
        self._lock(self.unhomed)
        self._reads = True

        def settle(wait: Wait) -> None:
            if isinstance(wait, WaitForHoming):
                self._home(wait.letters)
            else:
                self._rest(wait)

        pieces = self._pieces(
            [
                *(
                    (at, partial(override, job, self.commands, n, x))
                    for n, (at, x) in overrides.items()
                ),
                *((at, partial(self._take, *lines)) for at, lines in program.changes),
            ]
        )
        while not self._read(pieces, settle):
            pass
        held = list(_filters(control.rig.commands))
        self.settings += (line for line in _filters(self.commands) if line not in held)

    def _read(self, pieces: Iterator[bytes], settle: Settle) -> bool:
        """Reads to the end. Returns False at a failed line, at which the print was stopped and
        later continued."""
        try:
            for _ in read_program(self.job, self.commands, pieces, "", settle):
                pass
        except InputError:
            self.job.abandon()
            return False
        return True

    def _set_up(self, program: Program) -> None:
        """Applies the printer's settings that change the meaning of a program, and the start state
        of this program."""
        job = self.job
        for tool, offset in enumerate(self._control.rig.job.tools.offsets):
            for axis, mm in enumerate(offset):
                job.tools.set_offset(tool, axis, mm)
        letters = [name.upper() for name in axis_order(self._control.machine.axes)]
        zero = zip([*letters, "E"], program.program_mm, strict=False)
        words = " ".join(letter + numeral(mm) for letter, mm in zero)
        places = [f"G92 {words}"] if words else []  # G92 without words would set all axes to 0
        self._take(*self._settings.lines(), *program.modes, "G21")
        job.axes.set(list(enumerate(program.machine_mm)))
        self._take(*places, *program.modes[-1:])  # again, in the program's own units

    def _take(self, *lines: str) -> None:
        job = self.job
        job.program.select(True)
        job.options.plain = True  # a setting must not call a macro
        for line in lines:
            job.feed(line.encode() + b"\n")
            while job.advance() == _core.JobStatus.EVENT:
                wait = self.commands.run(Command(*job.event))
                if wait is not None:
                    self._rest(wait)
        job.options.plain = False
        job.program.select(False)

    def _pieces(self, changes: list[tuple[int, Callable[[], None]]]) -> Iterator[bytes]:
        """The text of the program, interrupted by the changes of consoles. A change comes after the
        text that was read before it, or at the end if more text was read: then it applies to all
        lines that were not printed."""
        self._reader.seek(0)
        at = 0
        for offset, make in sorted(changes, key=lambda change: change[0]):
            until = min(offset, self._end)
            yield from self._next(until - at)
            at = until
            make()
        yield from self._next(self._end - at)

    def _next(self, size: int) -> Iterator[bytes]:
        while size > 0 and (data := self._reader.read(min(_CHUNK, size))):
            size -= len(data)
            yield data

    def _observe(self, command: Command) -> None:
        """Records settings that only a printer has, not a plan. Raises CommandError."""
        if not self._reads:
            return
        words, motion, job = command.words(), self._motion.settings, self.job
        if command.code == "M206":
            self.home_offset_mm |= motion.home_offsets(words)
        elif command.code == "M218":
            tool, offsets = motion.tool_offset(words, job.tool)
            for axis, mm in offsets.items():
                job.tools.set_offset(tool, "XYZ".index(axis), mm)
                self.settings.append(f"M218 T{tool} {axis}{numeral(mm)}")
        elif command.code == "M92":
            own = "E" in words and "T" not in words and len(self._control.machine.extruders) > 1
            self.settings.append(f"M92 {command.text}" + (f" T{job.tool}" if own else ""))
        elif command.code in ("M18", "M84") and "S" not in words:
            motors = self._outputs.motors
            lost = motors.axes_lost(motors.named(command.text))
            self._known -= lost
            if self._control.machine.unhomed_moves == "refuse":
                self.unhomed |= lost
                self._lock(lost)
        elif command.code in _OF_PRINTER and words:
            self.settings.append(f"{command.code} {command.text}")

    def _lock(self, names: set[str]) -> None:
        """The position of these axes is unknown, so that G92 sets it."""
        for name in names:
            self.job.axes.lock(self._order.index(name), True)

    def _home(self, letters: str) -> None:
        job, machine = self.job, self._control.machine
        job.flush()
        if not machine.homing:
            job.axes.settle()
            return
        job.abandon()
        known = self._motion.homer.axes <= self._known
        goes_back = "B" in letters and "b" not in machine.axes and known
        only_lost = "O" in letters and machine.unhomed_moves == "refuse"
        names = {n for n in "xyz" if n.upper() in letters} or set("xyz")
        if only_lost:
            names -= self._known
        if names & set(machine.axes_of_arms):
            names |= set(machine.axes_of_arms)
        self._known |= names
        self.unhomed -= names
        offsets = {n: mm for n, mm in self.home_offset_mm.items() if n in names}
        self.homed_mm |= offsets
        if goes_back:
            return
        point = machine.rest_point
        job.axes.set(
            [(i, point[i] + offsets.get(n, 0.0)) for i, n in enumerate("xyz") if n in names]
        )
