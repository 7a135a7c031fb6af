"""What the farm has printed: runs, totals, and the log."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from passo.hub.records import RunRow
from passo.hub.store import RUNS, Store
from passo.hub.views import RunView
from passo.hub.wishes import FarmEvent, PrinterStatistics, Share, Statistics

# A run that was withdrawn has printed nothing.
_PRINTED = "(runs.state in ('done', 'failed') or (runs.state = 'cancelled' and not gives_back))"
_SUMS = (
    "sum(runs.state = 'done'), sum(runs.state = 'failed'), sum(runs.state = 'cancelled'),"
    " coalesce(sum(runs.printed_s), 0.0), coalesce(sum(runs.filament_mm), 0.0)"
)
_MATERIAL = "coalesce(nullif(jobs.needs ->> '$.material', ''), files.materials ->> '$[0]', '')"
_FROM = "from runs join jobs on jobs.id = runs.job left join files on files.sha256 = runs.file"


def _view(row: RunRow) -> RunView:
    return RunView(
        row.id,
        row.job,
        row.file,
        row.name,
        row.printer,
        row.state.value,
        row.attempt,
        row.assigned_s,
        row.started_s,
        row.ended_s,
        row.filament_mm,
        row.printed_s,
        row.reason,
    )


class History:
    """The history. Raises HubError."""

    def __init__(self, store: Store) -> None:
        self._store = store

    async def runs(self, limit: int, printer: str, job: str) -> list[RunView]:
        """The newest runs first; an empty printer or job is all."""
        condition = (
            "where (? = '' or printer = ?) and (? = '' or job = ?)"
            " order by assigned_s desc, rowid desc limit ?"
        )
        rows = self._store.select(RUNS, condition, (printer, printer, job, job, limit))
        return [_view(row) for row in rows]

    async def statistics(self) -> Statistics:
        """The totals of all runs that have printed."""
        printers = tuple(PrinterStatistics(*row) for row in self._sums("runs.printer"))
        return Statistics(
            sum(row.done for row in printers),
            sum(row.failed for row in printers),
            sum(row.cancelled for row in printers),
            sum(row.printed_s for row in printers),
            sum(row.filament_mm for row in printers),
            printers,
            tuple(Share(*row) for row in self._sums(_MATERIAL)),
            tuple(Share(*row) for row in self._sums("jobs.added_by")),
        )

    async def events(self, limit: int) -> list[FarmEvent]:
        """The newest lines of the log first."""
        sql = (
            "select number, time_s, who, what, printer, job, run from events"
            " order by number desc limit ?"
        )
        return [FarmEvent(*row) for row in self._store.query(sql, (limit,))]

    def _sums(self, by: str) -> Iterator[tuple[Any, ...]]:
        sql = f"select {by}, {_SUMS} {_FROM} where {_PRINTED} group by 1 order by 1"
        yield from self._store.query(sql)
