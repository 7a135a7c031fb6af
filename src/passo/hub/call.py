"""A request to the hub, in the form for the handlers of operations."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.errors import HubError, WebError
from passo.hub.limits import Limits, Tags, seen
from passo.web.call import ServerCall

if TYPE_CHECKING:
    from passo.hub.contents import Contents
    from passo.hub.control import FarmControl
    from passo.hub.link import PrinterRecord
    from passo.hub.matching import Fits
    from passo.hub.proposals import Proposals
    from passo.hub.views import Farm, FileView, JobView, PrinterView
    from passo.hub.wishes import NewPrinter


@dataclass(frozen=True, slots=True)
class HubSite:
    """The farm, the contents of its files, whether these fit printers, the limits of accounts, how
    a printer is made known, the printers that multicast DNS has found, and the wall clock, in
    seconds since 1970."""

    farm: FarmControl
    contents: Contents
    fits: Fits
    limits: Limits
    pair: Callable[[NewPrinter], Awaitable[PrinterRecord]]
    proposals: Proposals
    wall_s: Callable[[], float]


@dataclass(frozen=True, slots=True)
class HubCall(ServerCall):
    """One request to the hub."""

    site: HubSite

    @property
    def farm(self) -> FarmControl:
        """The farm."""
        return self.site.farm

    @property
    def user(self) -> str:
        """The caller's name, for the logs of the hub and of the printers."""
        return self.caller.name

    @property
    def tags(self) -> Tags | None:
        """The tags of the caller's printers, None for all."""
        return self.site.limits.of(self.caller)

    def view(self) -> Farm:
        """The part of the farm that the caller sees."""
        return seen(self.farm.view(), self.tags)

    def printer(self, id: str) -> PrinterView:
        """A printer that the caller sees. Raises WebError."""
        found = next((one for one in self.view().printers if one.id == id), None)
        if found is None:
            raise WebError.of("web.not-found", value=f"printer {id}")
        return found

    def job(self, id: str) -> JobView:
        """A job that the caller sees. Raises WebError."""
        found = next((one for one in self.view().jobs if one.id == id), None)
        if found is None:
            raise WebError.of("web.not-found", value=f"job {id}")
        return found

    def own_job(self, id: str) -> JobView:
        """A job that the caller may change: all of its named printers are the caller's. Raises
        WebError and HubError."""
        found = self.job(id)
        self.require_all(found.each)
        return found

    def require_all(self, printers: Sequence[str]) -> None:
        """Raises HubError unless the caller sees all of these printers."""
        names = {printer.id: printer.name for printer in self.farm.view().printers}
        seen = {printer.id for printer in self.view().printers}
        other = next((id for id in printers if id in names and id not in seen), None)
        if other is not None:
            raise HubError.of("hub.limited", value=self.user, axis=names[other])

    def require_no_limit(self, what: str) -> None:
        """Raises HubError for a limited caller; `what` concerns all printers."""
        if self.tags is not None:
            raise HubError.of("hub.limited", value=self.user, axis=what)

    def file(self, sha256: str) -> FileView:
        """A file. Raises WebError."""
        found = next((one for one in self.farm.files() if one.sha256 == sha256), None)
        if found is None:
            raise WebError.of("web.not-found", value=f"file {sha256}")
        return found

    def require_tags(self, tags: list[str]) -> list[str]:
        """The tags of a job of the caller: a limited caller's own, if none are given. Raises
        HubError for other tags, and if several are possible."""
        own = self.tags
        if own is None:
            return tags
        if not tags and len(own) == 1:
            return list(own)
        if not tags or not own.issuperset(tags):
            other = ", ".join(sorted(set(tags) - own)) or "all printers"
            raise HubError.of("hub.limited", value=self.user, axis=other)
        return tags
