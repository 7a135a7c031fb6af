"""What a plan asks of the board and its link: at its densest place, and where that is too much."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any

from passo.config.budget import COMMAND_BYTES

if TYPE_CHECKING:
    from passo.config.board import Board

_HORIZON_S = 0.15  # commands for so long ahead are on the board
_COMMITTED_S = 0.2  # the same where motion comes in commits

_BURST = ", in a burst that is sent ahead"


@dataclass(frozen=True, slots=True)
class Place:
    """A place of a file: its line, and what it asks for as a share of what there is."""

    line: int
    load: float


@dataclass(frozen=True, slots=True)
class BudgetUse:
    """`worst` by limit, "board" or "link", where the budget did not hold what was asked. For
    `widened_s` seconds steps may be farther from their ideal times, by `tolerance_us` at most.

    `densest`: of the plan as it is, the share of the processor's time for steps and for commands,
    of the link's bytes, and of the board's slots; `commits` is the share of the link's bytes that
    brake tails take whenever the machine moves. Empty without a budget.
    """

    worst: dict[str, Place] = field(default_factory=dict[str, Place])
    widened_s: float = 0.0
    tolerance_us: float = 0.0
    densest: dict[str, Place] = field(default_factory=dict[str, Place])
    commits: float = 0.0

    def told(self, file: str) -> Iterator[str]:
        """What a console should hear before a print: nothing without a budget."""
        if self.densest:
            told = "; ".join(f"{name} {share}" for name, share in self.shares())
            yield f"At its densest the file takes of the board: {told}"
        for name, place in self.worst.items():
            yield (
                f"{file}:{place.line} asks for {place.load:.2f} times what the {name} takes,"
                " and gets less even steps or lower speed"
            )

    def shares(self) -> list[tuple[str, str]]:
        """What is taken, and the share with its line; nothing without a budget. More than there is,
        in some 0.15 s, is a burst: the plan sends a part of it ahead."""
        names = {
            "steps": "processor, for steps",
            "commands": "processor, for commands",
            "slots": "move slots",
            "link": "link",
        }
        found = [
            (
                names[name],
                f"{place.load:.0%} at line {place.line}{_BURST if place.load > 1 else ''}",
            )
            for name, place in self.densest.items()
        ]
        if self.commits > 0:
            found.append(("link, for brake tails", f"{self.commits:.0%} in all moves"))
        return found


def budget_use(plan: Mapping[str, Any], board: Board) -> BudgetUse:
    """From the statistics of a job on this board."""
    worst = {name: Place(line, load) for name, (line, load) in plan["loads"].items()}
    link = board.link_bytes_s
    return BudgetUse(
        worst,
        plan["widened_s"],
        plan["widest_ticks"] * 1e6 / board.clock_hz,
        _densest(plan["densest"], board),
        board.commit_bytes_s / link if board.budget and isfinite(link) else 0.0,
    )


def _densest(peaks: Mapping[str, tuple[int, float]], board: Board) -> dict[str, Place]:
    budget = board.budget
    if budget is None:
        return {}
    cpu_hz = budget.cpu_hz or board.clock_hz
    (step_line, steps_s), (line, commands_s) = peaks["steps_s"], peaks["commands_s"]
    ahead_s = _COMMITTED_S if board.survives else _HORIZON_S
    found = {
        "steps": Place(step_line, steps_s * budget.cycles_per_step / cpu_hz),
        "commands": Place(line, commands_s * budget.cycles_per_command / cpu_hz),
        "slots": Place(line, min(1.0, commands_s * ahead_s / board.move_count)),
    }
    if isfinite(board.link_bytes_s):
        asked = commands_s * COMMAND_BYTES + board.commit_bytes_s
        found["link"] = Place(line, asked / board.link_bytes_s)
    return found
