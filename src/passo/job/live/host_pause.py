"""Pauses of prints that hosts send: parks the nozzle, and returns it to its earlier position."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from passo.errors import CommandError, PassoError
from passo.job.live.park import Park
from passo.printer.wait_requests import NullReply, Stopped, WaitForProcedure

if TYPE_CHECKING:
    from passo.board.faults import HeaterFault
    from passo.printer.control import Control
    from passo.printer.machine_parts import MachineParts

_log = logging.getLogger(__name__)

RECENT_S = 10.0  # idle longer than this means that no host print is running
_SAME_PRINT_S = 60.0  # moves of a host's print come at least this often


class HostPause:
    """Pauses the prints that hosts send to one printer; `Runner` pauses prints from the card."""

    def __init__(self, control: Control, parts: MachineParts) -> None:
        self._control, self._parts, self._suspension = control, parts, parts.suspension
        self._park = Park(control, parts)
        self._stopped = False
        self._task: asyncio.Task[None] | None = None
        control.state.stop_listeners.append(self._stop)
        control.state.fault_listeners.append(self._heater_failed)

    async def stand_by(
        self,
        text: str,
        words: Mapping[str, float],
        gone: Callable[[], bool] = lambda: False,
        *,
        rearms: bool = False,
    ) -> None:
        """Parks the nozzle (`words`: see `Park.leave`), waits for the user, and returns the nozzle.
        The caller must hold the motion lock, or no line may be in progress. `text` is shown to the
        user. With `rearms`, failed heaters are rearmed when the user resumes. Raises Stopped after
        a stop or a halt, and when the host is `gone`, because it could not continue from the old
        position."""
        control = self._control
        control.state.tell("// action:pause")
        if not control.rig.job.stops.suspended:
            self._suspension.suspend()
        try:
            await self._leave_and_return(self._park, text, words, gone, rearms=rearms)
        except BaseException:
            if control.rig.job.stops.suspended:
                control.rig.job.stops.forget_suspended()  # the suspended job cannot resume
            raise
        self._suspension.resume()
        control.state.tell("// action:resume")

    async def park_and_wait(
        self,
        files: Park,
        text: str,
        words: Mapping[str, float],
        gone: Callable[[], bool] = lambda: False,
    ) -> None:
        """Like `stand_by`, during the pause of a file, which continues afterwards: the nozzle
        returns to its present position. If it cannot, `files`, the park of the file, restores the
        retracted filament later."""
        park = Park(self._control, self._parts, here=True)
        try:
            await self._leave_and_return(park, text, words, gone)
        except BaseException:
            files.take_over(park)
            raise

    async def _leave_and_return(
        self,
        park: Park,
        text: str,
        words: Mapping[str, float],
        gone: Callable[[], bool],
        *,
        rearms: bool = False,
    ) -> None:
        control = self._control
        self._stopped = False
        control.prompts.ask(text)
        try:
            await park.leave(words)
        except BaseException:
            control.prompts.answered()
            raise
        while True:
            await self._answered(gone)
            if rearms:
                control.targets.rearm_failed()
            try:
                await park.come_back()
                break
            except CommandError as error:
                text = f"Print still paused: {error}"
                control.state.announce(_log, logging.WARNING, text, error.problems[0])
                control.state.ended, rearms = False, True
                control.prompts.ask(f"{error} Continue with M108")
        self._raise_if_stopped()

    async def _answered(self, gone: Callable[[], bool]) -> None:
        """Waits until the user continues, or until the host is `gone`."""
        control = self._control
        try:
            control.state.tell("echo:busy: paused for user")
            with control.prompts.waited_for():
                await control.rig.queue.until(lambda: control.state.interrupted, idly=True)
        finally:
            control.prompts.answered()
        control.state.raise_if_halted()
        if gone():
            self._stop("")
        self._raise_if_stopped()

    def _raise_if_stopped(self) -> None:
        if self._stopped or not self._control.rig.job.stops.suspended:
            raise Stopped("it was stopped")

    def _stop(self, _: str) -> None:
        """Called after M410 or a triggered endstop: discards the pause, because the position is
        lost."""
        self._stopped = True
        if self._control.rig.job.stops.suspended and not self._control.state.busy():
            self._control.rig.job.stops.forget_suspended()

    @property
    def prints(self) -> bool:
        """Whether a host seems to print: numbered moves have come lately, and the machine has not
        been idle for long."""
        control, now_s = self._control, asyncio.get_running_loop().time()
        at_s = control.state.numbered_move_s
        recent = at_s is not None and now_s - at_s <= _SAME_PRINT_S
        return recent and not control.state.busy() and control.rig.queue.idle_s <= RECENT_S

    def _heater_failed(self, fault: HeaterFault) -> None:
        """Called for a failed heater whose policy is to pause the print."""
        heaters = self._control.rig.connection.heaters
        text = f"Heater {fault.heater} failed; repair it, then M108 continues and rearms it"
        # It may be rearmed during another pause.
        self.interrupt(
            text, {}, needed=lambda: heaters[fault.heater].fault is not None, rearms=True
        )

    def interrupt(
        self,
        text: str,
        words: Mapping[str, float],
        *,
        needed: Callable[[], bool],
        rearms: bool = False,
    ) -> None:
        """Pauses the print of a host as `stand_by`, at once. Lines in progress, such as homing, end
        first, and the pause begins only if it is still `needed` then; no other line is accepted.
        Does nothing during a print from the card."""
        control = self._control
        if control.state.busy() or control.state.halted or control.state.host_paused:
            return
        if not control.waits.busy and control.rig.queue.idle_s > RECENT_S:
            control.state.tell("// action:pause")
            return
        control.state.host_paused = True
        pause = self._pause_when(text, words, needed, rearms=rearms)
        self._task = asyncio.get_running_loop().create_task(pause)

    async def _pause_when(
        self, text: str, words: Mapping[str, float], needed: Callable[[], bool], *, rearms: bool
    ) -> None:
        control = self._control
        try:
            await control.rig.queue.until(
                lambda: not control.waits.busy or bool(control.state.halted), idly=True
            )
            if needed() and not control.state.halted:
                self._suspension.suspend()
                pause = WaitForProcedure(lambda: self.stand_by(text, words, rearms=rearms))
                try:
                    await control.waits.wait(pause, NullReply())
                except Stopped:
                    pass  # the source of the stop has reported it
                except PassoError as error:
                    control.stops.halt(error, f"the print could not be paused: {error}")
        finally:
            control.state.host_paused = False
