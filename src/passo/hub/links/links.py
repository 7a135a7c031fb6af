"""Makes the links of the hub, which share their connections."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.errors import HubError
from passo.hub.link import Link, PrinterRecord, Refused, Unreachable
from passo.hub.links import moonraker, passo
from passo.hub.links.http import address, session

if TYPE_CHECKING:
    from passo.hub.wishes import NewPrinter


class Links:
    """The links to all printers. Make it in the event loop that uses them."""

    def __init__(self) -> None:
        self._session = session()
        self._made: dict[str, Link] = {}

    def __call__(self, record: PrinterRecord) -> Link:
        """The link to a printer."""
        kind = moonraker.MoonrakerLink if record.kind == "moonraker" else passo.PassoLink
        self._made[record.id] = kind(self._session, record)
        return self._made[record.id]

    async def machine(self, printer: str) -> str:
        """The machine file of a printer, as `Link.machine`."""
        if (link := self._made.get(printer)) is None:
            raise Unreachable("it is not connected")
        return await link.machine()

    async def pair(self, wish: NewPrinter) -> PrinterRecord:
        """Makes the hub known to a printer. Raises HubError."""
        url = address(wish.url)
        known = moonraker.pair if wish.kind == "moonraker" else passo.pair
        try:
            return await known(self._session, wish)
        except Unreachable as error:
            raise HubError.of("hub.unreachable", axis=url, value=str(error)) from None
        except Refused as error:
            raise HubError.of(
                "hub.refused", axis=url, value=error.text, hint=error.action
            ) from None

    async def close(self) -> None:
        """Ends all connections."""
        await self._session.close()
