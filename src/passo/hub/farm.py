"""The farm: what it shows, and what users ask of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random
from time import time
from uuid import uuid4

from passo.hub.history import History
from passo.hub.job_wishes import JobWishes
from passo.hub.link import Link, PrinterRecord
from passo.hub.matching import Fit, Fits
from passo.hub.parts import Parts
from passo.hub.printer_wishes import PrinterWishes
from passo.hub.service import ServiceItems
from passo.hub.store import Store
from passo.hub.view_maker import ViewMaker
from passo.hub.views import Farm as FarmView
from passo.hub.views import PrinterView


def fits_always(sha256: str, printer: str) -> Fit:
    """Takes each file as one that fits each machine."""
    return Fit(True)


class Farm(PrinterWishes, JobWishes, ServiceItems, History):
    """Many printers and one queue; it is a `FarmControl`. It acts from `start` until `close`, and
    continues after a crash with what is in the store."""

    def __init__(
        self,
        store: Store,
        links: Callable[[PrinterRecord], Link],
        content: Callable[[str], Path],
        fits: Fits = fits_always,
        wall_s: Callable[[], float] = time,
        chance: Random | None = None,
        new_id: Callable[[], str] = lambda: str(uuid4()),
    ) -> None:
        """`links` makes the connection to a printer; `content` is the path of a file, by its
        SHA-256; `fits` says whether a file fits a printer, None while that is not known (call
        `refit` when it is). `wall_s` is the wall clock, `chance` spreads the connections."""
        self._parts = Parts(store, links, content, fits, wall_s, chance or Random(), new_id)
        self._views = ViewMaker(self._parts)
        PrinterWishes.__init__(self, self._parts, self._views)
        JobWishes.__init__(self, self._parts, self._views)
        ServiceItems.__init__(self, self._parts)
        History.__init__(self, store)

    async def start(self) -> None:
        """Connects to the printers and begins to act."""
        self._parts.start()

    async def close(self) -> None:
        """Ends all connections. Prints continue."""
        await self._parts.close()

    def view(self) -> FarmView:
        """The farm at this moment."""
        return self._views.view()

    def printer(self, id: str) -> PrinterView:
        """A printer at this moment. Raises WebError."""
        return self._views.printer(self._parts.printer(id))

    def listen(self, changed: Callable[[], None]) -> Callable[[], None]:
        """Calls `changed` after each change of the view; returns a function that ends this."""
        self._parts.listeners.append(changed)
        return lambda: self._parts.listeners.remove(changed)

    def refit(self) -> None:
        """It is known of more files whether they fit."""
        self._parts.changed()
