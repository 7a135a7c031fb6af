"""What users ask of the printers."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Sequence
from typing import Any, TypeVar, cast

from msgspec import UNSET, Struct
from msgspec.structs import asdict

from passo.errors import HubError, WebError
from passo.hub.contact import last_number
from passo.hub.link import PrinterRecord, Refused, Unreachable
from passo.hub.parts import Parts
from passo.hub.records import GroupRow, PrinterRow
from passo.hub.run_book import Figures
from passo.hub.run_state import RunState
from passo.hub.view_maker import ViewMaker
from passo.hub.views import PowerGroup, PrinterView
from passo.hub.wishes import PrinterChange, Stopped

_T = TypeVar("_T")
_SENT = (RunState.STARTING, RunState.PRINTING)


def given(change: Struct) -> dict[str, Any]:
    """The fields of a change that are given, as they are stored."""
    return {
        name: tuple(cast("list[Any]", value)) if isinstance(value, list) else value
        for name, value in asdict(change).items()
        if value is not UNSET
    }


class PrinterWishes:
    """The printers and their power groups."""

    def __init__(self, parts: Parts, views: ViewMaker) -> None:
        self._parts, self._views, self._store = parts, views, parts.store

    async def add_printer(
        self, record: PrinterRecord, tags: Sequence[str], user: str
    ) -> PrinterView:
        """Adds a printer. Its bed is not clear until a user says so. Raises HubError."""
        known = self._store.printers.get(record.id)
        if known is not None:
            raise HubError.of("hub.known", axis=record.name, value=known.name)
        row = PrinterRow(
            record.id,
            record.name,
            record.url,
            record.kind,
            record.key,
            tuple(tags),
            added_s=self._parts.wall_s(),
        )
        with self._store.change(user, f"{row.name} is added", printer=row.id) as change:
            change.add(row)
        self._parts.begin(row)
        return self._views.printer(row)

    async def change_printer(self, printer: str, change: PrinterChange, user: str) -> PrinterView:
        """Changes what the hub knows of a printer. Raises WebError and HubError."""
        row, fields = self._parts.printer(printer), given(change)
        group = fields.get("power_group", row.power_group)
        if group and group not in self._store.groups:
            raise WebError.of("web.not-found", value=f"power group {group}")
        heating_w = fields.get("heating_w", row.heating_w)
        if group and heating_w > self._store.groups[group].limit_w:
            self._too_much(row, heating_w, self._store.groups[group].limit_w)
        if not fields:
            return self._views.printer(row)
        what = f"{row.name}: {', '.join(sorted(fields))} changed"
        with self._store.change(user, what, printer=printer) as written:
            row = written.set(row, **fields)
        if "url" in fields:
            await self._parts.begin_again(row)
        return self._views.printer(row)

    async def remove_printer(self, printer: str, user: str) -> None:
        """Removes a printer. Raises HubError if it has a run."""
        row = self._parts.printer(printer)
        run = self._store.active_run(printer)
        if run is not None:
            raise HubError.of("hub.state", axis=row.name, value=f"at work on {run.name}")
        with self._store.change(user, f"{row.name} is removed", printer=printer) as change:
            for item in self._store.service_items.values():
                if item.printer == printer:
                    change.remove(item)
            change.remove(row)
        await self._parts.end(printer)

    async def clear(self, printer: str, user: str) -> PrinterView:
        """The bed is empty, as `user` says. Raises HubError while that cannot be true or cannot be
        compared with what the printer has printed."""
        row = self._parts.printer(printer)
        contact, run = self._parts.tasks[printer].contact, self._store.active_run(printer)
        seen = contact.now
        if seen is None:
            condition = contact.condition(asyncio.get_running_loop().time())
            value = condition if condition == "unreachable" else "connecting"
            raise HubError.of("hub.state", axis=row.name, value=value)
        if seen.job is not None or (run is not None and run.state in _SENT):
            raise HubError.of("hub.state", axis=row.name, value="printing")
        with self._store.change(user, f"The bed of {row.name} is clear", printer=printer) as change:
            row = change.set(
                row,
                bed_clear=True,
                cleared_number=last_number(seen),
                cleared_s=self._parts.wall_s(),
                cleared_by=user,
            )
        return self._views.printer(row)

    async def attend(self, printer: str, started: bool | None, user: str) -> PrinterView:
        """The attention is dealt with; `started` says whether a run with an unknown start has
        started. Raises HubError if it must be given. False also gives up the run of an unreachable
        printer, which may never come back."""
        row, run = self._parts.printer(printer), self._store.active_run(printer)
        task, book = self._parts.tasks[printer], self._parts.book
        gone = task.contact.condition(asyncio.get_running_loop().time()) == "unreachable"
        if run is not None and task.start_unknown(run):
            if started is None:
                value = f"where {run.name} has started or not"
                raise HubError.of("hub.state", hint="Say which", axis=row.name, value=value)
            if started:
                book.printing(run, user)
            else:
                book.withdraw(run, "It did not start", user)
        elif run is not None and gone and started is False:
            if run.state is RunState.PRINTING:
                reason = f"{row.name} is unreachable, and {user or 'a user'} has given it up"
                book.over(run, RunState.FAILED, reason, Figures())
            else:
                book.withdraw(run, f"{row.name} is unreachable", user)
            row = self._store.printers[printer]
        what = f"{row.name}: attention given to: {row.attention}"
        with self._store.change(user, what if row.attention else "", printer=printer) as change:
            row = change.set(row, attention="")
        task.wake()
        return self._views.printer(row)

    async def pause(self, printer: str, user: str) -> None:
        """Pauses the print. Raises HubError."""
        row = self._parts.printer(printer)
        self._note(row, "pause", user)
        await self._asked(row, self._parts.tasks[printer].link.pause(user))

    async def resume(self, printer: str, user: str) -> None:
        """Resumes the print. Raises HubError."""
        row = self._parts.printer(printer)
        self._note(row, "resume", user)
        await self._asked(row, self._parts.tasks[printer].link.resume(user))

    async def cancel(self, printer: str, user: str) -> None:
        """Cancels the print or the run; if the printer does not answer now, the run is cancelled
        when it does. Raises HubError for a print of another program."""
        row, run = self._parts.printer(printer), self._store.active_run(printer)
        if run is not None:
            self._parts.book.cancel(run, user)
            self._parts.tasks[printer].wake()
            return
        self._note(row, "cancel", user)
        await self._asked(row, self._parts.tasks[printer].link.cancel(user))

    async def stop(self, printers: Sequence[str], user: str) -> list[Stopped]:
        """Emergency stop of these printers, at the same time. Nothing starts on them until a user
        has attended to them."""
        rows = [self._parts.printer(printer) for printer in printers]
        stops = [asyncio.ensure_future(self._stop(row, user)) for row in rows]
        await asyncio.sleep(0)  # the stops are on their way before anything is written
        failed: HubError | None = None
        for row in rows:
            try:
                with self._store.change(user, f"Stop of {row.name}", printer=row.id) as change:
                    change.set(row, attention=f"Stopped by {user or 'the hub'}")
            except HubError as error:
                failed = error
        stopped = await asyncio.gather(*stops)
        if failed is not None:
            raise failed
        return stopped

    async def picture(self, printer: str) -> bytes:
        """The picture of the running print, PNG; empty if there is none."""
        row = self._parts.printer(printer)
        task = self._parts.tasks[printer]
        seen = task.contact.now
        if seen is None or seen.job is None:
            return b""
        return await self._asked(row, task.link.picture(seen.job.file))

    async def set_power_group(self, name: str, limit_w: float, user: str) -> PowerGroup:
        """Makes or changes a power group. Raises HubError if a printer of it takes more."""
        for row in self._store.printers.values():
            if row.power_group == name and row.heating_w > limit_w:
                self._too_much(row, row.heating_w, limit_w)
        row = self._store.groups.get(name)
        with self._store.change(user, f"Power group {name}: {limit_w:g} W") as change:
            if row is None:
                change.add(GroupRow(name, limit_w))
            else:
                change.set(row, limit_w=limit_w)
        return PowerGroup(name, limit_w, self._parts.dispatcher.used_w().get(name, 0.0))

    async def remove_power_group(self, name: str, user: str) -> None:
        """Removes a power group; its printers have none then. Raises WebError."""
        if name not in self._store.groups:
            raise WebError.of("web.not-found", value=f"power group {name}")
        with self._store.change(user, f"Power group {name} is removed") as change:
            for row in self._store.printers.values():
                if row.power_group == name:
                    change.set(row, power_group="")
            change.remove(self._store.groups[name])

    async def _stop(self, row: PrinterRow, user: str) -> Stopped:
        try:
            await self._parts.tasks[row.id].link.stop(user)
        except Unreachable as error:
            return Stopped(row.id, "unreachable", str(error))
        except Refused as error:
            return Stopped(row.id, "refused", str(error))
        return Stopped(row.id, "done")

    async def _asked(self, row: PrinterRow, answer: Awaitable[_T]) -> _T:
        try:
            return await answer
        except Unreachable as error:
            raise HubError.of("hub.unreachable", axis=row.name, value=str(error)) from None
        except Refused as error:
            raise HubError.of(
                "hub.refused", hint=error.action, axis=row.name, value=str(error)
            ) from None

    def _note(self, row: PrinterRow, what: str, user: str) -> None:
        with self._store.change(user, f"{row.name}: {what}", printer=row.id):
            pass

    def _too_much(self, row: PrinterRow, heating_w: float, limit_w: float) -> None:
        raise HubError.of("hub.power", axis=row.name, value=f"{heating_w:g}", limit=f"{limit_w:g}")
