"""The queue of the farm: jobs, runs, and whether anything starts."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct, UnsetType
from msgspec.structs import replace

from passo.hub.call import HubCall
from passo.hub.views import JobView, RunView
from passo.hub.wishes import FarmEvent, JobChange, NewJob, Statistics
from passo.web.operation import operation
from passo.web.roles import Role

_JOB = ("web.not-found", "hub.state", "hub.store", "hub.limited")


class QueueState(Struct, forbid_unknown_fields=True):
    """Whether nothing starts."""

    paused: bool


class RunQuery(Struct, forbid_unknown_fields=True):
    """The greatest number of runs; the printer and the job whose runs they are, all by default."""

    limit: Annotated[int, Meta(ge=1, le=1000)] = 100
    printer: str = ""
    job: str = ""


class EventQuery(Struct, forbid_unknown_fields=True):
    """The greatest number of lines."""

    limit: Annotated[int, Meta(ge=1, le=1000)] = 100


@operation("jobs.list", "GET", "/jobs", Role.VIEWER)
async def jobs(call: HubCall) -> list[JobView]:
    """The jobs that are not done, in the order of the queue."""
    return list(call.view().jobs)


@operation("jobs.add", "POST", "/jobs", Role.OPERATOR, errors=_JOB, status=201)
async def add(call: HubCall, body: NewJob) -> JobView:
    """Adds a job: so many prints of a file, on printers that fit, or one on each named printer. Its
    runs start as soon as a printer fits, is idle, and its bed is clear."""
    call.file(body.file)
    for printer in body.each:
        call.printer(printer)
    tags = body.tags if body.each else call.require_tags(body.tags)
    quantity = len(body.each) or body.quantity
    return await call.farm.add_job(replace(body, tags=tags, quantity=quantity), call.user)


@operation("jobs.change", "PATCH", "/jobs/{id}", Role.OPERATOR, errors=_JOB)
async def change(call: HubCall, id: str, body: JobChange) -> JobView:
    """Changes a job. Runs that have begun stay as they are."""
    call.own_job(id)
    if not isinstance(body.tags, UnsetType):
        body = replace(body, tags=call.require_tags(body.tags))
    return await call.farm.change_job(id, body, call.user)


@operation("jobs.cancel", "DELETE", "/jobs/{id}", Role.OPERATOR, errors=_JOB)
async def cancel(call: HubCall, id: str) -> None:
    """Ends a job: nothing more of it starts, and its prints are cancelled."""
    call.own_job(id)
    await call.farm.cancel_job(id, call.user)


@operation("queue.pause", "PUT", "/queue", Role.OPERATOR, errors=("hub.limited", "hub.store"))
async def pause(call: HubCall, body: QueueState) -> QueueState:
    """Pauses the queue, so that nothing starts, or resumes it. Running prints continue."""
    call.require_no_limit("the queue of the whole farm")
    await call.farm.pause_queue(body.paused, call.user)
    return body


@operation("runs.list", "GET", "/runs", Role.VIEWER, errors=("web.not-found",))
async def runs(call: HubCall, query: RunQuery) -> list[RunView]:
    """The runs of the hub, the newest first."""
    if query.printer:
        call.printer(query.printer)
    found = await call.farm.runs(query.limit, query.printer, query.job)
    if call.tags is None:
        return found
    seen = {printer.id for printer in call.view().printers}
    return [run for run in found if run.printer in seen]


@operation("statistics.get", "GET", "/statistics", Role.VIEWER)
async def statistics(call: HubCall) -> Statistics:
    """The totals of the hub's runs, of all and of each printer that the caller sees."""
    found = await call.farm.statistics()
    if call.tags is None:
        return found
    seen = {printer.id for printer in call.view().printers}
    rows = tuple(row for row in found.printers if row.printer in seen)
    return Statistics(
        sum(row.done for row in rows),
        sum(row.failed for row in rows),
        sum(row.cancelled for row in rows),
        sum(row.printed_s for row in rows),
        sum(row.filament_mm for row in rows),
        rows,
    )


@operation("events.list", "GET", "/events", Role.VIEWER)
async def events(call: HubCall, query: EventQuery) -> list[FarmEvent]:
    """The log of the farm: who did what when, the newest first."""
    found = await call.farm.events(query.limit)
    if call.tags is None:
        return found
    seen = {printer.id for printer in call.view().printers}
    return [event for event in found if event.printer in seen]
