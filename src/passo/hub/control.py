"""What the web of the hub asks of the farm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from passo.hub.link import PrinterRecord
from passo.hub.views import Farm, FileView, JobView, PowerGroup, PrinterView, RunView
from passo.hub.wishes import (
    FarmEvent,
    JobChange,
    NewJob,
    PrinterChange,
    ServiceInterval,
    ServiceItem,
    Statistics,
    Stopped,
)


class FarmControl(Protocol):
    """The farm. `user` is who asks. Calls that change something return when the change is durable.
    They raise WebError `web.not-found` for an unknown id, HubError `hub.unreachable` and
    `hub.refused` for what a printer answers, `hub.state` for what does not fit now, and `hub.store`
    if the data cannot be written."""

    def view(self) -> Farm:
        """The farm at this moment."""
        ...

    def listen(self, changed: Callable[[], None]) -> Callable[[], None]:
        """Calls `changed` after each change of the view; returns a function that ends this."""
        ...

    async def add_printer(
        self, record: PrinterRecord, tags: Sequence[str], user: str
    ) -> PrinterView:
        """Adds a printer. Raises HubError `hub.known`."""
        ...

    async def change_printer(self, printer: str, change: PrinterChange, user: str) -> PrinterView:
        """Changes what the hub knows of a printer."""
        ...

    async def remove_printer(self, printer: str, user: str) -> None:
        """Removes a printer without a run."""
        ...

    async def clear(self, printer: str, user: str) -> PrinterView:
        """The bed is empty, as `user` says."""
        ...

    async def attend(self, printer: str, started: bool | None, user: str) -> PrinterView:
        """The attention is dealt with; `started` says whether a run with an
        unknown start has started."""
        ...

    async def pause(self, printer: str, user: str) -> None:
        """Pauses the print."""
        ...

    async def resume(self, printer: str, user: str) -> None:
        """Resumes the print."""
        ...

    async def cancel(self, printer: str, user: str) -> None:
        """Cancels the print."""
        ...

    async def stop(self, printers: Sequence[str], user: str) -> list[Stopped]:
        """Emergency stop of these printers, at the same time. Raises nothing for a printer that
        does not answer."""
        ...

    async def picture(self, printer: str) -> bytes:
        """The picture of the running print, PNG; empty if there is none."""
        ...

    def files(self) -> Sequence[FileView]:
        """All files, newest first."""
        ...

    async def add_file(self, file: FileView, user: str) -> FileView:
        """Adds a file whose content is stored. The same content again keeps the first name."""
        ...

    async def remove_file(self, sha256: str, user: str) -> None:
        """Removes a file. Raises HubError `hub.file-used`."""
        ...

    async def add_job(self, job: NewJob, user: str) -> JobView:
        """Adds a job."""
        ...

    async def change_job(self, job: str, change: JobChange, user: str) -> JobView:
        """Changes a job."""
        ...

    async def cancel_job(self, job: str, user: str) -> None:
        """Ends a job: nothing more of it starts, and its prints are cancelled."""
        ...

    async def pause_queue(self, paused: bool, user: str) -> None:
        """Whether nothing starts."""
        ...

    async def set_power_group(self, name: str, limit_w: float, user: str) -> PowerGroup:
        """Makes or changes a power group."""
        ...

    async def remove_power_group(self, name: str, user: str) -> None:
        """Removes a power group; its printers have none then."""
        ...

    async def runs(self, limit: int, printer: str, job: str) -> list[RunView]:
        """The newest runs first; an empty printer or job is all."""
        ...

    async def statistics(self) -> Statistics:
        """The totals of all runs."""
        ...

    async def events(self, limit: int) -> list[FarmEvent]:
        """The newest lines of the log first."""
        ...

    async def service_items(self, printer: str) -> list[ServiceItem]:
        """The maintenance items of a printer."""
        ...

    async def set_service_item(
        self, printer: str, item: str, interval: ServiceInterval, user: str
    ) -> ServiceItem:
        """Makes or changes a maintenance item."""
        ...

    async def remove_service_item(self, printer: str, item: str, user: str) -> None:
        """Removes a maintenance item."""
        ...
