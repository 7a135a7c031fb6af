"""What the parts of the farm share: the store, the printers' tasks, and who learns of changes."""

from __future__ import annotations

import asyncio
import logging
from asyncio import Semaphore
from collections.abc import Callable
from pathlib import Path
from random import Random

from passo.errors import HubError, WebError
from passo.hub.contact import Contact
from passo.hub.dispatcher import Dispatcher
from passo.hub.hand_over import HandOver
from passo.hub.link import Link, PrinterRecord
from passo.hub.matching import Fits
from passo.hub.printer_task import AT_ONCE, PrinterTask
from passo.hub.records import JobRow, PrinterRow
from passo.hub.run_book import RunBook
from passo.hub.store import Store

_log = logging.getLogger(__name__)
_AGAIN_S = 5.0  # after a failure of the store


class Parts:
    """The running parts of a farm. After each change, runs begin that can begin, and the listeners
    are called."""

    def __init__(
        self,
        store: Store,
        links: Callable[[PrinterRecord], Link],
        content: Callable[[str], Path],
        fits: Fits,
        wall_s: Callable[[], float],
        chance: Random,
        new_id: Callable[[], str],
    ) -> None:
        self.store, self.wall_s, self.new_id = store, wall_s, new_id
        self.book = RunBook(store, wall_s, new_id)
        self.tasks: dict[str, PrinterTask] = {}
        self.dispatcher = Dispatcher(store, self.book, self.tasks, fits)
        self.listeners: list[Callable[[], None]] = []
        self._links, self._content, self._chance = links, content, chance
        self._gate = Semaphore(AT_ONCE)
        self._running = False
        self._pending: asyncio.Handle | None = None
        self._decisive = True
        store.listeners.append(self.changed)

    def start(self) -> None:
        """Connects to all printers."""
        self._running = True
        for printer in self.store.printers.values():
            self.begin(printer)
        self.changed()

    async def close(self) -> None:
        """Ends all connections; the printers print on."""
        self._running = False
        if self._pending is not None:
            self._pending.cancel()
        await asyncio.gather(*(task.end() for task in self.tasks.values()))
        self.tasks.clear()

    def begin(self, printer: PrinterRow) -> None:
        """Begins the task of a printer."""

        def hand_over(link: Link, contact: Contact) -> HandOver:
            return HandOver(printer.id, link, contact, self.store, self.book, self._content)

        link = self._links(printer.record)
        self.tasks[printer.id] = PrinterTask(
            *(printer.id, link, hand_over, self.store, self._gate, self._chance),
            *(self.changed, self.wall_s),
        )

    async def begin_again(self, printer: PrinterRow) -> None:
        """Replaces the task of a printer, whose address has changed."""
        old = self.tasks[printer.id]
        old.cancel()
        self.begin(printer)
        await old.end()

    async def end(self, printer: str) -> None:
        """Ends the task of a printer that is removed."""
        await self.tasks.pop(printer).end()

    def changed(self, decisive: bool = True) -> None:
        """Something has changed; it may let a run begin if it is `decisive`."""
        self._decisive |= decisive
        if self._running and self._pending is None:
            self._pending = asyncio.get_running_loop().call_soon(self._settle)

    def printer(self, id: str) -> PrinterRow:
        """A printer. Raises WebError."""
        if id not in self.store.printers or id not in self.tasks:
            raise WebError.of("web.not-found", value=f"printer {id}")
        return self.store.printers[id]

    def job(self, id: str) -> JobRow:
        """An open job. Raises WebError."""
        if id not in self.store.jobs:
            raise WebError.of("web.not-found", value=f"open job {id}")
        return self.store.jobs[id]

    def _settle(self) -> None:
        loop = asyncio.get_running_loop()
        if self._decisive:
            self._decisive = False
            try:
                self.dispatcher.settle()
            except HubError as error:
                _log.error("No run can begin: %s", error)
                loop.call_later(_AGAIN_S, self.changed)
            except Exception:
                _log.exception("No run can begin")
                loop.call_later(_AGAIN_S, self.changed)
        # What the runs that begin have changed is settled next.
        self._pending = loop.call_soon(self._settle) if self._decisive else None
        for changed in list(self.listeners):
            changed()
