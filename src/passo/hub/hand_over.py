"""Hands the runs of one printer over to it: upload, start, and what becomes of them.

A start is stored before it is sent. If its answer is lost, the printer is asked about this run; it
is sent again only if the printer has certainly not received it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from passo.hub.contact import Contact, last_number
from passo.hub.link import Link, Refused, RunReport, StartUnknown
from passo.hub.records import RunRow
from passo.hub.run_book import Figures, RunBook
from passo.hub.run_state import RunState
from passo.hub.store import RUNS, Store
from passo.printer.status import LastPrint

_S = RunState
_OVER = {"done": _S.DONE, "cancelled": _S.CANCELLED, "failed": _S.FAILED}


def _is_of(last: LastPrint, run: RunRow) -> bool:
    """Whether this is the print of a run; without ids of runs, by its file and its number."""
    same_file = last.file == run.path and last.number != run.number_before
    return last.run == run.id or (not last.run and same_file)


class HandOver:
    """The runs of one printer. All methods raise Unreachable and HubError; the next connection
    continues from what is stored."""

    def __init__(
        self,
        printer: str,
        link: Link,
        contact: Contact,
        store: Store,
        book: RunBook,
        content: Callable[[str], Path],
    ) -> None:
        """`content` is the path of a file, by its SHA-256."""
        self._printer, self._link, self._contact = printer, link, contact
        self._store, self._book, self._content = store, book, content
        self._unknown = ""  # the run of which a user must say whether it has started
        self._unsent = ""  # the run whose start was stored by this program, and not sent yet
        self._figures: tuple[str, Figures] = ("", Figures())
        self._cancelled = ""  # the run that was cancelled through this connection
        self._started_after = 0  # the summaries that were received before the start was confirmed

    def reconnected(self) -> None:
        """The connection is a new one: answers may have been lost."""
        self._unsent = self._cancelled = ""
        self._started_after = 0

    def admit(self, run: RunRow) -> None:
        """The start of a run is stored; it is sent for the first time by the next step."""
        self._unsent = run.id

    def unknown(self, run: RunRow) -> bool:
        """Whether it is unknown if this run has started."""
        return self._unknown == run.id

    async def step(self) -> None:
        """Does what is next for the run of the printer."""
        await self._cancel_stray()
        before = None
        while (run := self._store.active_run(self._printer)) is not None and run.state != before:
            before = run.state
            if run.state in (_S.ASSIGNED, _S.UPLOADING):
                await self._upload(run)
            elif run.state is _S.STARTING:
                await self._start(run)
            elif run.state is _S.PRINTING:
                await self._follow(run)

    async def _upload(self, run: RunRow) -> None:
        self._book.upload(run)
        content = self._content(run.file)
        if not content.is_file():
            uploading = self._current(run, _S.UPLOADING)
            if uploading is not None:
                self._book.over(uploading, _S.FAILED, f"The hub has lost {run.name}", Figures())
            return
        try:
            path = await self._link.upload(content, run.name, run.file)
        except Refused as refusal:
            if (now := self._current(run, _S.UPLOADING)) is not None:
                self._book.over(now, _S.FAILED, f"The upload failed: {refusal}", Figures())
            return
        if (now := self._current(run, _S.UPLOADING)) is not None:
            self._book.uploaded(now, path)

    async def _start(self, run: RunRow) -> None:
        if run.id != self._unsent and not await self._is_unknown(run):
            return
        self._unsent = ""
        now = self._current(run, _S.STARTING)
        if now is None or self._withdrawn(now):
            return
        try:
            await self._link.start(run.id, run.path, self._store.jobs[run.job].added_by)
        except Refused as refusal:
            if (now := self._current(run, _S.STARTING)) is not None:
                self._book.over(now, _S.FAILED, f"The start was refused: {refusal}", Figures())
            return
        except StartUnknown:
            self._doubt(run)
            return
        if (now := self._current(run, _S.STARTING)) is not None:
            self._started_after = self._contact.received
            self._book.printing(now)

    async def _is_unknown(self, run: RunRow) -> bool:
        """Whether the printer has certainly not received the start."""
        try:
            report = await self._link.report(run.id)
        except StartUnknown:
            self._doubt(run)
            return False
        if report is None:
            return True
        if (now := self._current(run, _S.STARTING)) is not None:
            self._book.printing(now)
        return False

    def _withdrawn(self, run: RunRow) -> bool:
        """Takes back a run that the printer has not received, if it must not start now."""
        seen, printer = self._contact.now, self._store.printers[self._printer]
        if run.cancelled_by:
            self._book.withdraw(run, "It was cancelled before it started", run.cancelled_by)
        elif (
            seen is None
            or seen.state != "idle"
            or last_number(seen) != run.number_before
            or printer.attention
            or printer.service
        ):
            reason = "The printer has not received the start, and is not free now"
            self._book.withdraw(run, reason)
        else:
            return False
        return True

    async def _follow(self, run: RunRow) -> None:
        seen = self._contact.now
        if seen is None or self._contact.received == self._started_after:
            return
        if seen.job is not None and seen.job.run == run.id:
            self._figures = run.id, Figures(seen.job.printed_s, seen.job.filament_mm)
            await self._cancel(run)
            return
        last = seen.last_print
        if last is not None and last.run == run.id:
            self._end(run, _OVER[last.result], last.reason)
            return
        try:
            report = await self._link.report(run.id)
        except StartUnknown:
            report = self._report_by_name(run)
        if (now := self._current(run, _S.PRINTING)) is None:
            return
        if report is None:
            self._end(now, _S.FAILED, "The printer does not know this run any more")
        elif report.state in _OVER:
            self._end(now, _OVER[report.state], report.reason)
        elif now.cancelled_by:
            await self._cancel(now)

    def _report_by_name(self, run: RunRow) -> RunReport | None:
        """What becomes of a run on a printer that keeps no ids of runs: what it prints now, or has
        printed since, if that is the file of the run."""
        seen = self._contact.now
        if seen is None:
            return None
        if seen.job is not None:
            if seen.job.file != run.path:
                return None
            self._figures = run.id, Figures(seen.job.printed_s, seen.job.filament_mm)
            return RunReport("printing")
        last = seen.last_print
        if last is None or not _is_of(last, run):
            return None
        return RunReport(last.result, last.reason)

    def _end(self, run: RunRow, state: RunState, reason: str) -> None:
        seen, printer = self._contact.now, self._store.printers[self._printer]
        of, figures = self._figures
        if of != run.id:
            figures = Figures()
        last = None if seen is None else seen.last_print
        empty = (
            printer.clears_itself
            and state is _S.DONE
            and last is not None
            and _is_of(last, run)
            and seen is not None
            and seen.job is None
        )
        number = last.number if empty and last is not None else None
        if state is _S.FAILED:
            reason = reason or (
                seen.fault.text if seen is not None and seen.fault else "The print failed"
            )
        self._book.over(run, state, reason, figures, number)

    async def _cancel(self, run: RunRow) -> None:
        if not run.cancelled_by or self._cancelled == run.id:
            return
        self._cancelled = run.id
        try:
            await self._link.cancel(run.cancelled_by)
        except Refused:
            self._cancelled = ""  # the print ends just now, or cannot be cancelled yet

    async def _cancel_stray(self) -> None:
        """Ends the print of a run that is withdrawn: its start was on the way for long."""
        seen = self._contact.now
        if seen is None or seen.job is None or seen.job.run in ("", self._cancelled):
            return
        active = self._store.active_run(self._printer)
        if active is not None and active.id == seen.job.run:
            return
        rows = self._store.select(RUNS, "where id = ?", (seen.job.run,))
        if rows and rows[0].state is _S.CANCELLED:
            self._cancelled = seen.job.run
            await self._link.cancel(rows[0].cancelled_by)

    def _current(self, run: RunRow, state: RunState) -> RunRow | None:
        """The run as it is stored now, if it is still in this state after a wait."""
        now = self._store.active_run(self._printer)
        return now if now is not None and now.id == run.id and now.state is state else None

    def _doubt(self, run: RunRow) -> None:
        """A user must say if a run has started."""
        if self._current(run, _S.STARTING) is None:
            return
        self._unknown = run.id
        text = f"Nobody knows whether {run.name} has started: look at the printer"
        printer = self._store.printers[self._printer]
        if printer.attention != text:
            with self._store.change("", text, printer=printer.id) as change:
                change.set(printer, attention=text)
