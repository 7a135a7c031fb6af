"""Executes the lines of a print from a file, a stretch at a time."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from passo import _core
from passo.errors import CommandError, InputError
from passo.gcode.command import Command
from passo.job.live.file_lines import FileLines
from passo.job.live.file_pause import FilePause
from passo.job.live.job_state import JobState, States
from passo.motion.motion_queue import TICK_S
from passo.printer.input_errors import problem_of
from passo.printer.wait_requests import Reply, Wait, WaitForTemperatures, WaitForUser

if TYPE_CHECKING:
    from passo.printer.control import Control
    from passo.printer.laser import Laser

_log = logging.getLogger(__name__)

_AHEAD_S = 4.0  # maximum planned print time in one step
_MAX_MESSAGES = 4096  # maximum messages for the board in one step


class FileExecution:
    """Executes the lines of `file`, whose state is in `states`. `pause_print` pauses the print.
    `command` is the command of the file that is being carried out."""

    def __init__(
        self,
        control: Control,
        laser: Laser,
        file: FileLines,
        pause: FilePause,
        states: States[JobState],
        reply: Reply,
        pause_print: Callable[[], None],
    ) -> None:
        self._control, self._laser, self._file, self._pause = control, laser, file, pause
        self._states, self._reply, self._pause_print = states, reply, pause_print
        self.reset()

    def reset(self) -> None:
        """Call this when a print begins."""
        self.command: Command | None = None
        self._waits_for: Wait | None = None  # its unfinished wait

    @property
    def _state(self) -> JobState:
        return self._states.now

    async def wait_in_pause(self) -> None:
        """Parks the nozzle, and waits until the pause has ended."""
        lock = self._control.motion_lock
        await lock.acquire()
        try:
            if self._state is JobState.PAUSED:
                await self._pause.leave()
        finally:
            lock.release()
        await self._pause.resumed.wait()

    async def room(self) -> None:
        """Waits until there is space in the plan."""
        control, queue = self._control, self._control.rig.queue
        await queue.until(
            lambda: (
                not (queue.full or control.state.host_paused or queue.interrupted)
                or not self._state.prints
                or bool(control.state.halted)
            ),
            idly=True,
        )

    async def stretch(self, *, rest_of_line: bool = False) -> bool:
        """Plans as far ahead as useful. Returns True at the end of the file. Call it with the
        motion lock held."""
        control = self._control
        job, queue = control.rig.job, control.rig.queue
        control.state.raise_if_halted()
        if self._state is JobState.PAUSED:
            self._pause.suspend()
        if not self._state.prints:
            return False
        if self._state is JobState.RETURNING and not await self._come_back():
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
            await self._pause.come_back()
        except CommandError as error:
            if self._state.active:
                text = f"Print of {self._file.name} stays paused: {error}"
                control.state.announce(_log, logging.WARNING, text, error.problems[0])
                self._pause.resumed.clear()
                self._states.enter(JobState.PAUSED)
            return False
        if self._state is not JobState.RETURNING:
            return False
        self._states.enter(JobState.PRINTING)
        self._pause.resume()
        return True

    async def _answer(self, found: _core.JobStatus) -> bool:
        """Handles the reason why the interpreter stopped."""
        control, job = self._control, self._control.rig.job
        status = _core.JobStatus
        if found == status.NEED_INPUT:
            self._file.feed()
            await asyncio.sleep(0)  # long parts without moves: skipped objects, comments
        elif found == status.MACRO:
            command = Command(*job.event)
            try:
                control.dispatch.expand(command, self._reply)
            except CommandError as error:
                raise InputError(self._file.placed(error, command.line)) from None
            await asyncio.sleep(0)  # a macro may run for long without moves
        elif found == status.EVENT:
            command = self.command = Command(*job.event)
            try:
                if self._file.repeats(command):
                    await asyncio.sleep(0)  # the loop may have no move
                    return False
                self._waits_for = control.dispatch.run_command(command, self._reply)
            except (InputError, CommandError) as error:
                raise InputError(self._file.placed(error, command.line)) from None
            return await self._wait()
        elif found == status.ERROR:
            problem = problem_of(job, self._file.name, control.machine.geometry)
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
                    wait, self._reply, suspended=lambda: self._pause.suspended
                ):
                    return False
            except CommandError as error:
                heaters = wait.heaters if isinstance(wait, WaitForTemperatures) else ()
                heaters = (
                    tuple(control.machine.heaters) if isinstance(wait, WaitForUser) else heaters
                )
                if not self._pauses_for(heaters):
                    raise
                text = f"Print of {self._file.name} is paused: {error}"
                control.state.announce(_log, logging.WARNING, text, error.problems[0])
                self._pause_print()
                return False  # the wait is repeated after the pause
            self._waits_for = None
            await self._pause.finish_macro(self._file.name)
        self.command = None
        if control.rig.commands.ended:
            control.rig.commands.ended = False
            return await self._finish()
        return False

    def _pauses_for(self, heaters: Sequence[str]) -> bool:
        """Whether one of these heaters has failed and its policy is to pause the print."""
        control = self._control
        return any(
            control.rig.connection.heaters[name].fault is not None
            and control.machine.heaters[name].on_fault == "job"
            for name in heaters
        )

    async def _finish(self) -> bool:
        """Waits until the last moves are done, and then switches the laser off. A pause during
        these moves still takes effect."""
        queue = self._control.rig.queue
        self._laser.off()
        queue.flush()
        await queue.until(
            lambda: (
                queue.standing
                or self._state is not JobState.PRINTING  # the pause may have ended in the meantime
                or bool(self._control.state.halted)
            )
        )
        self._control.state.raise_if_halted()
        return self._state is JobState.PRINTING
