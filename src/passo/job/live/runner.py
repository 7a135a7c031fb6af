"""Prints a file: start, pause, resume, cancel."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import TYPE_CHECKING

from passo.errors import CommandError, PassoError, Problem, in_words
from passo.job.live.cooling import Cooling
from passo.job.live.file_execution import FileExecution
from passo.job.live.file_lines import FileLines
from passo.job.live.file_pause import FilePause
from passo.job.live.job_state import TRANSITIONS, JobState, States
from passo.job.live.park import Park
from passo.job.live.reader import Reader
from passo.printer.unfit_commands import Skips
from passo.printer.wait_requests import STOPS, Reply, Stop, Stopped

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)


class Runner:
    """Prints one file at a time; all consoles stay usable. Use it within the event loop of the
    printer. `reply` receives the answers to commands of the file. `file` is the selected file;
    `watchers` are called with the old and the new state. `ended` is the result of the last print of
    the selected file: done, cancelled or failed. `failed` is the reason why the last print failed,
    or empty; `problems` are its problems, if known. `run` is the run id of the last print, or
    empty: see `Runs`."""

    def __init__(self, control: Control, parts: MachineParts, reply: Reply) -> None:
        self._control, self._parts, self._reply = control, parts, reply
        self.file = FileLines(control)
        self._pause = FilePause(control, parts, reply)
        self._cooling = Cooling(control)
        self._states = States(JobState.NONE, TRANSITIONS)
        self.watchers = self._states.watchers
        self._task: asyncio.Task[None] | None = None
        self._execution = FileExecution(
            *(control, parts.outputs.laser, self.file, self._pause),
            *(self._states, reply, self.pause),
        )
        self._skips = control.skips
        self.ended = self.failed = self.run = ""
        self.problems: tuple[Problem, ...] = ()
        control.state.prints.append(lambda: self.name if self.active else None)
        control.state.stop_listeners.append(self._stopped)
        control.state.fault_listeners.append(lambda _: self.pause())

    # -- queries ------------------------------------------------------------------------

    @property
    def state(self) -> JobState:
        """The state of the selected file."""
        return self._states.now

    @property
    def name(self) -> str:
        """The name of the selected file; empty without one."""
        return self.file.name

    @property
    def path(self) -> str:
        """Its path on the card."""
        return self.file.path

    @property
    def skips(self) -> Skips:
        """What the print may do in place of a failure."""
        return self._skips

    @property
    def size(self) -> int:
        """The size of the selected file in bytes."""
        return self.file.size

    @property
    def offset(self) -> int:
        """The number of its bytes that are read and planned."""
        return self.file.offset

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
        self._put(name, path, reader, JobState.READY)
        self._rewind()

    def release(self) -> None:
        """Deselects the file. Raises CommandError during a print."""
        self._put("", "", None, JobState.NONE)

    def _put(self, name: str, path: str, reader: Reader | None, state: JobState) -> None:
        self._refuse_if_active()
        self.file.select(name, path, reader)
        self.ended = ""
        self._states.enter(state)

    def seek(self, offset: int) -> None:
        """Sets the byte from which the next `start` prints. Raises CommandError, and CardError."""
        self._refuse_if_active()
        self._seek(offset)

    def _seek(self, offset: int) -> None:
        self.file.seek(offset)
        self._cooling.forget()

    def _rewind(self) -> None:
        self.file.rewind()
        self._cooling.forget()

    @contextmanager
    def keep(self) -> Generator[Callable[[int], None]]:
        """Locks the selected file within the block, while the machine moves to the resume position.
        Yields a function that sets the byte from which to print."""
        self._refuse_if_active()
        self._pause.withdraw()
        self._states.enter(JobState.APPROACHING)
        try:
            yield self._seek
        except BaseException:
            self._pause.withdraw()
            raise
        finally:
            self._states.enter(JobState.READY)

    def start(self, *, skips: Skips | None = None, run: str = "") -> None:
        """Starts the selected file at its offset, or ends a pause. `skips` is what the print may do
        in place of a failure: by default that of the printer, and after a failed line that of the
        print. `run` is the run id of a new print. Raises CommandError."""
        if self.state is JobState.PAUSED:
            suspended = self._pause.suspended
            if suspended:
                self._pause.require_places()
            self._states.enter(JobState.RETURNING if suspended else JobState.PRINTING)
            self._pause.resumed.set()
            return
        if self.state is JobState.APPROACHING and self._pause.asked:
            self._pause.withdraw()
            return
        self._refuse_if_active()
        if self.file.reader is None:
            raise CommandError.of("job.no-file")
        if 0 < self.size <= self.offset and self.state is not JobState.FAILED:
            raise CommandError.of("job.at-end", value=self.name)
        if skips is not None or not self.stands:
            self._skips = self._control.skips if skips is None else skips.on(self._control.machine)
        if not self.stands:
            self.run = run
        self._control.dispatch.allow(self._skips)
        if self._task is not None and not self._task.done():
            self._states.enter(JobState.STARTING)
            return  # starts when the last print has released the machine
        self.failed, self.problems = "", ()
        self._execution.reset()
        pauses = self._pause.asked
        self._pause.reset()
        self._cooling.switch_on()
        # Create the task before the watchers are called; it runs only afterwards.
        task = asyncio.get_running_loop().create_task(self._print())
        task.add_done_callback(self._over)
        self._task = task  # the event loop has only a weak reference
        self._pause.resumed.clear()
        self._states.enter(JobState.PRINTING)
        if pauses:
            self.pause(self._pause.words)

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
        self._do_not_start()
        if self.state is JobState.APPROACHING and not self._pause.asked:
            self._pause.ask(words)
            text = f"{self.name} will pause once it reaches the resume point"
            self._control.state.announce(_log, logging.INFO, text)
        if self.state.prints and not self._control.state.halted:
            self._states.enter(JobState.PAUSED)
            self._pause.resumed.clear()
            self._pause.take(words, by_file=by_file, by_macro=by_macro)

    def _do_not_start(self) -> None:
        if self.state is JobState.STARTING:
            self._states.enter(JobState.READY)

    @property
    def park(self) -> Park:
        """Parks the nozzle in a pause."""
        return self._pause.park

    def is_suspended(self) -> bool:
        """True while the job is suspended, in a pause or before its end. Call it with the motion
        lock held."""
        if self.state is JobState.PAUSED:
            self._pause.suspend()
        return self.active and self._pause.suspended

    def cancel(self) -> None:
        """Ends the print: brakes to a stop, and switches heaters and fans off. The file stays
        selected, at its beginning. A failed print cannot be resumed afterwards."""
        self._do_not_start()
        control = self._control
        if not self.active:
            if self.state is JobState.APPROACHING:
                control.stops.stop_all("cancelled")
            elif self.state is JobState.FAILED and not control.state.halted:
                self._cooling.switch_off()
                self._states.enter(JobState.READY)
                self._rewind()
            return
        self.ended = "cancelled"
        self._states.enter(JobState.READY)
        if not control.state.halted:
            control.stops.stop()
            self._cooling.switch_off()
        if control.rig.job.stops.suspended:
            control.rig.job.stops.forget_suspended()
        self._pause.resumed.set()
        self._rewind()

    def _refuse_if_active(self) -> None:
        if self.engaged:
            raise CommandError.of("job.printing", value=self.name)

    # -- the print --------------------------------------------------------------------------------

    async def _print(self) -> None:
        control, execution = self._control, self._execution
        try:
            await self.file.look_through(self._skips, lambda: self.active)
            await self._cooling.warm_up()
            while self.active:
                if self.state is JobState.PAUSED:
                    await execution.wait_in_pause()
                await execution.room()
                await control.motion_lock.acquire()
                try:
                    ended = await execution.stretch()
                    # Other tasks never run within a line.
                    while not (ended or control.rig.job.program.at_boundary):
                        ended = await execution.stretch(rest_of_line=True)
                finally:
                    control.motion_lock.release()
                if ended:
                    break
        except (Stopped, PassoError) as error:
            self._fail(str(error), error.problems if isinstance(error, PassoError) else ())
        stops = self.active and bool(self.failed) and not control.state.halted
        self._end()
        if stops:
            self._cooling.until_resumed()

    def _over(self, task: asyncio.Task[None]) -> None:
        """Called when the task of a print has ended. A fault of the program must not leave heaters
        on."""
        fault = None if task.cancelled() else task.exception()
        if fault is not None:
            self.failed = f"{type(fault).__name__}: {fault}"
            self._control.stops.halt(in_words(fault), f"a fault of the program, {self.failed}")
            self._end()
        if self.state is JobState.STARTING:
            self.start(skips=self._skips, run=self.run)

    def _stopped(self, reason: str) -> None:
        """Called when the machine is stopped during the print. The plan is lost, so the file can
        only be printed from its beginning."""
        revived = self.active and bool(self._control.state.halted)  # a pause cannot resume
        if self.state.prints or revived:
            self._fail(reason)
            self._pause.reset()
            self._end()
            self._pause.resumed.set()
            self._rewind()

    def _fail(self, reason: str, problems: Sequence[Problem] = ()) -> None:
        """Sets why the print has failed. If its own M112 or M410 has stopped it, the reason is that
        line."""
        command = self._execution.command
        if command is not None and command.code in STOPS:
            problems = (Stop(command.code, command.line).problem(self.name),)
            reason = str(problems[0])
        self.failed, self.problems = reason, tuple(problems)

    def _end(self) -> None:
        control = self._control
        if not self.active:
            return  # cancelled
        self._parts.outputs.laser.off()
        self.ended = "failed" if self.failed else "done"
        if self._skips.clamp:
            for warning in control.rig.commands.clamped(self.name):
                control.state.announce(_log, logging.WARNING, warning)
        self._states.enter(JobState.FAILED if self.failed else JobState.READY)
        if self.failed:
            text = f"Print of {self.name} stopped: {self.failed}"
            problem = self.problems[0] if self.problems else None
            control.state.announce(_log, logging.WARNING, text, problem)
        else:
            control.state.tell("Done printing file")
