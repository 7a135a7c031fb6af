"""Runs a study: computes the cases that have no result yet, and writes the table of all."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.study.plan import Plan
from passo.study.rows import Rows, row_of
from passo.study.table import write_table

if TYPE_CHECKING:
    from passo.study.cache import Cache
    from passo.study.case import Case
    from passo.study.engine import Done, Engine
    from passo.study.work import Result, Shard


@dataclass(slots=True)
class Progress:
    """How far a study is: its cases, those that are done, and how many of them have each status.
    `reused` cases have the result of an earlier run, of another study, or of an equal case."""

    cases: int
    done: int = 0
    reused: int = 0
    statuses: dict[str, int] = field(default_factory=dict[str, int])

    def count(self, status: str, cases: int = 1, *, reused: bool = False) -> None:
        """Counts cases that are done."""
        self.done += cases
        self.reused += cases if reused else 0
        self.statuses[status] = self.statuses.get(status, 0) + cases


Watch = Callable[[Progress, "list[dict[str, Any]]"], None]
"""Called with the progress, and with the rows that are new."""


def run_study(
    plan: Plan,
    engine: Engine,
    output: Path,
    watch: Watch = lambda progress, rows: None,
    cache: Cache | None = None,
) -> list[dict[str, Any]]:
    """Computes the cases that neither `output` nor the cache has, then writes the table. Returns
    the rows. If it is interrupted, the rows that are computed stay, and the next run continues.
    Closes the engine. Raises InputError if the results cannot be written, and the errors of the
    engine."""
    try:
        with Rows(output) as rows:
            known = _Run(plan, rows, cache, watch).compute(engine)
    finally:
        engine.close()
    found = [row_of(case, known[case.id]) for case in plan.cases]
    write_table(output, found)
    return found


class _Run:
    """The results of one run by the id of their case, and its progress."""

    def __init__(self, plan: Plan, rows: Rows, cache: Cache | None, watch: Watch) -> None:
        self._plan, self._rows, self._cache, self._watch = plan, rows, cache, watch
        self._known = dict(rows.known)
        self._progress = Progress(len(plan.cases))
        self._missing: dict[str, list[Case]] = {}

    def compute(self, engine: Engine) -> dict[str, Result]:
        """Computes each missing result once, and returns all."""
        self._reuse()
        works = [work for equal in self._missing.values() if (work := equal[0].work) is not None]
        shards = self._plan.shards(works, engine)
        for done in _computed(engine, shards):
            results = dict(zip((w.id for w in done.shard.works), done.results, strict=True))
            self._keep(results)
            if self._cache is not None:
                self._cache.add(results)
        return self._known

    def _reuse(self) -> None:
        """Takes the results that need no computation."""
        for case in self._plan.cases:
            if case.id in self._known:
                self._progress.count(self._known[case.id]["status"], reused=True)
            else:
                self._missing.setdefault(case.id, []).append(case)
        self._watch(self._progress, [])
        known = {id_: equal[0].result for id_, equal in self._missing.items() if equal[0].result}
        self._keep(known)
        if self._cache is not None:
            self._keep(
                self._cache.found(id_ for id_ in self._missing if id_ not in known), reused=True
            )
        for id_ in self._missing.keys() & self._known.keys():
            del self._missing[id_]

    def _keep(self, results: Mapping[str, Result], *, reused: bool = False) -> None:
        """Writes new rows."""
        if not results:
            return
        rows: list[dict[str, Any]] = []
        for id_, result in results.items():
            equal = self._missing[id_]
            self._known[id_] = result
            self._progress.count(result["status"], reused=reused)
            self._progress.count(result["status"], len(equal) - 1, reused=True)
            rows.append(row_of(equal[0], result))
        self._rows.add(rows)
        self._watch(self._progress, rows)


def _computed(engine: Engine, shards: Iterator[Shard]) -> Iterator[Done]:
    """The results of all shards, as they come. At most as many shards as the engine can compute at
    once are in the engine."""
    shard = next(shards, None)
    while shard is not None or engine.busy:
        while shard is not None and engine.free:
            engine.submit(shard)
            shard = next(shards, None)
        yield from engine.completed()
