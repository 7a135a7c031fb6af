"""Runs a study: computes the cases that have no result yet, and writes the table of all."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from passo.study.plan import Plan
from passo.study.rows import Rows, row_of
from passo.study.table import write_csv

if TYPE_CHECKING:
    from passo.study.case import Case
    from passo.study.engine import Engine
    from passo.study.work import Result


@dataclass(slots=True)
class Progress:
    """How far a study is: its cases, those that are done, and how many of them have each status.
    `reused` cases have results of an earlier run or of an equal case."""

    cases: int
    done: int = 0
    reused: int = 0
    statuses: Counter[str] = field(default_factory=Counter[str])

    def count(self, status: str, cases: int = 1, *, reused: bool = False) -> None:
        """Counts cases that are done."""
        self.done += cases
        self.reused += cases if reused else 0
        self.statuses[status] += cases


Watch = Callable[[Progress, "list[dict[str, Any]]"], None]
"""Called with the progress, and the rows that are new."""


def run_study(
    plan: Plan,
    engine: Engine,
    output: Path,
    workers: int,
    watch: Watch = lambda progress, rows: None,
) -> Progress:
    """Computes the cases whose id `output` does not have, then writes the table. If it is
    interrupted, the rows that are computed stay, and the next run continues. Closes the engine.
    Raises InputError if the results cannot be written, and the errors of the engine."""
    progress = Progress(len(plan.cases))
    try:
        with Rows(output) as rows:
            known = dict(rows.known)
            for case in plan.cases:
                if case.work is None:
                    known[case.id] = case.result
            _compute(plan, engine, workers, rows, known, progress, watch)
    finally:
        engine.close()
    write_csv(output, (row_of(case, known[case.id]) for case in plan.cases))
    return progress


def _compute(
    plan: Plan,
    engine: Engine,
    workers: int,
    rows: Rows,
    known: dict[str, Result],
    progress: Progress,
    watch: Watch,
) -> None:
    """Computes each case without a result once, and adds its result to `known`."""
    equal: dict[str, list[Case]] = {}
    for case in plan.cases:
        if case.id in known:
            progress.count(known[case.id]["status"], reused=case.work is not None)
        else:
            equal.setdefault(case.id, []).append(case)
    watch(progress, [])
    works = (cases[0].work for cases in equal.values())
    shards = plan.shards((w for w in works if w is not None), engine.shard_s, workers)
    for done in _computed(engine, shards):
        new = list(zip((equal[w.id][0] for w in done.shard.works), done.results, strict=True))
        rows.add(new)
        for case, result in new:
            known[case.id] = result
            progress.count(result["status"])
            progress.count(result["status"], len(equal[case.id]) - 1, reused=True)
        watch(progress, [row_of(case, result) for case, result in new])


def _computed(engine: Engine, shards: Iterator[Any]) -> Iterator[Any]:
    """The results of all shards, as they come. At most as many shards as the engine can compute at
    once are in the engine."""
    shard = next(shards, None)
    while shard is not None or engine.busy:
        while shard is not None and engine.free:
            engine.submit(shard)
            shard = next(shards, None)
        yield from engine.completed()
