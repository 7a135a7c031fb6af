"""The view of the farm, made from what is stored and what the printers show."""

from __future__ import annotations

import asyncio
from collections import Counter

from passo.hub.parts import Parts
from passo.hub.records import JobRow, PrinterRow
from passo.hub.run_state import RunState
from passo.hub.service import due_items
from passo.hub.views import Farm, JobView, PowerGroup, PrinterView


class ViewMaker:
    """Makes the view. It stays until something changes."""

    def __init__(self, parts: Parts) -> None:
        self._parts, self._store = parts, parts.store
        self._view: Farm | None = None
        parts.store.listeners.append(self._outdate)
        parts.listeners.insert(0, self._outdate)

    def view(self) -> Farm:
        """The farm at this moment."""
        if self._view is None:
            used_w = self._parts.dispatcher.used_w()
            self._view = Farm(
                tuple(
                    self.printer(printer)
                    for printer in self._store.printers.values()
                    if printer.id in self._parts.tasks
                ),
                tuple(self.jobs(list(self._store.jobs.values()))),
                tuple(
                    PowerGroup(group.name, group.limit_w, used_w.get(group.name, 0.0))
                    for group in self._store.groups.values()
                ),
                self._store.queue_paused,
            )
        return self._view

    def printer(self, row: PrinterRow) -> PrinterView:
        """A printer."""
        now_s = asyncio.get_running_loop().time()
        task, run = self._parts.tasks[row.id], self._store.active_run(row.id)
        return PrinterView(
            id=row.id,
            name=row.name,
            url=row.url,
            kind=row.kind,
            condition=task.contact.condition(now_s),
            bed_clear=row.bed_clear,
            tags=row.tags,
            loaded=row.loaded,
            attention=row.attention,
            run="" if run is None else run.id,
            power_group=row.power_group,
            heating_w=row.heating_w,
            service=row.service,
            clears_itself=row.clears_itself,
            seen=task.contact.seen,
            prints=row.prints,
            printed_s=row.printed_s,
            filament_mm=row.filament_mm,
            service_due=due_items(row, self._store.service_items),
            cleared_by=row.cleared_by,
            cleared_s=row.cleared_s,
            last_word_s=task.contact.last_word_s(now_s),
            start_unknown=task.start_unknown(run),
        )

    def jobs(self, rows: list[JobRow]) -> list[JobView]:
        """Open jobs."""
        why = self._parts.dispatcher.why(rows)
        return [self._job(row, why[row.id]) for row in rows]

    def _job(self, row: JobRow, why: str) -> JobView:
        runs = self._store.runs_of(row.id).values()
        # A run that was withdrawn has printed nothing: its copy waits again.
        states = Counter(
            run.state for run in runs if not (run.gives_back and run.state is RunState.CANCELLED)
        )
        left = max(row.quantity - row.given, 0)
        return JobView(
            id=row.id,
            file=row.file,
            name=row.name,
            quantity=row.quantity,
            priority=row.priority,
            needs=row.needs,
            tags=row.tags,
            each=row.each,
            due_s=row.due_s,
            retries=row.retries,
            paused=row.paused,
            added_s=row.added_s,
            added_by=row.added_by,
            waiting=0 if row.cancelled else left,
            running=sum(not run.state.over for run in runs),
            done=states[RunState.DONE],
            failed=states[RunState.FAILED],
            cancelled=states[RunState.CANCELLED] + (left if row.cancelled else 0),
            why=why,
        )

    def _outdate(self) -> None:
        self._view = None
