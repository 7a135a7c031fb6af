"""Printer supervisor: halts when a board or the program fails, and restarts on M999."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING

from passo.board.faults import BoardResetError, PlaceLostError
from passo.board.ports import LinkLostError
from passo.errors import MachineError, in_words
from passo.motion.motion_queue import TICK_S, either
from passo.printer.recovery.link_state import TRANSITIONS, LinkState
from passo.printer.recovery.stop_boards import stop_boards

if TYPE_CHECKING:
    from passo.motion.rig import Rig
    from passo.printer.motion_lock import MotionLock
    from passo.printer.recovery.reconnect import Reconnection
    from passo.printer.state import State
    from passo.printer.stops import Stops
    from passo.printer.watch.late_commands import LateCommandWatch


_log = logging.getLogger(__name__)

# A second reset this soon is probably caused by a load, such as a heater.
_SOON_S = 60.0
_LOOK_S = 0.25  # interval of checks while the printer is halted


class Supervisor:
    """Runs the motion queue of one printer until a failure, and again after each restart. `halt`
    halts the printer; `restart` restarts its boards, and raises if that fails."""

    def __init__(
        self,
        rig: Rig,
        state: State,
        motion_lock: MotionLock,
        lateness: LateCommandWatch,
        reconnection: Reconnection,
        stops: Stops,
        *,
        restart: Callable[[], None],
    ) -> None:
        self._rig, self._state, self._motion_lock = rig, state, motion_lock
        self._lateness, self.reconnection = lateness, reconnection
        self._halt_printer, self._restart = stops.halt, restart
        stops.halt_listeners.append(self._stop)
        self._restart_asked = asyncio.Event()  # M999 was sent, and no M112 since
        stops.restart_listeners.append(self._restart_asked.set)
        self._asking: list[asyncio.Future[None]] = []  # consoles that wait for the result of M999
        self._link = LinkState.CONNECTED
        # called with the old and the new state
        self.watchers: list[Callable[[LinkState, LinkState], None]] = []
        self._reset_s = -inf  # when a board was reset

    @property
    def link(self) -> LinkState:
        """The state of the links to the boards."""
        return self._link

    def _enter(self, link: LinkState) -> None:
        was = self._link
        if link not in TRANSITIONS[was]:
            raise RuntimeError(f"a link does not go from {was.name} to {link.name}")
        self._link = link
        for watcher in self.watchers:
            watcher(was, link)

    def answered(self) -> asyncio.Future[None]:
        """A future that is done when the printer is ready again, or M999 has failed."""
        asking: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._asking.append(asking)
        return asking

    def _stop(self) -> None:
        """M112: halts the printer, even while a restart is pending."""
        if self._link is LinkState.PLACE_LOST:
            self._enter(LinkState.HALTED)
        self._answer()

    def _answer(self) -> None:
        """Ends the waits of the consoles that have sent M999."""
        self._restart_asked.clear()
        for asking in self._asking:
            if not asking.done():
                asking.set_result(None)
        self._asking.clear()

    async def run(self) -> None:
        """Runs the printer until cancelled."""
        state = self._state
        while True:
            try:
                await self._drive()
            except Exception as error:
                failure = await self._reconnect(error)
                if failure is None:
                    continue
                displaced = isinstance(failure, PlaceLostError) and not self._has_to_halt(failure)
                if not state.halted:
                    state.halt(in_words(failure))
                self._enter(LinkState.PLACE_LOST if displaced else LinkState.HALTED)
                if displaced:
                    self._pause()
                else:
                    await self._halt()
                await self._all_have_stopped()
                try:
                    if displaced and self._link is LinkState.HALTED:
                        await self._halt()  # M112 was received in the meantime
                    await self._restart_boards()
                finally:
                    self._motion_lock.release()

    def _has_to_halt(self, failure: PlaceLostError) -> bool:
        """Whether the printer must halt: it was halted already, or its heaters may have caused the
        reset of the board."""
        if not isinstance(failure, BoardResetError):
            return bool(self._state.halted)
        before, self._reset_s = self._reset_s, asyncio.get_running_loop().time()
        return bool(self._state.halted) or self._reset_s - before < _SOON_S

    async def _drive(self) -> None:
        """Runs the motion queue until a board fails. A fault of the program also halts the printer;
        then the board still works, and confirms the stop."""
        rig = self._rig
        try:
            await rig.queue.run()
        except MachineError:
            self._lateness.board_failed()
            raise
        except Exception as error:
            self._halt_printer(in_words(error))
            await rig.queue.await_shutdown()

    async def _reconnect(self, error: Exception) -> Exception | None:
        """After a lost link, resumes from the position at which the boards have braked, and returns
        None. Otherwise returns the failure that halts the printer."""
        rig, state = self._rig, self._state
        if state.halted or not isinstance(error, LinkLostError):
            return error
        if isinstance(error, PlaceLostError):
            return error  # the boards cannot be taken over
        boards = rig.connection
        if not boards.survives or boards.timeline.halted:
            return error
        try:
            self._enter(LinkState.RECONNECTING)
            await self.reconnection.reconnect(error)
        except Exception as failure:
            return failure
        self._enter(LinkState.CONNECTED)
        return None

    def _pause(self) -> None:
        """Pauses the print: the boards work, but the positions of the motors are unknown."""
        rig, state = self._rig, self._state
        rig.connection.stop_job()
        state.tell(f"Error:{state.halted}")
        state.tell("// action:pause")
        rig.queue.end_waits()

    async def _halt(self) -> None:
        """Waits for M999."""
        rig, state = self._rig, self._state
        self._make_safe()
        if state.start_failure is None and not self._restart_asked.is_set():
            # Otherwise each console receives the message when it opens, or the message is not
            # needed.
            state.tell(f"Error:Printer halted: {state.why_halted}")
        rig.queue.end_waits()
        await self._until_restart_asked()

    async def _until_restart_asked(self) -> None:
        """Waits for M999, and repeats the stop until then for each board that has not confirmed
        it."""
        await stop_boards(self._rig, self._state, self._restart_asked)
        while not self._restart_asked.is_set():
            await either(self._restart_asked, _LOOK_S)
            self._rig.queue.stand_by()

    def _make_safe(self) -> None:
        """Stops all boards and heaters, so that a board that is only silent for a moment does not
        continue."""
        rig = self._rig
        rig.connection.switch_heaters_off()
        rig.connection.stop_job()
        rig.connection.emergency_stop()

    async def _all_have_stopped(self) -> None:
        """Acquires the motion lock. Then the last holder has ended its wait for the old plan."""
        rig = self._rig
        while not self._motion_lock.try_acquire():
            rig.queue.end_waits()
            await asyncio.sleep(TICK_S)

    async def _restart_boards(self) -> None:
        """Restarts the boards after M999. If a board cannot be reached, waits for the next M999."""
        keeps_warm = self._link is LinkState.PLACE_LOST
        heaters = self._rig.connection.heaters.items()
        warm = {n: h.target for n, h in heaters if keeps_warm and not h.fault}
        if not keeps_warm:
            await self._until_restart_asked()  # M112 may have been sent after M999
        while True:
            self._enter(LinkState.RESTARTING)
            try:
                self._restart()
                for heater, celsius in warm.items():
                    self._rig.connection.set_target(heater, celsius)
            except Exception as error:
                warm = {}
                failure = in_words(error)
                if self._state.halted:
                    fields = failure.problems[0].log_fields
                    _log.error("The restart failed: %s", failure, extra=fields)
                else:  # the board works, but its start-up has failed
                    self._state.halt(failure)
                self._enter(LinkState.HALTED)
                self._make_safe()
                self._state.tell(f"Error:{failure} Then send M999 again")
                self._answer()
                await self._until_restart_asked()
            else:
                self._enter(LinkState.CONNECTED)
                self._answer()
                return
