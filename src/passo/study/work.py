"""What a worker does: computes the result of each case of a shard. A result is a pure function of
what its id covers: it has no times of the computer, no paths and no host names."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

from passo.errors import ExitStatus, MachineError, Problem, in_words
from passo.job.batch.source import open_source
from passo.study.case import Content, Order, Work, unchanged

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

Result = Mapping[str, Any]
"""The status of a case, and its figures or its error."""


STATUSES: Mapping[str, tuple[str, str]] = {
    "ok": ("the figures are those of `passo estimate`, `passo print` or `passo lab`", ""),
    "input": (
        "the machine cannot print the file; `code`, `line` and `message` give the reason",
        "[errors](errors.md)",
    ),
    "config": ("the machine file does not allow this setting", "change the values of the key"),
    "changed": ("the file has changed while the study ran", "run the study again"),
    "failed": ("the simulated printer halted", "read `message`"),
    "crash": (
        "the process ended twice, the second time alone with this case",
        "raise `--memory`, or report the file",
    ),
    "timeout": ("the case took longer than `--timeout`, alone", "raise `--timeout`"),
    "memory": ("the case needed more memory than `--memory`", "raise `--memory`"),
}
"""Each status with its meaning, and with what the user does, in Markdown."""


class Shard(NamedTuple):
    """Cases that one worker computes one after another. Picklable."""

    works: tuple[Work, ...]
    machines: Mapping[str, bytes]
    order: Order


Compute = Callable[[Shard], list[Result]]
"""Computes the results of a shard, in the order of its cases. Picklable, raises nothing that comes
from a file or a machine."""


def compute(shard: Shard) -> list[Result]:
    """The results of the cases of a shard."""
    return [
        result_of(work.file, _machine(shard.machines[work.machine]), shard.order)
        for work in shard.works
    ]


def result_of(file: Content, machine: MachineConfig, order: Order) -> Result:
    """The result of one case."""
    if not unchanged(file):
        return failure("changed", Problem("study.changed"))
    try:
        return {"status": "ok", **_FIGURES[order.what](file.path, machine, order)}
    except MemoryError:
        return failure("memory", Problem("study.memory"))
    except Exception as error:
        problem = in_words(error).problems[0]
        of_file = problem.entry.status is ExitStatus.BAD_INPUT
        return failure("input" if of_file else "failed", problem)


def failure(status: str, problem: Problem) -> Result:
    """The result of a case that failed."""
    return {
        "status": status,
        "code": problem.code,
        "line": problem.line,
        "message": f"{problem.sentence}. {problem.advice}.",
    }


def load_figures() -> None:
    """Imports what computes the figures."""
    for name in ("estimate", "laboratory", "simulated_print"):
        import_module(f"passo.job.batch.{name}")


@lru_cache(64)
def _machine(pickled: bytes) -> MachineConfig:
    return pickle.loads(pickled)


def _estimate(path: str, machine: MachineConfig, order: Order) -> dict[str, Any]:
    from passo.job.batch.estimate import estimate_open

    options = order.options
    with open_source(path) as source:
        size = os.fstat(source.fileno()).st_size
        found = estimate_open(
            machine, source, size, "", skips=options.skips, checked=not options.assume_ready
        )
    figures = found.as_dict()
    figures["warnings"] = _without_path(found.warnings, "")
    figures["budget"] = _densest(figures["budget"])
    return _without(figures, "file", "machine", "layers_s", "errors")


def _print(path: str, machine: MachineConfig, order: Order) -> dict[str, Any]:
    from passo.job.batch.policy import Policy
    from passo.job.batch.simulated_print import Print

    skips = order.options.skips
    policy = Policy(skips.clamp, skips.ignore_tools, not order.options.assume_ready, skips)
    result = Print(machine, policy).run(path)
    if result.errors:
        raise MachineError.of("study.halted", value=result.errors[0])
    figures = result.as_dict()
    figures["warnings"] = _without_path(figures["warnings"], path)
    figures["budget"] = _densest(figures["budget"])
    return _without(
        figures, "file", "machine", "first_layer", "errors", "cpu_s", "process_peak_rss_mb"
    )


def _lab(path: str, machine: MachineConfig, order: Order) -> dict[str, Any]:
    from dataclasses import asdict

    from passo.job.batch.laboratory import measure
    from passo.job.batch.policy import Policy

    skips = order.options.skips
    trial, warnings = measure(machine, path, Policy(skips.clamp, skips.ignore_tools, skips=skips))
    return {
        "print_time_s": trial.print_time_s,
        **asdict(trial.quality),
        "off_tune_rms_um": trial.off_tune_rms_um,
        "lost": trial.lost,
        "steps": trial.steps,
        "commands": trial.commands,
        "warnings": _without_path(warnings, path),
    }


_FIGURES = {"estimate": _estimate, "print": _print, "lab": _lab}


def _densest(budget: Mapping[str, Any]) -> dict[str, float]:
    return {name: place["load"] for name, place in budget["densest"].items()}


def _without(figures: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in figures.items() if name not in names}


def _without_path(lines: list[str], path: str) -> list[str]:
    """Warnings without the path of the file, because equal files have equal results."""
    return [line.removeprefix(path).lstrip(": ") for line in lines]


def split(shard: Shard) -> Iterator[Shard]:
    """The shards of its single cases."""
    for work in shard.works:
        yield shard_of((work,), shard.machines, shard.order)


def shard_of(works: tuple[Work, ...], machines: Mapping[str, bytes], order: Order) -> Shard:
    """A shard with only the machines of its cases."""
    return Shard(works, {work.machine: machines[work.machine] for work in works}, order)
