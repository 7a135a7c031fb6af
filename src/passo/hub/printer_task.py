"""The task of one printer: it connects, follows the printer, and works on its run."""

from __future__ import annotations

import asyncio
import logging
from asyncio import Semaphore
from collections.abc import Callable
from random import Random

from passo.errors import HubError
from passo.hub import power
from passo.hub.contact import LOST_S, Contact, bed_is_clear
from passo.hub.hand_over import HandOver
from passo.hub.link import Link, Refused, Unreachable
from passo.hub.records import RunRow
from passo.hub.run_state import RunState
from passo.hub.store import Store
from passo.web.summary import Summary

_log = logging.getLogger(__name__)

AT_ONCE = 20  # connections that begin at the same time
_SPREAD_S = 5.0  # the first connections begin within this time
_SHORTEST_S, _LONGEST_S = 1.0, 30.0  # between two attempts


class PrinterTask:
    """One printer, until `end`. `changed(decisive)` follows each change of what is shown;
    a decisive one may let another run begin."""

    def __init__(
        self,
        printer: str,
        link: Link,
        hand_over: Callable[[Link, Contact], HandOver],
        store: Store,
        gate: Semaphore,
        chance: Random,
        changed: Callable[[bool], None],
        wall_s: Callable[[], float],
    ) -> None:
        """`gate` limits the connections that begin at the same time; `chance` spreads them."""
        self.contact = Contact()
        self.link = link
        self._printer, self._store = printer, store
        self._hand_over = hand_over(link, self.contact)
        self._gate, self._chance, self._changed, self._wall_s = gate, chance, changed, wall_s
        self._woken = asyncio.Event()
        self._failures = 0
        self._ended = False
        self._task = asyncio.get_running_loop().create_task(self._run(), name=f"printer {printer}")

    def wake(self) -> None:
        """Something is to be done for the run of the printer."""
        self._woken.set()

    def admit(self, run: RunRow) -> None:
        """The start of a run is stored, and is to be sent."""
        self._hand_over.admit(run)
        self._woken.set()

    def start_unknown(self, run: RunRow | None) -> bool:
        """Whether a user must say if this run has started."""
        return run is not None and run.state is RunState.STARTING and self._hand_over.unknown(run)

    def heating(self, run: RunRow | None) -> bool:
        """Whether the printer takes its full power; `run` is its run."""
        seen = self.contact.now
        shown = seen is not None and seen.state in ("printing", "paused", "halted")
        starting = run is not None and (
            run.state is RunState.STARTING or (run.state is RunState.PRINTING and not shown)
        )
        return power.heating(seen, starting)

    def cancel(self) -> None:
        """Ends the task soon; from now on it changes nothing."""
        self._ended = True
        self._task.cancel()

    async def end(self) -> None:
        """Ends the task and the connection."""
        self.cancel()
        await asyncio.gather(self._task, return_exceptions=True)
        await self.link.close()

    async def _run(self) -> None:
        await asyncio.sleep(self._chance.uniform(0.0, _SPREAD_S))
        while True:
            reason = ""
            try:
                await self._connection()
            except* Unreachable as errors:
                reason = str(errors.exceptions[0])
            except* (HubError, Refused) as errors:
                reason = str(errors.exceptions[0])
                _log.warning("Printer %s: %s", self._printer, reason)
            except* Exception as errors:
                # The connection begins again, with what is stored; nothing else waits for it.
                reason = repr(errors.exceptions[0])
                _log.exception("The task of printer %s failed", self._printer)
            if self._ended:  # an error at the same moment hides the cancellation
                return
            if not self._failures:
                _log.info("Printer %s is not connected: %s", self._printer, reason)
            pause_s = min(_SHORTEST_S * 2.0**self._failures, _LONGEST_S)
            self._failures = min(self._failures + 1, 10)
            await asyncio.sleep(pause_s * self._chance.uniform(0.5, 1.0))

    async def _connection(self) -> None:
        """One connection, until it is lost."""
        await self._gate.acquire()
        waits = True

        def seen(summary: Summary) -> None:
            nonlocal waits
            if waits:
                waits = False
                self._gate.release()
            self._see(summary)

        self._woken.clear()
        self._hand_over.reconnected()
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._follow(seen))
                tasks.create_task(self._work())
        finally:
            if waits:
                self._gate.release()

    async def _follow(self, seen: Callable[[Summary], None]) -> None:
        loop = asyncio.get_running_loop()
        try:
            await self.link.follow(seen)
        finally:
            self.contact.lose(loop.time(), self._wall_s())
            loop.call_later(LOST_S, self._changed, True)
            self._changed(True)

    async def _work(self) -> None:
        while True:
            await self._woken.wait()
            self._woken.clear()
            if self.contact.connected and not self._ended:
                await self._hand_over.step()

    def _see(self, seen: Summary) -> None:
        if self._ended:
            return
        before = self.contact.now
        self.contact.receive(seen)
        self._failures = 0
        row = self._store.printers[self._printer]
        what = ""
        if row.bed_clear and not bed_is_clear(row, seen):
            what = f"The bed of {row.name} is not clear: the printer has printed"
        halted = seen.state == "halted" and (before is None or before.state != "halted")
        attention = row.attention
        if halted and not attention:
            attention = seen.fault.text if seen.fault is not None else "The printer is halted"
            what = f"{row.name} is halted: {attention}"
        if what:
            with self._store.change("", what, printer=row.id) as change:
                change.set(row, attention=attention, bed_clear=bed_is_clear(row, seen))
        decisive = before is None or _decisive(before) != _decisive(seen)
        self._woken.set()
        self._changed(decisive)


def _decisive(seen: Summary) -> tuple[object, ...]:
    """What of a summary may let a run begin."""
    job = "" if seen.job is None else seen.job.run or seen.job.file
    return seen.state, job, seen.last_print, power.heating(seen, False)
