"""Prints a file: start, pause, resume, cancel."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo import _core
from passo.config.motor_roles import axis_order
from passo.errors import CardError, CommandError, InputError, PassoError, Problem, in_words
from passo.gcode.command import Command
from passo.job.live.cooling import Cooling
from passo.job.live.job_state import TRANSITIONS, JobState
from passo.job.live.line_offsets import line_of_offset
from passo.job.live.park import Park
from passo.job.live.reader import Reader
from passo.job.loops import LOOPS, Loops, Place
from passo.job.preflight import prepare, survey_in_pieces
from passo.motion.motion_queue import TICK_S
from passo.printer.input_errors import problem_of
from passo.printer.unfit_commands import Skips
from passo.printer.wait_requests import (
    STOPS,
    Reply,
    Stop,
    Stopped,
    Wait,
    WaitForTemperatures,
    WaitForUser,
)

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)

_CHUNK = 1 << 14  # bytes read at a time
_AS_IT_IS = "print it as it is (M24 U1)"
_ADVICE = f"Change the file, or {_AS_IT_IS}"
_AHEAD_S = 4.0  # maximum planned print time in one step
_MAX_MESSAGES = 4096  # maximum messages for the board in one step


class Runner:
    """Prints one file at a time; all consoles stay usable. Use it within the event loop of the
    printer. `reply` receives the answers to commands of the file."""

    def __init__(self, control: Control, parts: MachineParts, reply: Reply) -> None:
        self._control, self._parts, self._reply = control, parts, reply
        self.park = Park(control, parts)
        self._cooling = Cooling(control)
        self.loops = Loops()
        self._park_words: Mapping[str, float] = {}
        self._macro_parks = False  # the macro that has paused the print parks the nozzle
        self._reader: Reader | None = None
        self._task: asyncio.Task[None] | None = None
        self._resumed = asyncio.Event()
        self.first_line = 1  # number of the first line that was fed
        self._begin = 0  # offset of the first byte that was fed since the restart of the source
        self._suspended = False  # the rest of the print is suspended, in a pause or until its end
        # the rest of the macro that asked for the pause has to run during it
        self._macro_left = False
        self._waits_for: Wait | None = None  # the unfinished wait of the last command
        self._command: Command | None = None  # the command of the file that is being carried out
        self._parked = False
        self._locked = set[int]()  # axes that were not homed when the pause began
        self._again = False  # start again as soon as the last print has ended
        self._failed = ""
        self.problems: tuple[Problem, ...] = ()  # problems of the last print, if known
        self._pauses = False  # a print that is APPROACHING will pause as soon as it resumes
        self._skips = control.skips
        # the job that has the sub-programs of this file
        self._surveyed: tuple[Reader, _core.Job] | None = None
        self._state = JobState.NONE
        # called with the old and the new state
        self.watchers: list[Callable[[JobState, JobState], None]] = []
        self.name = self.path = ""
        self.ended = ""  # result of the last print of the selected file: done, cancelled or failed
        control.state.prints.append(lambda: self.name if self.active else None)
        control.state.stop_listeners.append(self._stopped)
        control.state.fault_listeners.append(lambda _: self.pause())

    @property
    def state(self) -> JobState:
        """The state of the selected file."""
        return self._state

    def _enter(self, state: JobState) -> None:
        """Changes the state and notifies all watchers; does nothing if the state stays the same."""
        was = self._state
        if state is was:
            return
        if state not in TRANSITIONS[was]:
            raise RuntimeError(f"a print does not go from {was.name} to {state.name}")
        self._state = state
        for watcher in self.watchers:
            watcher(was, state)

    # -- queries ------------------------------------------------------------------------

    @property
    def reader(self) -> Reader | None:
        """The selected file."""
        return self._reader

    @property
    def skips(self) -> Skips:
        """What the print may do in place of a failure."""
        return self._skips

    @property
    def failed(self) -> str:
        """The reason why the last print failed; empty if it did not."""
        return self._failed

    @property
    def size(self) -> int:
        """The size of the selected file in bytes."""
        return self._reader.size if self._reader else 0

    @property
    def offset(self) -> int:
        """The number of its bytes that are read and planned."""
        with self._control.dispatch.file_selected() as job:
            return self._begin + job.program.offset

    @property
    def progress(self) -> float | None:
        """The fraction of the print that is done, 0 to 1; None if no print is running."""
        return self.offset / self.size if self.active and self.size else None

    def printing_from(self, reply: Reply) -> bool:
        """Whether a command comes from the file that is being printed."""
        return self.state.prints and reply is self._reply

    @property
    def active(self) -> bool:
        """Whether a print is running or paused."""
        return self.state.active

    @property
    def engaged(self) -> bool:
        """Whether a print is running, paused, or about to resume."""
        return self.active or self.state is JobState.APPROACHING

    @property
    def over(self) -> bool:
        """Whether no print is running or paused, and no failed print can be resumed."""
        return not (self.engaged or self.state is JobState.FAILED)

    @property
    def stands(self) -> bool:
        """Whether the print has stopped because a line or the card failed, and can be continued."""
        return self.state is JobState.FAILED and self.offset > 0

    # -- actions -------------------------------------------------------------------------

    def select(self, name: str, path: str, reader: Reader) -> None:
        """Selects the file to print next; `path` is its path on the card. Raises CommandError
        during a print."""
        self._refuse_if_active()
        self._again = False
        if self._reader:
            self._reader.close()
        self.name, self.path, self._reader, self.ended = name, path, reader, ""
        self._enter(JobState.READY)
        self._rewind(0)

    def release(self) -> None:
        """Deselects the file. Raises CommandError during a print."""
        self._refuse_if_active()
        self._again = False
        if self._reader:
            self._reader.close()
        self.name, self.path, self._reader, self.ended = "", "", None, ""
        self._enter(JobState.NONE)

    def exchange(self, reader: Reader) -> None:
        """Continues to read the same file with a new reader, after its card was mounted again."""
        assert self._reader is not None
        reader.seek(self._reader.tell())
        self._reader.close()
        if self._surveyed is not None and self._surveyed[0] is self._reader:
            self._surveyed = reader, self._surveyed[1]
        self._reader = reader

    def seek(self, offset: int) -> None:
        """Sets the byte from which the next `start` prints. Raises CommandError, and CardError."""
        self._refuse_if_active()
        self._seek(offset)

    def _seek(self, offset: int) -> None:
        if self._reader is None:
            raise CommandError.of("job.no-file")
        offset = min(max(offset, 0), self._reader.size)
        self._rewind(offset, line_of_offset(self._reader, offset))

    @contextmanager
    def keep(self) -> Generator[Callable[[int], None]]:
        """Locks the selected file within the block, while the machine moves to the resume position.
        Yields a function that sets the byte from which to print."""
        self._refuse_if_active()
        self._pauses = False
        self._enter(JobState.APPROACHING)
        try:
            yield self._seek
        except BaseException:
            self._pauses = False
            raise
        finally:
            self._enter(JobState.READY)

    def start(self, *, skips: Skips | None = None) -> None:
        """Starts the selected file at its offset, or ends a pause. `skips` is what the print may do
        in place of a failure: by default that of the printer, and after a failed line that of the
        print. Raises CommandError."""
        if self.state is JobState.PAUSED:
            if self._suspended:
                self._require_places()
            self._enter(JobState.RETURNING if self._suspended else JobState.PRINTING)
            self._resumed.set()
            return
        if self.state is JobState.APPROACHING and self._pauses:
            self._pauses = False
            return
        self._refuse_if_active()
        if self._reader is None:
            raise CommandError.of("job.no-file")
        if 0 < self.size <= self.offset and self.state is not JobState.FAILED:
            raise CommandError.of("job.at-end", value=self.name)
        if skips is not None or not self.stands:
            self._skips = self._control.skips if skips is None else skips.on(self._control.machine)
        self._control.dispatch.allow(self._skips)
        self._again = self._task is not None and not self._task.done()
        if self._again:
            return  # starts when the cancelled print has released the machine
        self._failed = ""
        self.problems = ()
        self._command = None
        self._suspended = False
        self._waits_for = None
        self._cooling.switch_on()
        # Create the task before the watchers are called; it runs only afterwards.
        task = asyncio.get_running_loop().create_task(self._print())
        task.add_done_callback(self._over)
        self._task = task  # the event loop has only a weak reference
        self._resumed.clear()
        self._enter(JobState.PRINTING)
        if self._pauses:
            self._pauses = False
            self.pause(self._park_words)

    def pause(
        self,
        words: Mapping[str, float] = MappingProxyType({}),
        *,
        by_file: bool = False,
        by_macro: bool = False,
    ) -> None:
        """Brakes to a stop on the path at once; `start` resumes from there. `words` are those of
        `Park.leave`. A print that is approaching its resume position pauses when it has reached it.
        `by_file`: a command of the file requests the pause. If the command is in a macro, the rest
        of the macro runs during the pause. `by_macro`: see `Park.leave`."""
        self._again = False
        if self.state is JobState.APPROACHING and not self._pauses:
            self._pauses, self._park_words = True, words
            text = f"{self.name} will pause once it reaches the resume point"
            self._control.state.announce(_log, logging.INFO, text)
        if self.state.prints and not self._control.state.halted:
            self._park_words, self._macro_parks = words, by_macro
            self._enter(JobState.PAUSED)
            self._resumed.clear()
            # Homing is not interrupted, because its moves are not those of the program.
            if not self._parts.motion.homer.active:
                self._suspend(hand_over_macro=by_file)
                self._macro_left = by_file

    def _suspend(self, *, hand_over_macro: bool = False) -> None:
        """Brakes and suspends the rest of the print, unless it is still suspended from the last
        pause."""
        if not self._suspended:
            self._suspended = True
            self._parked = False
            self.park.owed_mm = 0.0
            self._locked = set(self._control.rig.job.locked_axes)
            if self._control.dispatch.in_console_line:
                self._control.rig.job.abandon()  # the suspended rest does not belong to the print
            self._parts.suspension.suspend(hand_over_macro=hand_over_macro)

    def _require_places(self) -> None:
        """Raises CommandError if an axis that was homed when the pause began is not homed any
        more."""
        if lost := set(self._control.rig.job.locked_axes) - self._locked:
            axis = axis_order(self._control.machine.axes)[min(lost)].upper()
            raise CommandError.of("input.not-homed", axis=axis)

    def is_suspended(self) -> bool:
        """True while the job is suspended, in a pause or before its end. Call it with the motion
        lock held."""
        if self.state is JobState.PAUSED:
            self._suspend()
        return self.active and self._suspended

    def cancel(self) -> None:
        """Ends the print: brakes to a stop, and switches heaters and fans off. The file stays
        selected, at its beginning. A failed print cannot be resumed afterwards."""
        self._again = False
        control = self._control
        if not self.active:
            if self.state is JobState.APPROACHING:
                control.stops.stop_all("cancelled")
            elif self.state is JobState.FAILED and not control.state.halted:
                self._cooling.switch_off()
                self._enter(JobState.READY)
                self._rewind(0)
            return
        self.ended = "cancelled"
        self._enter(JobState.READY)
        if not control.state.halted:
            control.stops.stop()
            self._cooling.switch_off()
        if control.rig.job.stops.suspended:
            control.rig.job.stops.forget_suspended()
        self._resumed.set()
        self._rewind(0)

    def _refuse_if_active(self) -> None:
        if self.engaged:
            raise CommandError.of("job.printing", value=self.name)

    def _rewind(self, offset: int, line: int = 1) -> None:
        with self._control.dispatch.file_selected() as job:
            job.program.restart(line)
        self._begin, self.first_line = offset, line
        self._cooling.forget()
        self.loops.forget()
        if self._reader:
            self._reader.seek(offset)

    def _go_back(self, place: Place) -> None:
        """Continues to read the file there; modes and plan stay."""
        self._control.rig.job.program.restart(place.line)
        self._begin = place.offset
        assert self._reader is not None
        self._reader.seek(place.offset)

    # -- the print --------------------------------------------------------------------------------

    async def _print(self) -> None:
        control = self._control
        try:
            await self._look_through()
            await self._cooling.warm_up()
            while self.active:
                if self.state is JobState.PAUSED:
                    await self._pause_print()
                await self._room()
                await control.motion_lock.acquire()
                try:
                    ended = await self._stretch()
                    # Other tasks never run within a line.
                    while not (ended or control.rig.job.program.at_boundary):
                        ended = await self._stretch(rest_of_line=True)
                finally:
                    control.motion_lock.release()
                if ended:
                    break
        except (Stopped, PassoError) as error:
            self._fail(str(error), error.problems if isinstance(error, PassoError) else ())
        stops = self.active and bool(self._failed) and not control.state.halted
        self._end()
        if stops:
            self._cooling.until_resumed()

    async def _look_through(self) -> None:
        """Scans the file for its sub-programs. Raises InputError, before any move, for a file that
        must not be printed."""
        reader, at = self._reader, self._reader.tell() if self._reader else 0
        if reader is None:
            return
        begins, job = self.offset == 0, self._control.rig.job
        if not begins and self._surveyed == (reader, job):
            return  # the print continues after a failed line
        try:
            found = await survey_in_pieces(self._control.machine, reader, lambda: self.active)
        except CardError as error:
            raise CardError(self._placed(error, 1)) from None
        finally:
            if reader is self._reader:
                reader.seek(at)
        if not self.active:
            return
        self._surveyed = reader, job
        wrong = prepare(job, found, self.name, self._skips)
        if begins and wrong:
            first, *others = (replace(problem, hint=_advice(problem)) for problem in wrong)
            for problem in others:
                self._control.state.announce(_log, logging.WARNING, str(problem), problem)
            raise InputError([first])

    def _over(self, task: asyncio.Task[None]) -> None:
        """Called when the task of a print has ended. A fault of the program must not leave heaters
        on."""
        fault = None if task.cancelled() else task.exception()
        if fault is not None:
            self._failed = f"{type(fault).__name__}: {fault}"
            self._control.stops.halt(in_words(fault), f"a fault of the program, {self._failed}")
            self._end()
        if self._again:
            self.start(skips=self._skips)

    def _stopped(self, reason: str) -> None:
        """Called when the machine is stopped during the print. The plan is lost, so the file can
        only be printed from its beginning."""
        revived = self.active and bool(self._control.state.halted)  # a pause cannot resume
        if self.state.prints or revived:
            self._fail(reason)
            self._suspended = False
            self._end()
            self._resumed.set()
            self._rewind(0)

    def _fail(self, reason: str, problems: Sequence[Problem] = ()) -> None:
        """Sets why the print has failed. If its own M112 or M410 has stopped it, the reason is that
        line."""
        command = self._command
        if command is not None and command.code in STOPS:
            problems = (Stop(command.code, command.line).problem(self.name),)
            reason = str(problems[0])
        self._failed, self.problems = reason, tuple(problems)

    def _end(self) -> None:
        control = self._control
        if not self.active:
            return  # cancelled
        self._parts.outputs.laser.off()
        self.ended = "failed" if self._failed else "done"
        if self._skips.clamp:
            for warning in control.rig.commands.clamped(self.name):
                control.state.announce(_log, logging.WARNING, warning)
        self._enter(JobState.FAILED if self._failed else JobState.READY)
        if self._failed:
            text = f"Print of {self.name} stopped: {self._failed}"
            problem = self.problems[0] if self.problems else None
            control.state.announce(_log, logging.WARNING, text, problem)
        else:
            control.state.tell("Done printing file")

    async def _pause_print(self) -> None:
        """Parks the nozzle, and waits until the pause has ended."""
        control = self._control
        await control.motion_lock.acquire()
        try:
            if self.state is JobState.PAUSED:
                self._suspend()
                if not self._parked:
                    self._parked = True
                    await self.park.leave(self._park_words, by_macro=self._macro_parks)
        finally:
            control.motion_lock.release()
        await self._resumed.wait()

    async def _room(self) -> None:
        """Waits until there is space in the plan."""
        control, queue = self._control, self._control.rig.queue
        await queue.until(
            lambda: (
                not (queue.full or control.state.host_paused or queue.interrupted)
                or not self.state.prints
                or bool(control.state.halted)
            ),
            idly=True,
        )

    async def _stretch(self, *, rest_of_line: bool = False) -> bool:
        """Plans as far ahead as useful. Returns True at the end of the file. Call it with the
        motion lock held."""
        control = self._control
        job, queue = control.rig.job, control.rig.queue
        control.state.raise_if_halted()
        if self.state is JobState.PAUSED:
            self._suspend()
        if not self.state.prints:
            return False
        if self.state is JobState.RETURNING and not await self._come_back():
            return False
        control.dispatch.select(console=False)
        control.state.program = self._reply
        if self._waits_for is not None:
            return await self._wait()
        queue.before_moves()
        try:
            horizon = queue.now + _AHEAD_S * queue.hz
            found = job.advance(horizon, _MAX_MESSAGES, rest_of_line)
        finally:
            queue.after_moves()
        if found == _core.JobStatus.FULL and not rest_of_line and not queue.full:
            await asyncio.sleep(TICK_S)  # the link is slower than the planner
        return await self._answer(found)

    async def _come_back(self) -> bool:
        """Ends a pause. Returns False if the print pauses again. If the nozzle cannot return, the
        print stays paused until the user has removed the cause."""
        control = self._control
        try:
            self._require_places()
            await self.park.come_back()
        except CommandError as error:
            if self.active:
                text = f"Print of {self.name} stays paused: {error}"
                control.state.announce(_log, logging.WARNING, text, error.problems[0])
                self._resumed.clear()
                self._enter(JobState.PAUSED)
            return False
        self._parked = False
        if self.state is not JobState.RETURNING:
            return False
        self._suspended = False
        self._enter(JobState.PRINTING)
        self._parts.suspension.resume()
        return True

    async def _answer(self, found: _core.JobStatus) -> bool:
        """Handles the reason why the interpreter stopped."""
        control, job = self._control, self._control.rig.job
        status = _core.JobStatus
        if found == status.NEED_INPUT:
            assert self._reader is not None
            try:
                data = self._reader.read(_CHUNK)
            except CardError as error:
                # the error is in the next line
                raise CardError(self._placed(error, job.line + 1)) from None
            if data:
                job.feed(data)
            else:
                job.finish()
            await asyncio.sleep(0)  # long parts without moves: skipped objects, comments
        elif found == status.MACRO:
            command = Command(*job.event)
            try:
                control.dispatch.expand(command, self._reply)
            except CommandError as error:
                raise InputError(self._placed(error, command.line)) from None
            await asyncio.sleep(0)  # a macro may run for long without moves
        elif found == status.EVENT:
            command = self._command = Command(*job.event)
            try:
                if command.code in LOOPS:
                    depth = job.program.macro_depth + job.program.subprogram_depth
                    back = self.loops.take(command, self._begin + job.program.offset, depth)
                    if back is not None:
                        self._go_back(back)
                    await asyncio.sleep(0)  # the loop may have no move
                    return False
                self._waits_for = control.dispatch.run_command(command, self._reply)
            except (InputError, CommandError) as error:
                raise InputError(self._placed(error, command.line)) from None
            return await self._wait()
        elif found == status.ERROR:
            problem = problem_of(job, self.name, control.machine.geometry)
            job.abandon()
            raise CommandError([problem])
        elif found == status.END:
            return await self._finish()
        return False

    async def _wait(self) -> bool:
        """Waits for the condition of the last command. If a pause suspends the moves before it, the
        wait is repeated later. Returns True at the end of the program."""
        control = self._control
        wait = self._waits_for
        if wait is not None:
            try:
                if not await control.waits.wait(
                    wait, self._reply, suspended=lambda: self._suspended
                ):
                    return False
            except CommandError as error:
                heaters = wait.heaters if isinstance(wait, WaitForTemperatures) else ()
                heaters = (
                    tuple(control.machine.heaters) if isinstance(wait, WaitForUser) else heaters
                )
                if not self._pauses_for(heaters):
                    raise
                text = f"Print of {self.name} is paused: {error}"
                control.state.announce(_log, logging.WARNING, text, error.problems[0])
                self.pause()
                return False  # the wait is repeated after the pause
            self._waits_for = None
            await self._finish_macro()
        self._command = None
        if control.rig.commands.ended:
            control.rig.commands.ended = False
            return await self._finish()
        return False

    async def _finish_macro(self) -> None:
        """Executes the rest of the macro that has requested a pause. Call it with the motion lock
        held."""
        left, self._macro_left = self._macro_left, False
        if not left:
            return
        try:
            await self._control.dispatch.finish_macro(self._reply)
        except PassoError as error:
            text = f"{self.name} is paused, but its macro is not carried out to its end: {error}"
            self._control.state.announce(_log, logging.WARNING, text, error.problems[0])

    def _pauses_for(self, heaters: Sequence[str]) -> bool:
        """Whether one of these heaters has failed and its policy is to pause the print."""
        control = self._control
        return any(
            control.rig.connection.heaters[name].fault is not None
            and control.machine.heaters[name].on_fault == "job"
            for name in heaters
        )

    def _placed(self, error: PassoError, line: int) -> list[Problem]:
        """The error with the line of the file."""
        return [replace(p, file=self.name, line=line) for p in error.problems]

    async def _finish(self) -> bool:
        """Waits until the last moves are done, and then switches the laser off. A pause during
        these moves still takes effect."""
        queue = self._control.rig.queue
        self._parts.outputs.laser.off()
        queue.flush()
        await queue.until(
            lambda: (
                queue.standing
                or self.state is not JobState.PRINTING  # the pause may have ended in the meantime
                or bool(self._control.state.halted)
            )
        )
        self._control.state.raise_if_halted()
        return self.state is JobState.PRINTING


def _advice(problem: Problem) -> str:
    if problem.code == "input.no-macro":
        return f"{problem.entry.action}, or {_AS_IT_IS}"
    return _ADVICE
