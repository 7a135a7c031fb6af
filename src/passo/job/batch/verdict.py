"""Whether a printer can print a file: its plan, or the reasons against it and what would allow
it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from math import prod
from typing import TYPE_CHECKING, Any, BinaryIO

from passo.config.load import load, shipped_machines
from passo.errors import CardError, InputError, PassoError, Problem
from passo.job.batch.estimate import Estimate, estimate_open
from passo.printer.unfit_commands import ALLOWED_BY, Skips

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

_ON_A_DESK = {"linux-test", "stm32f407-discovery", "stm32f429-discovery"}


@dataclass(frozen=True, slots=True)
class Verdict:
    """`problems` are the reasons why a printer refuses the file; empty if it prints it. `allow` are
    the fields of Skips that let it be printed in spite of them; empty if nothing does. `estimate`
    is the plan of that print, or None."""

    estimate: Estimate | None
    problems: tuple[Problem, ...] = ()
    allow: tuple[str, ...] = ()


def verdict(
    machine: MachineConfig,
    source: BinaryIO,
    size: int,
    name: str,
    skips: Skips,
    take_path: Callable[[bytes], None] | None = None,
    saved: Mapping[str, Any] | None = None,
) -> Verdict:
    """Plans an open file of `size` bytes for a printer whose prints may do what `skips` says.
    `take_path` is called with the path of the plan, see toolpath.py. `saved` are the printer's
    variables of SAVE_VARIABLE. Raises CardError if the file cannot be read."""
    problems: list[Problem] = []
    allow: list[str] = []
    while True:
        source.seek(0)
        try:
            found = estimate_open(
                machine,
                source,
                size,
                name,
                skips=skips.allowing(allow),
                take_path=take_path,
                saved=saved,
            )
            return Verdict(found, _by_line(problems), tuple(allow))
        except CardError:
            raise
        except PassoError as error:
            problems += error.problems
            fields = {ALLOWED_BY.get(problem.code, "") for problem in error.problems}
            if "" in fields or fields <= {*allow}:
                return Verdict(None, _by_line(problems))
            allow += sorted(fields - {*allow})


def _by_line(problems: list[Problem]) -> tuple[Problem, ...]:
    return tuple(sorted(problems, key=lambda problem: problem.line or 0))


@cache
def shipped_printers() -> tuple[MachineConfig, ...]:
    """The machines of config/machines/ that have a hotend, the smallest first; without those of a
    board on a desk."""
    machines = [load(name) for name in shipped_machines() if name not in _ON_A_DESK]
    printers = [machine for machine in machines if machine.heaters]
    return tuple(sorted(printers, key=lambda machine: prod(machine.size_mm)))


def fitting(
    machines: Iterable[MachineConfig], source: BinaryIO, size: int, name: str, most: int
) -> list[str]:
    """The names of the first `most` machines that print an open file of `size` bytes. Unknown
    commands count as macros that its owner writes. Raises CardError if the file cannot be read."""
    names: list[str] = []
    for machine in machines:
        if len(names) == most:
            break
        source.seek(0)
        try:
            estimate_open(machine, source, size, name, skips=Skips(unknown=True))
        except InputError:
            continue
        names.append(machine.name)
    return names
