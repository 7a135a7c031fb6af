"""The work that the planner does on a file of the card. Its functions are picklable, and only the
process that executes them loads what they need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, BinaryIO

from passo.errors import InputError, PassoError

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig
    from passo.job.batch.verdict import Verdict
    from passo.learn.explanation import Explanation
    from passo.library.planning import TakePath
    from passo.printer.unfit_commands import Skips

_PIECE = 1 << 20  # bytes of a file copied at once


def find_verdict(
    machine: MachineConfig,
    skips: Skips,
    saved: Mapping[str, Any],
    name: str,
    source: BinaryIO,
    size: int,
    take_path: TakePath,
) -> Verdict:
    """Like `verdict`."""
    from passo.job.batch.verdict import verdict

    return verdict(machine, source, size, name, skips, take_path, saved)


def find_fitting(
    but: str, most: int, name: str, source: BinaryIO, size: int, _: TakePath
) -> list[str]:
    """Like `fitting`, for all shipped machines but one."""
    from passo.job.batch.verdict import fitting, shipped_printers

    others = (machine for machine in shipped_printers() if machine.name != but)
    return fitting(others, source, size, name, most)


def find_explanation(
    machine: MachineConfig, name: str, line: int, source: BinaryIO, _: int, __: TakePath
) -> Explanation:
    """Like `explain`, for a file that is called `name`."""
    from passo.job.batch.policy import Policy
    from passo.learn.explain import explain

    with TemporaryDirectory(prefix="passo-") as folder:
        path = Path(folder, "file.gcode")  # `name` may be too long for this disk
        try:
            with path.open("wb") as copied:
                copyfileobj(source, copied, _PIECE)
        except OSError as error:
            why = error.strerror or str(error)
            raise InputError.of("output.unwritable", folder, value=why) from None
        try:
            explanation = explain(machine, path, line, Policy())
        except PassoError as error:
            problems = [replace(p, file=name if p.file else "") for p in error.problems]
            raise type(error)(problems) from None
        return replace(explanation, place=f"{name}:{line}")
