"""What users ask of the queue: files and jobs."""

from __future__ import annotations

from collections.abc import Sequence

from passo.errors import HubError, WebError
from passo.hub.parts import Parts
from passo.hub.printer_wishes import given
from passo.hub.records import JobRow
from passo.hub.view_maker import ViewMaker
from passo.hub.views import FileView, JobView
from passo.hub.wishes import JobChange, NewJob


class JobWishes:
    """The files and the jobs."""

    def __init__(self, parts: Parts, views: ViewMaker) -> None:
        self._parts, self._views, self._store = parts, views, parts.store

    def files(self) -> Sequence[FileView]:
        """All files, newest first."""
        return sorted(self._store.files.values(), key=lambda file: (-file.added_s, file.sha256))

    async def add_file(self, file: FileView, user: str) -> FileView:
        """Adds a file whose content is stored. The same content again keeps the first name."""
        known = self._store.files.get(file.sha256)
        if known is not None:
            return known
        with self._store.change(user, f"File {file.name} is added") as change:
            change.add(file)
        return file

    async def remove_file(self, sha256: str, user: str) -> None:
        """Removes a file. Raises WebError, and HubError if open jobs need it."""
        file = self._file(sha256)
        users = sum(job.file == sha256 for job in self._store.jobs.values())
        if users:
            raise HubError.of("hub.file-used", value=file.name, limit=users)
        with self._store.change(user, f"File {file.name} is removed") as change:
            change.remove(file)

    async def add_job(self, job: NewJob, user: str) -> JobView:
        """Adds a job. Raises WebError for an unknown file or printer."""
        file = self._file(job.file)
        each = tuple(dict.fromkeys(job.each))
        for printer in each:
            self._parts.printer(printer)
        row = JobRow(
            id=self._parts.new_id(),
            number=self._store.next_number(),
            file=job.file,
            name=file.name,
            quantity=len(each) or job.quantity,
            priority=job.priority,
            needs=job.needs,
            tags=tuple(job.tags),
            each=each,
            due_s=job.due_s,
            retries=job.retries,
            added_s=self._parts.wall_s(),
            added_by=user,
        )
        what = f"Job {row.number}: {row.quantity} × {row.name}"
        with self._store.change(user, what, job=row.id) as change:
            change.add(row)
        return self._view(row)

    async def change_job(self, job: str, change: JobChange, user: str) -> JobView:
        """Changes a job. Raises WebError, and HubError for a quantity below what is done or
        running."""
        row, fields = self._parts.job(job), given(change)
        quantity = fields.get("quantity", row.quantity)
        if row.each and quantity != row.quantity:
            raise HubError.of("hub.state", axis=row.name, value="one print on each of its printers")
        if quantity < row.given:
            raise HubError.of("hub.state", axis=row.name, value=f"begun {row.given} times")
        if not fields:
            return self._view(row)
        what = f"Job {row.number}: {', '.join(sorted(fields))} changed"
        with self._store.change(user, what, job=job) as written:
            row = written.set(row, **fields)
            self._parts.book.close(written, row)
        return self._view(row)

    async def cancel_job(self, job: str, user: str) -> None:
        """Ends a job: nothing more of it starts, and its prints are cancelled. Raises WebError."""
        row = self._parts.job(job)
        runs = self._store.runs_of(job).values()
        printers = [run.printer for run in runs if not run.state.over]
        self._parts.book.cancel_job(row, user)
        for printer in printers:
            self._parts.tasks[printer].wake()

    async def pause_queue(self, paused: bool, user: str) -> None:
        """Whether nothing starts."""
        what = "The queue is paused" if paused else "The queue continues"
        with self._store.change(user, what) as change:
            change.setting("queue_paused", "1" if paused else "0")

    def _file(self, sha256: str) -> FileView:
        if sha256 not in self._store.files:
            raise WebError.of("web.not-found", value=f"file {sha256}")
        return self._store.files[sha256]

    def _view(self, row: JobRow) -> JobView:
        return self._views.jobs([row])[0]
