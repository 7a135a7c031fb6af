"""Passes commands to their handlers, at once or in order with the moves."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from functools import partial

from passo import _core
from passo.board.ports import LinkLostError
from passo.errors import CommandError, InputError
from passo.gcode.command import Command, alone, forced
from passo.gcode.interpreter_commands import READ_FIRST
from passo.gcode.registry import Declaration, Kind, Role, When, commands_of, row_of
from passo.motion.motion_queue import MAX_QUEUED
from passo.printer.commands.klipper_commands import TRANSLATED
from passo.printer.commands.program import DECLARED
from passo.printer.live_rig import LiveRig
from passo.printer.macros import EmergencyStop
from passo.printer.needed_parts import NEEDS
from passo.printer.state import State
from passo.printer.unfit_commands import Skips, unfit
from passo.printer.wait_requests import (
    Handler,
    Reply,
    Stopped,
    Wait,
    WaitForMoves,
    WaitForProcedure,
    WaitForQueue,
    WaitForUser,
    without_effect,
)
from passo.printer.wait_runner import WaitRunner

# Kinds of commands that may have no handler, because the machine lacks a part.
_IDLE_KINDS = Kind.QUIET, Kind.SERVED, Kind.PROBED, Kind.NOT_BUILT


class Dispatch:
    """Executes the commands of several sources on one printer. Use it within one event loop.
    `immediate` has the handlers of commands that act at once, even while another source moves the
    machine. `planned` has the handlers of commands that act in order with the moves, or wait for
    standstill. The job handles all other commands. Parts may be added before the first command.
    """

    def __init__(
        self,
        rig: LiveRig,
        state: State,
        waits: WaitRunner,
        skips: Skips,
        before_line: Callable[[], None],
    ) -> None:
        self._rig, self._state, self._waits, self._skips = rig, state, waits, skips
        self._before_line = before_line  # called before a console's line or the file is read
        self.immediate: dict[str, Handler] = {}
        self.planned: dict[str, Handler] = {}
        self._from_console = False
        self._file_skips = skips  # what the print of the file may do in place of a failure
        for code in DECLARED:
            row = row_of(code)
            if row is not None and row.when is When.IMMEDIATE:
                self.immediate[code] = lambda c, r: rig.commands.run_at_once(c, r)
                self.planned[code] = lambda c, r: rig.commands.run(c, r)

    def add(self, *parts: object) -> None:
        """Registers the handlers among the methods of these parts."""
        for part in parts:
            for code, role, method in commands_of(type(part)):
                row = row_of(code)
                assert row is not None
                at_once = role is Role.DECLARED and row.when in (When.IMMEDIATE, When.AHEAD)
                (self.immediate if at_once else self.planned)[code] = getattr(part, method)

    def has(self, row: Declaration) -> bool:
        """Whether the machine has the parts that this command needs."""
        needs = NEEDS.get(row.code)
        served = row.code in self.planned or row.code in self.immediate
        return (
            not (row.kind is Kind.NOT_BUILT or row.lacks_package)
            and (served or not row.lacks)
            and (needs is None or needs(self._rig.machine))
        )

    def reset(self) -> None:
        """Call this after the boards and the job have been replaced."""
        self._from_console = False

    def act(self, command: Command, reply: Reply) -> bool:
        """Executes a command from the source `reply` if it acts at once; else returns False."""
        if self._rig.macros.calls(command.code):
            return False
        if self.sets_meanwhile(command):
            self._set_meanwhile(command, reply)
            return True
        handler, row = self.immediate.get(command.code), row_of(command.code)
        in_order = (
            row is not None and row.only_during_print and not self._state.is_other_source(reply)
        )
        if in_order or (handler is None and not forced(command)):
            return False
        if not alone(command):
            return False  # they act in order with the moves
        handler = handler or self.planned.get(command.code)
        self._carried_out(handler, command, reply)
        return True

    def overtakes(self, command: Command) -> bool:
        """Whether the command acts at once, so that it need not wait for lines that were sent
        before."""
        if self._rig.macros.calls(command.code):
            return False
        row = row_of(command.code)
        at_once = row is not None and row.when in (When.IMMEDIATE, When.AHEAD)
        return at_once or forced(command) or self.sets_meanwhile(command)

    def sets_meanwhile(self, command: Command) -> bool:
        """Whether the command only sets heaters or fans, while a command of another source moves
        the machine by itself, as for a probing or a measurement: then nothing has to wait."""
        row = row_of(command.code)
        if row is None or not self._waits.in_procedure or self._rig.macros.calls(row.code):
            return False
        if row.code in TRANSLATED:
            return True
        return row.forced and alone(command) and ("F" not in command.letters() or forced(command))

    def _set_meanwhile(self, command: Command, reply: Reply) -> None:
        try:
            numbered = self._rig.commands.klipper.numbered(command)
        except CommandError as error:
            reply.fail(str(error), error.problems)
            return
        for one in numbered:
            self._carried_out(None, Command.call(one.code, **one.values, F=True), reply)

    def answers_halted(self, code: str) -> bool:
        """Whether a halted printer executes such a command. It must act at once, not change the
        plan, and not rearm the fault that has halted the printer. M999 rearms it, with the heaters
        off."""
        row = row_of(code)
        return code in self.immediate and row is not None and row.while_halted

    # -- lines of consoles ------------------------------------------------------------------------

    def has_room(self) -> bool:
        """Whether a planned line can be read now, without a wait. Call it with the motion lock
        held."""
        rig, state = self._rig, self._state
        lost = rig.queue.interrupted and not state.halted  # a suspended plan must resume first
        if state.host_paused or lost or not rig.job.program.at_boundary:
            return False
        # During a print the plan is always full, and a line is appended to it anyway.
        return rig.job.plan.queued <= MAX_QUEUED if state.busy() else not rig.queue.full

    async def room(self) -> bool:
        """Waits until a planned line can be read. Call it with the motion lock held. Returns True
        if M108 has ended the wait; then the line is read even if the plan is full, and the first
        wait of the line ends too."""
        return await self._waits.room(self.has_room)

    def take_line(self, text: str, reply: Reply) -> Wait | None:
        """Reads a line of a console, up to its end or to a command that waits. Then it returns the
        wait, and `finish` continues the line. Call it with the motion lock held, while `has_room`
        is True."""
        return self._take(lambda: self._feed(text), reply)

    def take_call(self, command: Command, reply: Reply) -> Wait | None:
        """As `take_line`, for a command that a program calls with values. Only what the core
        carries out itself, and a macro, become text."""
        code = command.code
        row = row_of(code)
        handled = row is not None and row.kind is not Kind.MOTION and code not in READ_FIRST
        if not handled or self._rig.macros.calls(code):
            return self.take_line(f"{code} {command.text}", reply)

        def run() -> Wait | None:
            self.select(console=True)
            try:
                wait = self.run_command(command, reply)
            finally:
                self._rig.queue.after_moves()
            self._rig.commands.ended = False  # a command of a console must not end the program
            return wait

        return self._take(run, reply)

    def take_template(self, name: str, text: str, reply: Reply) -> Wait | None:
        """Runs the template `text` of the machine file, at its key `name`, in the way `take_line`
        runs a line. Raises CommandError if the template fails."""

        def insert() -> None:
            self.select(console=True)
            self._rig.job.program.insert(self._lines(name, text, reply))

        return self._take(insert, reply)

    async def run_apart(self, name: str, text: str, reply: Reply) -> None:
        """Runs the template `text` of the machine file, at its key `name`, in the middle of a
        command, which goes on at its end. A failure goes to `reply`. Raises as `finish`, and
        CommandError if the template fails."""
        program, console = self._rig.job.program, self._from_console
        program.insert_apart(self._lines(name, text, reply))
        try:
            while (wait := self._go_on(reply)) is not None:
                await self._waits.wait(wait, reply)
                self.select(console=console)
        finally:
            program.leave_apart()

    async def finish_macro(self, reply: Reply) -> None:
        """Executes the rest of a macro that a suspended job has handed over. Call it with the
        motion lock held. Raises as `finish`."""
        self.select(console=True)
        await self.finish(self._go_on(reply), reply)

    def _take(self, begin: Callable[[], Wait | None], reply: Reply) -> Wait | None:
        self._tell_of_line(done=False)
        job = self._rig.job
        before = job.plan.queued, job.clock
        wait = begin() or self._go_on(reply)
        self._tell_of_line(done=True)
        if not self._state.busy() and (job.plan.queued, job.clock) != before:
            self._state.program = reply
        return wait

    def take_setting(self, text: str, reply: Reply) -> None:
        """Executes one line of stored settings. Call it with the motion lock held and the machine
        idle."""
        self._rig.job.options.plain = True  # a setting must not call a macro
        try:
            self._settle_line(text, reply)
        finally:
            self._rig.job.options.plain = False

    def _settle_line(self, text: str, reply: Reply) -> None:
        self._feed(text)
        wait = self._go_on(reply)
        while wait is not None:
            then = wait.then if isinstance(wait, WaitForMoves) else None
            then = wait.setting if isinstance(wait, WaitForProcedure) else then
            if then is not None:
                self._rig.queue.flush()
                try:
                    then()
                except CommandError as error:
                    reply.fail(str(error), error.problems)
            wait = self._go_on(reply)

    async def finish(
        self,
        wait: Wait | None,
        reply: Reply,
        *,
        first_ends: bool = False,
        all_end: Callable[[], bool] = lambda: False,
    ) -> None:
        """Runs `wait` and then the rest of its line. With `first_ends` the first wait ends as soon
        as it begins, with `all_end` every wait does. Raises Stopped or MachineError."""
        try:
            while wait is not None:
                await self._waits.wait(wait, reply, ends=first_ends or all_end())
                if isinstance(wait, WaitForUser) and all_end():
                    raise Stopped("no user has confirmed it")
                first_ends = False
                self.select(console=True)
                wait = self._go_on(reply)
                self._tell_of_line(done=True)
        except Exception:
            self._forget_line()  # the rest of the line would block all other sources
            raise

    def _forget_line(self) -> None:
        """Discards the rest of a console's line, and of the macros that it has called."""
        self._rig.job.abandon()
        self._rig.job.program.forget_macros()

    def _expanded(self, command: Command, reply: Reply) -> bool:
        """Expands a macro that a console calls. Returns False if that fails, after it has reported
        the error to the console."""
        try:
            self.expand(command, reply)
        except CommandError as error:
            reply.fail(str(error), error.problems)
            return False
        return True

    def expand(self, command: Command, reply: Reply) -> None:
        """Calls a macro: its lines are the next that the job reads. Raises CommandError if the
        template fails."""
        try:
            self._rig.commands.expand(
                command, lambda text: _respond(reply, text), console=self._from_console
            )
        except EmergencyStop as stop:
            raise self._halted_by(stop, command.code, reply) from None

    def _lines(self, name: str, text: str, reply: Reply) -> bytes:
        """The lines of a template of the machine file. Raises CommandError if it fails."""
        commands = self._rig.commands
        try:
            lines = commands.macros.rendered(
                name, text, commands.status(), lambda answer: _respond(reply, answer)
            )
        except EmergencyStop as stop:
            raise self._halted_by(stop, name, reply) from None
        return lines.encode("utf-8", "surrogateescape")

    def _halted_by(self, stop: EmergencyStop, name: str, reply: Reply) -> CommandError:
        """Halts the printer, as M112 does. Returns the error that names the template."""
        halt = Command(0, "M", 112, 0, "", "")
        self._carried_out(self.planned.get("M112"), halt, reply)
        return CommandError.of("macro.raised", axis=name, value=str(stop))

    def _feed(self, text: str) -> None:
        self.select(console=True)
        self._rig.job.feed(text.encode("utf-8", "surrogateescape") + b"\n")

    def _tell_of_line(self, *, done: bool) -> None:
        for listener in self._state.line_listeners:
            listener(done)

    # -- the file, and lines of consoles during it
    # --------------------------------------------------

    def select(self, *, console: bool) -> None:
        """Selects whether the next text comes from a console or from the file."""
        self._from_console = console
        job = self._rig.job
        job.program.select(console)
        job.options.clamp = self._file_skips.clamp and not console
        job.options.ignore_tools = self._file_skips.ignore_tools and not console
        self._before_line()

    def allow(self, skips: Skips) -> None:
        """Sets what the print of the file may do in place of a failure. It does not concern
        consoles."""
        self._file_skips = skips

    @property
    def in_console_line(self) -> bool:
        """Whether a line of a console is in progress, not one of the file."""
        return self._from_console and not self._rig.job.program.at_boundary

    @contextmanager
    def file_selected(self) -> Generator[_core.Job]:
        """Within the block, queries and restarts of the job concern the text of the file. Do not
        read lines within the block, because a line of a console may be in progress."""
        self._rig.job.program.select(False)
        try:
            yield self._rig.job
        finally:
            self._rig.job.program.select(self._from_console)

    def run_command(self, command: Command, reply: Reply) -> Wait | None:
        """Executes a command that the interpreter does not handle itself."""
        self._rig.queue.before_moves()
        handler = self.planned.get(command.code) or self.immediate.get(command.code)
        row = row_of(command.code)
        in_turn = row is not None and row.in_turn and not self._from_console
        # a file is read ahead, so wait for the moves before the command
        if handler is not None and in_turn:
            return WaitForMoves(partial(self._carried_out, handler, command, reply))
        surveyed = self._from_console or self._rig.job.program.macro_depth == 0
        if not surveyed and (problem := unfit(command, self._file_skips)):
            raise InputError([problem])
        wait = self._carried_out(handler, command, reply, in_file=not self._from_console)
        if self._from_console and (problem := unfit(command, self._skips)):
            lacks = row.lacks if row is not None else ""
            unknown = lacks or f'Unknown command: "{command.code}"'
            levels = problem.code == "input.no-levelling"
            reply.fail(problem.sentence if levels else unknown)
            return wait
        if handler is None:
            self._note(command, row, reply)
        return wait

    def _carried_out(
        self, handler: Handler | None, command: Command, reply: Reply, *, in_file: bool = False
    ) -> Wait | None:
        """Executes a command with `handler`, if there is one, or with the job's handler."""
        try:
            if handler is None:
                wait = self._rig.commands.run(command, reply)
            else:
                command.check(self._rig.machine, in_file=in_file)
                _require_package(command.code)
                wait = handler(command, reply)
        except (CommandError, LinkLostError) as error:
            reply.fail(str(error), error.problems)
            return None
        for listener in self._state.command_listeners:
            listener(command, reply)
        return wait

    def _note(self, command: Command, row: Declaration | None, reply: Reply) -> None:
        """Reports why a command without a handler has no effect. Macros that are written for other
        printers continue; for a script that sends the line itself it is an error. Numbered codes
        that change no print are a note there, too, because hosts send them to every printer."""
        itself = self._from_console and self._rig.job.program.macro_depth == 0
        if row is None:
            if not self._rig.commands.knows(command):
                reply.say(f'echo:Unknown command: "{command.code}"')
        elif row.kind in _IDLE_KINDS:
            why = row.lacks or row.text
            if itself and (row.kind is not Kind.QUIET or command.keyed):
                reply.no_part(row.code, why)
            else:
                reply.note(row.code, without_effect(row.code, why))

    def _go_on(self, reply: Reply) -> Wait | None:
        rig, status = self._rig, _core.JobStatus
        rig.queue.before_moves()
        try:
            while True:
                found = rig.job.advance()
                if found == status.MACRO:
                    if not self._expanded(Command(*rig.job.event), reply):
                        self._forget_line()
                        return None
                elif found == status.EVENT:
                    wait = self.run_command(Command(*rig.job.event), reply)
                    rig.commands.ended = False  # a command of a console must not end the program
                    if wait is not None:
                        return wait
                elif found == status.ERROR:
                    problem = rig.commands.problem()
                    reply.fail(str(problem), [problem])
                    self._forget_line()
                    return None
                else:
                    return WaitForQueue() if found == status.FULL else None
        except Exception:
            self._forget_line()
            raise
        finally:
            rig.queue.after_moves()


def _require_package(code: str) -> None:
    """Raises CommandError if a command needs a Python package that is not installed."""
    row = row_of(code)
    if row is not None and row.lacks_package:
        raise CommandError.of("command.no-package", axis=code, value=row.package)


def _respond(reply: Reply, text: str) -> None:
    """Sends the answer of a macro with Klipper's prefix."""
    for line in text.splitlines():
        reply.say(f"// {line}")
