"""How a printer lives on: a board that fails, or the program, halts it, and M999 begins anew."""

from __future__ import annotations

import asyncio
from math import inf
from typing import TYPE_CHECKING

from passo.board.faults import BoardResetError, PlaceLostError
from passo.board.ports import LinkLostError
from passo.errors import MachineError, in_words
from passo.motion.motion_queue import TICK_S, either
from passo.printer.recovery.reconnect import reconnect
from passo.printer.recovery.stop_boards import stop_boards
from passo.printer.setup.boards import reconnected
from passo.printer.wait_requests import Silence

if TYPE_CHECKING:
    from passo.printer.printer import Printer


# A board that begins anew twice within this time does so because of what is turned on, perhaps.
_SOON_S = 60.0
_LOOK_S = 0.25  # while it is halted


class Life:
    """One printer's drive at work, again and again."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self._revived = asyncio.Event()  # somebody has sent M999, and no M112 since
        self._asking: list[asyncio.Future[None]] = []  # who waits for what becomes of M999
        self._warm = False  # what is warm stays so when the printer begins anew
        self._reset_s = -inf  # when a board has begun anew

    def revive(self) -> None:
        """Somebody has made the halted machine safe."""
        self._revived.set()

    def answered(self) -> asyncio.Future[None]:
        """Done when the printer is ready again, or M999 has led to nothing."""
        asking: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._asking.append(asking)
        return asking

    def stop(self) -> None:
        """M112, also while the printer begins anew, by itself or after M999."""
        self._warm = False
        self._answer()

    def _answer(self) -> None:
        """M999 is done, or has led to nothing."""
        self._revived.clear()
        for asking in self._asking:
            if not asking.done():
                asking.set_result(None)
        self._asking.clear()

    async def run(self) -> None:
        """Lets time pass until cancelled."""
        printer = self._printer
        while True:
            try:
                await self._drive()
            except Exception as error:
                failure = await self._reconnect(error)
                if failure is None:
                    continue
                displaced = isinstance(failure, PlaceLostError) and not self._has_to_halt(failure)
                printer.failures += not printer.halted  # else it has been counted
                self._warm = displaced
                printer.halted = printer.halted or str(in_words(failure)).rstrip(".")
                if displaced:
                    self._pause()
                else:
                    await self._halt()
                await self._all_have_stopped()
                try:
                    if displaced and not self._warm:
                        await self._halt()  # M112 came meanwhile
                    await self._revive()
                finally:
                    printer.turn.give()

    def _has_to_halt(self, failure: PlaceLostError) -> bool:
        """It was halted before, or what it keeps warm may be what resets the board."""
        if not isinstance(failure, BoardResetError):
            return bool(self._printer.halted)
        before, self._reset_s = self._reset_s, asyncio.get_running_loop().time()
        return bool(self._printer.halted) or self._reset_s - before < _SOON_S

    async def _drive(self) -> None:
        """Lets time pass until the board fails. After a fault of the program, which halts the
        printer, too, the board is well: it tells that it has stopped."""
        printer = self._printer
        try:
            await printer.drive.run()
        except MachineError:
            printer.lateness.board_failed()
            raise
        except Exception as error:
            printer.halt(str(in_words(error)))
            await printer.drive.hear_stop()

    async def _reconnect(self, error: Exception) -> Exception | None:
        """After a lost link goes on where the board has stopped by itself; else what halts it."""
        printer = self._printer
        if printer.halted or not isinstance(error, LinkLostError):
            return error
        if isinstance(error, PlaceLostError):
            return error  # nothing is left that could be taken over
        boards = printer.connection
        if not boards.survives or boards.timeline.halted:
            return error
        try:
            await reconnect(printer, error)
        except Exception as failure:
            return failure
        return None

    def _pause(self) -> None:
        """Nothing is wrong but that nobody knows where the motors are."""
        printer = self._printer
        printer.connection.stop_job()
        printer.tell(f"Error:{printer.halted}")
        printer.tell("// action:pause")
        printer.drive.end_waits()

    async def _halt(self) -> None:
        """Waits until somebody has made the machine safe."""
        printer = self._printer
        self._make_safe()
        if printer.start_failure is None:  # else each console is told when it opens
            printer.tell(f"Error:Printer halted: {printer.why_halted}")
        printer.drive.end_waits()
        await self._until_revived()

    async def _until_revived(self) -> None:
        """Waits for M999; until then each board is told to stop that has not heard of it."""
        await stop_boards(self._printer, self._revived)
        while not self._revived.is_set():
            await either(self._revived, _LOOK_S)
            self._printer.drive.stand_by()

    def _make_safe(self) -> None:
        """The board may only have been silent for a moment: it must not go on when it is back."""
        printer = self._printer
        printer.connection.switch_heaters_off()
        printer.connection.stop_job()
        printer.connection.emergency_stop()

    async def _all_have_stopped(self) -> None:
        """Takes the turn: who had it has heard of the halt by then, and waits for nothing of the
        old plan any more."""
        printer = self._printer
        while not printer.turn.take():
            printer.drive.end_waits()
            await asyncio.sleep(TICK_S)

    async def _revive(self) -> None:
        """Begins anew; as often as somebody asks, until the board can be reached."""
        heaters = self._printer.connection.heaters.items()
        warm = {n: h.target for n, h in heaters if self._warm and not h.fault}
        if not self._warm:
            await self._until_revived()  # M112 may have come since somebody asked
        while True:
            try:
                self._begin_anew()
                for heater, celsius in warm.items():
                    self._printer.connection.set_target(heater, celsius)
            except Exception as error:
                warm = {}
                failure = in_words(error)
                if not self._printer.halted:  # the board is well, but not what came after it
                    self._printer.halted = str(failure).rstrip(".")
                self._make_safe()
                self._printer.tell(f"Error:{failure} Then send M999 again")
                self._answer()
                await self._until_revived()
            else:
                self._answer()
                return

    def _begin_anew(self) -> None:
        printer = self._printer
        for listener in printer.stop_listeners:
            listener(printer.halted)
        printer.motors.forget()
        lines = list(printer.settings())
        printer.begin(reconnected(printer.connection))
        printer.motion.homed("xyz")
        printer.endstops.begin()
        printer.halted = ""
        for line in lines:
            printer.take_setting(line, Silence())
        printer.tell("echo:The printer is ready again. Home it before you move it")
        if greeting := printer.greeting():
            printer.tell(greeting)
