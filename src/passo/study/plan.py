"""Makes the cases of a study, and shards of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.load import load_text, machine_path, text_and_file
from passo.errors import ConfigError, InputError
from passo.study.case import Case, Content, Machines, Order, Work, case_id, content_of
from passo.study.settings import Setting, settings_of
from passo.study.work import Result, Shard, failure, shard_of

if TYPE_CHECKING:
    from passo.study.engine import Engine
    from passo.study.study_file import Study, What

_MAX_CASES = 500  # of a shard
_SHARDS_PER_WORKER = 4  # at least, so that all workers end at about the same time
# Processor time of a case on this many bytes: measured with sliced files, on a slow computer.
_S_PER_BYTE: Mapping[What, float] = {"estimate": 3e-7, "print": 2e-6, "lab": 8e-6}
_S_PER_CASE = 0.002


@dataclass(frozen=True, slots=True)
class Plan:
    """The cases of a study in the order of its rows, and what workers need for them."""

    cases: list[Case]
    machines: Machines
    order: Order

    def shards(self, works: list[Work], engine: Engine) -> Iterator[Shard]:
        """Shards that take about as long as the engine wants, and less if there are too few for all
        its workers. Cases of one file stay together."""
        costs = [_S_PER_CASE + work.file.size * _S_PER_BYTE[self.order.what] for work in works]
        most_s = min(engine.shard_s, sum(costs) / (_SHARDS_PER_WORKER * engine.workers))
        taken: list[Work] = []
        taken_s = 0.0
        for work, cost_s in zip(works, costs, strict=True):
            if taken and (taken_s + cost_s > most_s or len(taken) == _MAX_CASES):
                yield shard_of(tuple(taken), self.machines.pickled, self.order)
                taken, taken_s = [], 0.0
            taken.append(work)
            taken_s += cost_s
        if taken:
            yield shard_of(tuple(taken), self.machines.pickled, self.order)


def plan_study(study: Study, folder: Path) -> Plan:
    """The cases of a study, whose paths are relative to `folder`: by file, machine and setting.
    Raises ConfigError for a wrong machine file, and if no setting fits its machine; InputError for
    a pattern without files, and for keys without values."""
    order = Order(study.what, study.options)
    files = list(_files(study.files, folder))
    settings = list(settings_of(study))
    if not settings:
        empty = next(key for key, values in study.grid.items() if not values)
        raise InputError.of("study.no-settings", key=f"grid.{empty}")
    machines = Machines()
    made = {name: list(_made(name, folder, settings, machines)) for name in study.machines}
    cases = [
        _case(file, content, name, setting, machine, order)
        for file, content in files
        for name, rows in made.items()
        for setting, machine in zip(settings, rows, strict=True)
    ]
    return Plan(cases, machines, order)


def _files(patterns: Iterable[str], folder: Path) -> Iterator[tuple[str, Content | InputError]]:
    """The name and the content of each file, or why it cannot be read; each file once."""
    seen: set[str] = set()
    for pattern in patterns:
        if (folder / pattern).exists():  # a name with brackets is no pattern
            names = [pattern]
        else:
            names = sorted(glob(pattern, root_dir=folder, recursive=True))  # noqa: PTH207
        names = [name for name in names if not (folder / name).is_dir()]
        if not names:
            raise InputError.of("study.no-files", value=pattern)
        for name in names:
            if name not in seen:
                seen.add(name)
                try:
                    yield name, content_of(folder / name)
                except InputError as error:
                    yield name, error


def _made(
    name: str, folder: Path, settings: list[Setting], machines: Machines
) -> Iterator[str | ConfigError]:
    """For each setting the digest of the machine, or the error of a setting that does not fit.
    Raises ConfigError."""
    path = machine_path(name)
    text, file = text_and_file(name if path is None else os.fspath(folder / path))
    made: list[str | ConfigError] = []
    for setting in settings:
        try:
            made.append(machines.add(load_text(text, file, setting)))
        except ConfigError as error:
            made.append(error)
    errors = [error for error in made if isinstance(error, ConfigError)]
    if len(errors) == len(made):
        raise errors[0]
    return iter(made)


def _case(
    file: str,
    content: Content | InputError,
    name: str,
    setting: Setting,
    machine: str | ConfigError,
    order: Order,
) -> Case:
    if isinstance(content, InputError):
        return _failed(file, name, setting, order, failure("input", content.problems[0]))
    if isinstance(machine, ConfigError):
        return _failed(file, name, setting, order, failure("config", machine.problems[0]))
    id_ = case_id(content.sha256, machine, order)
    return Case(file, name, setting, id_, Work(id_, content, machine))


def _failed(file: str, name: str, setting: Setting, order: Order, result: Result) -> Case:
    """A case that needs no computation."""
    id_ = case_id(result["message"], f"{name} {dict(setting)}", order)
    return Case(file, name, setting, id_, None, result)
