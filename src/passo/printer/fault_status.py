"""Problems as the status shows them."""

from __future__ import annotations

from collections.abc import Sequence

from passo.errors import Problem
from passo.printer.status import FaultStatus
from passo.printer.unfit_commands import plain_advice


def faults_of(problems: Sequence[Problem]) -> tuple[FaultStatus, ...]:
    """The problems as they are shown."""
    return tuple(
        FaultStatus(
            p.code,
            p.entry.part,
            f"{p.place}: {p.sentence}" if p.place else p.sentence,
            plain_advice(p),
        )
        for p in problems
    )
