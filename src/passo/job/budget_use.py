"""Where a plan asks more of the board and its link than they take, and what became of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Place:
    """The worst place of a file: its line, and how many times the budget it asked for."""

    line: int
    load: float


@dataclass(frozen=True, slots=True)
class BudgetUse:
    """`worst` by limit, "board" or "link", where the budget did not hold what was asked. For
    `widened_s` seconds steps may be farther from their ideal times, by `tolerance_us` at most."""

    worst: dict[str, Place] = field(default_factory=dict[str, Place])
    widened_s: float = 0.0
    tolerance_us: float = 0.0


def budget_use(plan: dict[str, Any], clock_hz: int) -> BudgetUse:
    """From the statistics of a job on a board of this clock."""
    worst = {name: Place(line, load) for name, (line, load) in plan["loads"].items()}
    return BudgetUse(worst, plan["widened_s"], plan["widest_ticks"] * 1e6 / clock_hz)
