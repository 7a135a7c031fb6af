"""Decides which runs begin: jobs to printers, and starts as far as the power allows."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from math import inf

from passo.hub.contact import Contact, bed_is_clear
from passo.hub.matching import Fits, Order, Place, match, reason
from passo.hub.power import Load, Start, admitted, used_w
from passo.hub.printer_task import PrinterTask
from passo.hub.records import JobRow, PrinterRow, RunRow
from passo.hub.run_book import RunBook
from passo.hub.run_state import RunState
from passo.hub.store import Store
from passo.hub.views import Loaded

_S = RunState
_EARLY = (_S.ASSIGNED, _S.UPLOADING, _S.UPLOADED)  # nothing is started yet


class Dispatcher:
    """Acts on what is stored and on what the printers show now. Raises HubError."""

    def __init__(
        self, store: Store, book: RunBook, tasks: Mapping[str, PrinterTask], fits: Fits
    ) -> None:
        """`tasks` are those of all printers."""
        self._store, self._book, self._tasks, self._fits = store, book, tasks, fits

    def settle(self) -> None:
        """Begins all that can begin now."""
        now_s = asyncio.get_running_loop().time()
        self._withdraw(now_s)
        if self._store.queue_paused:
            return
        self._assign(now_s)
        self._start(now_s)

    def why(self, jobs: list[JobRow]) -> dict[str, str]:
        """Why nothing of a job begins now; empty if nothing waits."""
        now_s = asyncio.get_running_loop().time()
        places, known = self._places(now_s), dict[object, str]()
        texts: dict[str, str] = {}
        for job in jobs:
            if job.given >= job.quantity or job.cancelled:
                texts[job.id] = ""
            elif self._store.queue_paused:
                texts[job.id] = "The queue is paused"
            elif job.paused:
                texts[job.id] = "The job is paused"
            else:
                order = self._order(job)
                if order.kind not in known:
                    known[order.kind] = reason(order, places, self._fits)
                texts[job.id] = known[order.kind]
        return texts

    def used_w(self) -> dict[str, float]:
        """The power of the heating printers of each group."""
        return used_w(self._loads())

    def _withdraw(self, now_s: float) -> None:
        """Takes runs away from printers that cannot start them any more."""
        for run in self._store.active_runs:
            if run.state not in _EARLY:
                continue
            printer = self._store.printers[run.printer]
            contact = self._tasks[printer.id].contact
            why = self._unfit(printer, contact, now_s)
            if why or self._store.jobs[run.job].paused:
                self._book.withdraw(run, why or "the job is paused")

    def _unfit(self, printer: PrinterRow, contact: Contact, now_s: float) -> str:
        """Why a run cannot stay on its printer. A connection that was lost just now is no reason:
        the run waits."""
        condition = contact.condition(now_s)
        if condition == "unreachable":
            return "unreachable"
        if contact.now is None:
            return ""
        return self._taken(printer, contact, now_s)

    def _taken(self, printer: PrinterRow, contact: Contact, now_s: float) -> str:
        """Why nothing starts on a printer, whatever its run is."""
        if printer.service:
            return "in service"
        if printer.attention:
            return "needs attention"
        seen = contact.now
        if seen is None:
            condition = contact.condition(now_s)
            return condition if condition == "unreachable" else "connecting"
        if seen.state != "idle":
            return seen.state
        return "" if bed_is_clear(printer, seen) else "bed not cleared"

    def _places(self, now_s: float) -> list[Place]:
        return [self._place(printer, now_s) for printer in self._store.printers.values()]

    def _place(self, printer: PrinterRow, now_s: float) -> Place:
        taken = self._taken(printer, self._tasks[printer.id].contact, now_s)
        run = self._store.active_run(printer.id)
        if run is not None:
            taken = "printing" if run.state is _S.PRINTING else "about to print"
        return Place(printer.id, printer.name, frozenset(printer.tags), printer.loaded, taken)

    def _order(self, job: JobRow) -> Order:
        runs = self._store.runs_of(job.id).values()
        given = frozenset(run.printer for run in runs if not run.gives_back)
        file = self._store.files[job.file]
        material = file.materials[0] if len(set(file.materials)) == 1 else ""
        return Order(
            job.id,
            job.number,
            job.file,
            job.quantity - job.given,
            job.priority,
            job.due_s,
            job.needs,
            Loaded(material=material, nozzle_mm=file.nozzle_mm),
            frozenset(job.tags),
            bool(job.each),
            frozenset(job.each) - given,
            frozenset(run.printer for run in runs if run.state is _S.FAILED),
        )

    def _assign(self, now_s: float) -> None:
        free = [
            self._place(printer, now_s)
            for printer in self._store.printers.values()
            if self._store.is_free(printer.id)
            and not self._taken(printer, self._tasks[printer.id].contact, now_s)
        ]
        if not free:
            return
        orders = [
            self._order(job)
            for job in self._store.jobs.values()
            if job.given < job.quantity and not (job.paused or job.cancelled)
        ]
        for job, printer in match(orders, free, self._fits):
            self._book.assign(self._store.jobs[job], printer)
            self._tasks[printer].wake()

    def _loads(self) -> list[Load]:
        return [
            Load(
                printer.power_group,
                printer.heating_w,
                self._tasks[printer.id].heating(self._store.active_run(printer.id)),
            )
            for printer in self._store.printers.values()
            if printer.power_group
        ]

    def _start(self, now_s: float) -> None:
        ready = sorted(self._ready(now_s), key=self._turn)
        if not ready:
            return
        starts = [
            Start(run.id, printer.power_group, printer.heating_w)
            for run in ready
            if (printer := self._store.printers[run.printer])
        ]
        limits = {group.name: group.limit_w for group in self._store.groups.values()}
        for run in admitted(starts, self._loads(), limits):
            row = self._store.runs[run]
            task = self._tasks[row.printer]
            if task.contact.now is not None:
                self._book.starting(row, task.contact.now)
                task.admit(self._store.runs[run])

    def _ready(self, now_s: float) -> Iterator[RunRow]:
        for run in self._store.active_runs:
            if run.state is _S.UPLOADED:
                printer = self._store.printers[run.printer]
                if not self._taken(printer, self._tasks[printer.id].contact, now_s):
                    yield run

    def _turn(self, run: RunRow) -> tuple[int, float, int, float, str]:
        job = self._store.jobs[run.job]
        due_s = inf if job.due_s is None else job.due_s
        return -job.priority, due_s, job.number, run.assigned_s, run.id
