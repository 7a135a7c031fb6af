"""The transitions of runs, with what they change of jobs and beds: each is one transaction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

from passo.hub.contact import last_number
from passo.hub.records import JobRow, RunRow
from passo.hub.run_state import RunState
from passo.hub.store import Change, Store
from passo.web.summary import Summary

_S = RunState


@dataclass(frozen=True, slots=True)
class Figures:
    """What a print has taken."""

    printed_s: float = 0.0
    filament_mm: float = 0.0


class RunBook:
    """Writes what becomes of runs. Raises WrongState if a run is not where its caller thinks, and
    HubError if nothing can be written."""

    def __init__(
        self, store: Store, wall_s: Callable[[], float], new_id: Callable[[], str]
    ) -> None:
        """`wall_s` is the wall clock; `new_id` makes ids."""
        self._store, self._wall_s, self._new_id = store, wall_s, new_id

    def assign(self, job: JobRow, printer: str) -> RunRow:
        """A new run of a job on a printer."""
        failed = sum(run.state is _S.FAILED for run in self._store.runs_of(job.id).values())
        run = RunRow(
            self._new_id(),
            job.id,
            job.file,
            job.name,
            printer,
            _S.ASSIGNED,
            1 + failed,
            self._wall_s(),
        )
        with self._change(run, "", f"The run is assigned to {self._name(run)}") as change:
            change.add(run)
            change.set(job, given=job.given + 1)
        return run

    def upload(self, run: RunRow) -> None:
        """The upload begins; one that was lost begins again."""
        with self._change(run, "", "") as change:
            if run.state is _S.UPLOADING:
                change.move(run, _S.UPLOADING, _S.ASSIGNED)
            change.move(run, _S.ASSIGNED, _S.UPLOADING)

    def uploaded(self, run: RunRow, path: str) -> None:
        """The printer has the file."""
        with self._change(run, "", f"{self._name(run)} has the file") as change:
            change.move(run, _S.UPLOADING, _S.UPLOADED, path=path)

    def starting(self, run: RunRow, seen: Summary) -> None:
        """The start is about to be sent. From now on, the bed is not clear."""
        printer = self._store.printers[run.printer]
        with self._change(run, "", f"The start is sent to {printer.name}") as change:
            change.move(run, _S.UPLOADED, _S.STARTING, number_before=last_number(seen))
            change.set(printer, bed_clear=False)

    def printing(self, run: RunRow, user: str = "") -> None:
        """The printer has confirmed the start."""
        with self._change(run, user, f"{self._name(run)} prints") as change:
            change.move(run, _S.STARTING, _S.PRINTING, started_s=self._wall_s())

    def over(
        self,
        run: RunRow,
        state: RunState,
        reason: str,
        figures: Figures,
        cleared_number: int | None = None,
    ) -> None:
        """The run has ended: done, failed or cancelled. After a failure the printer needs the
        attention of a user, and if there are retries, the copy is printed again. `cleared_number`
        is the number of this print if the printer has cleared its bed itself."""
        job, printer = self._store.jobs[run.job], self._store.printers[run.printer]
        again = state is _S.FAILED and not job.cancelled and self._failures(job) < job.retries
        what = f"The print on {printer.name} is {state.value}" + (f": {reason}" if reason else "")
        with self._change(run, run.cancelled_by, what) as change:
            change.move(
                run,
                run.state,
                state,
                ended_s=self._wall_s(),
                reason=reason,
                gives_back=again,
                filament_mm=figures.filament_mm,
                printed_s=figures.printed_s,
            )
            change.set(
                printer,
                prints=printer.prints + 1,
                printed_s=printer.printed_s + figures.printed_s,
                filament_mm=printer.filament_mm + figures.filament_mm,
            )
            if state is _S.FAILED:
                change.set(printer, attention=reason or "A print failed")
            if cleared_number is not None:
                change.set(printer, bed_clear=True, cleared_number=cleared_number, cleared_by="")
            self._give(change, job, again)

    def withdraw(self, run: RunRow, reason: str, user: str = "") -> None:
        """Ends a run that has printed nothing; another one prints its copy, unless a user has
        cancelled it."""
        job = self._store.jobs[run.job]
        again = not job.cancelled and not run.cancelled_by
        with self._change(run, user, f"The run leaves {self._name(run)}: {reason}") as change:
            change.move(
                run,
                run.state,
                _S.CANCELLED,
                ended_s=self._wall_s(),
                reason=reason,
                gives_back=again,
            )
            self._give(change, job, again)

    def cancel(self, run: RunRow, user: str) -> None:
        """A user does not want this run. If its start may have been sent, this is a wish: the
        printer must confirm the end."""
        with self._change(run, user, f"{self._name(run)} is to cancel its run") as change:
            self._cancel(change, run, user)
            self.close(change, self._store.jobs[run.job])

    def cancel_job(self, job: JobRow, user: str) -> None:
        """A user does not want this job: nothing more of it starts, and its runs are cancelled."""
        with self._store.change(user, f"Job {job.number} is cancelled", job=job.id) as change:
            job = change.set(job, cancelled=True)
            for run in self._store.runs_of(job.id).values():
                if not run.state.over:
                    self._cancel(change, run, user)
            self.close(change, job)

    def _cancel(self, change: Change, run: RunRow, user: str) -> None:
        if run.state in (_S.STARTING, _S.PRINTING):
            change.set(run, cancelled_by=user)
        else:
            change.move(run, run.state, _S.CANCELLED, ended_s=self._wall_s(), cancelled_by=user)

    def close(self, change: Change, job: JobRow) -> None:
        """Ends a job if nothing of it is left to do."""
        if not job.cancelled and job.given < job.quantity:
            return
        runs = [change.now(run) for run in self._store.runs_of(job.id).values()]
        if not all(run.state.over for run in runs):
            return
        states = Counter(run.state.value for run in runs if not run.gives_back)
        states["cancelled"] += max(job.quantity - job.given, 0)
        ends = ", ".join(f"{n} {state}" for state, n in sorted(states.items()) if n)
        change.set(job, over_s=self._wall_s())
        change.note(f"Job {job.number} is over: {ends}", job=job.id)

    def _give(self, change: Change, job: JobRow, again: bool) -> None:
        if again:
            job = change.set(job, given=job.given - 1)
        self.close(change, job)

    def _failures(self, job: JobRow) -> int:
        runs = self._store.runs_of(job.id).values()
        return sum(run.state is _S.FAILED and run.gives_back for run in runs)

    def _name(self, run: RunRow) -> str:
        printer = self._store.printers.get(run.printer)
        return printer.name if printer is not None else run.printer

    def _change(self, run: RunRow, user: str, what: str) -> AbstractContextManager[Change]:
        return self._store.change(user, what, printer=run.printer, job=run.job, run=run.id)
