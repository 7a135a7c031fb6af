"""Accounts that see and command only some printers: those with one of their tags."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

from msgspec import Struct

from passo.hub.views import Farm, JobView, PrinterView
from passo.web.roles import Role

if TYPE_CHECKING:
    from passo.web.accounts.store import Store
    from passo.web.operation import Caller

Tags: TypeAlias = frozenset[str]

SCHEMA = "create table if not exists limits (subject text primary key, tags text not null);"


class Limit(Struct, frozen=True):
    """The limit of an account, or of an API key as `key NAME`: the tags of its printers."""

    subject: str
    tags: tuple[str, ...]


class Limits:
    """The limits of accounts and keys, in memory; each change is stored before it takes effect."""

    def __init__(self, store: Store) -> None:
        rows = store.rows("select subject, tags from limits")
        self._store = store
        self._tags = {subject: frozenset(json.loads(tags)) for subject, tags in rows}

    @property
    def all(self) -> list[Limit]:
        """All limits, by account."""
        return [Limit(name, tuple(sorted(tags))) for name, tags in sorted(self._tags.items())]

    def of(self, caller: Caller) -> Tags | None:
        """The tags of the caller's printers; None for a caller who sees all, as administrators
        do."""
        if caller.role is Role.ADMIN:
            return None
        return self._tags.get(f"key {caller.name}" if caller.key else caller.name)

    async def set(self, subject: str, tags: Sequence[str]) -> None:
        """Limits an account; without tags, it is limited no more. Raises WebError."""
        if not tags:
            await self._store.write(("delete from limits where subject = ?", (subject,)))
            self._tags.pop(subject, None)
            return
        row = (subject, json.dumps(list(tags)))
        await self._store.write(("insert or replace into limits values (?, ?)", row))
        self._tags[subject] = frozenset(tags)


def sees(tags: Tags | None, printer: PrinterView) -> bool:
    """Whether a caller with these tags sees a printer."""
    return tags is None or not tags.isdisjoint(printer.tags)


def sees_job(tags: Tags | None, job: JobView, printers: frozenset[str]) -> bool:
    """Whether a caller with these tags, who sees these printers, sees a job."""
    return tags is None or not (tags.isdisjoint(job.tags) and printers.isdisjoint(job.each))


def seen(farm: Farm, tags: Tags | None) -> Farm:
    """The part of the farm that a caller with these tags sees."""
    if tags is None:
        return farm
    printers = tuple(printer for printer in farm.printers if sees(tags, printer))
    ids = frozenset(printer.id for printer in printers)
    jobs = tuple(job for job in farm.jobs if sees_job(tags, job, ids))
    names = {printer.power_group for printer in printers}
    groups = tuple(group for group in farm.groups if group.name in names)
    return Farm(printers, jobs, groups, farm.queue_paused)
