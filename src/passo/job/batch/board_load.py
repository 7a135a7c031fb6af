"""The load of a plan on the board and its link: its maxima, and the places where it exceeds the
budget."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any

from passo.config.budget import COMMAND_BYTES, SURE_COMMANDS_S
from passo.config.pin_names import MAIN

if TYPE_CHECKING:
    from passo.config.board import Board
    from passo.config.machine import MachineConfig

_WIDEST_US = 25.0  # maximum error of a step's time, where that saves commands
_NEAR = 0.8  # fraction of the budget; smaller loads are not reported
_BURST = ", in a burst that is sent ahead"
_NAMES = {
    "steps": "processor{}, for steps",
    "commands": "processor{}, for commands",
    "slots": "move slots{}",
    "link": "link{}",
}
_BOUNDS = {
    "steps": "the processor{} takes in steps",
    "commands": "the processor{} takes in commands",
    "slots": "the move slots{} take",
    "link": "the link{} takes",
}


@dataclass(frozen=True, slots=True)
class Place:
    """A place of a file: its line, and its load as a fraction of the budget. `board` is the board
    with the highest load: empty for the main board, None if there is only one board."""

    line: int
    load: float
    board: str | None = None

    @property
    def of_board(self) -> str:
        """The board as ` of the board tool`; empty if there is only one board."""
        return "" if self.board is None else f" of {_board(self.board)}"


@dataclass(frozen=True, slots=True)
class BudgetUse:
    """The use of the board's budget; empty without a budget. `worst` has, by limit, the place of
    the highest load above the budget. For `widened_s` seconds, steps may deviate from their ideal
    times by up to `tolerance_us`. `densest` has the maximum loads of the final plan: fractions of
    the processor's time for steps and commands, of the link's bytes, and of the move queue, each
    for the board with the highest load. `unsure_s` is a limit in commands per second that is so low
    that some commands may be late even at a lower speed; 0 if all are in time.
    """

    worst: dict[str, Place] = field(default_factory=dict[str, Place])
    widened_s: float = 0.0
    tolerance_us: float = 0.0
    densest: dict[str, Place] = field(default_factory=dict[str, Place])
    unsure_s: float = 0.0

    def report_lines(self, file: str) -> Iterator[str]:
        """The report for consoles before a print: empty without a budget, and without loads that
        the board handles easily."""
        # a full move queue alone does no harm, because the link waits
        named = {"slots", *self.worst}
        near = {k: p for k, p in self.densest.items() if p.load >= _NEAR and k not in named}
        for name, place in near.items():
            yield (
                f"{file}:{place.line} takes {place.load:.0%} of what {_BOUNDS[name]}".format(
                    place.of_board
                )
                + f"{_BURST if place.load > 1 else ''}. If the print stops or stutters there, print"
                " it more slowly or slice it with longer moves"
            )
        for name, place in self.worst.items():
            gets = "lower speed" if name == "steps" else "less even steps or lower speed"
            yield (
                f"{file}:{place.line} asks for {place.load:.2f} times what"
                f" {_BOUNDS[name].format(place.of_board)}, and gets {gets}"
            )
        if self.unsure_s > 0:
            yield f"Commands may come late there all the same: {self.advice}"

    @property
    def advice(self) -> str:
        """The advice for the user if `unsure_s` is not 0."""
        return (
            f"{self.unsure_s:.0f} a second are few. Use a faster link or board, longer moves, or"
            " less acceleration"
        )

    def limits(self) -> Iterator[tuple[str, Place]]:
        """`worst`, with the exceeded limit in words: `the link of the board tool takes`."""
        for name, place in self.worst.items():
            yield _BOUNDS[name].format(place.of_board), place

    def shares(self) -> list[tuple[str, str]]:
        """Pairs of a limit and a text with its load and line; empty without a budget. A load above
        1 is a burst of less than about 0.15 s; the board receives a part of its commands before the
        burst begins."""
        return [
            (
                _NAMES[name].format(place.of_board),
                f"{place.load:.0%} at line {place.line}{_BURST if place.load > 1 else ''}",
            )
            for name, place in self.densest.items()
        ]


def budget_use(plan: Mapping[str, Any], machine: MachineConfig) -> BudgetUse:
    """The budget use of a job on this machine, from the statistics of its plan."""
    return BudgetUse(
        _worst(plan["loads"], machine),
        plan["widened_s"],
        plan["widest_ticks"] * 1e6 / machine.board.clock_hz,
        _densest(plan["densest"], machine),
        _unsure_s(plan["loads"], machine),
    )


def _board(name: str) -> str:
    return "the main board" if name == MAIN else f"the board {name}"


def _worst(loads: Mapping[str, tuple[int, float, int]], machine: MachineConfig) -> dict[str, Place]:
    """For each limit, the load on the board with the highest load."""
    specs, found = machine.budget_specs, dict[str, Place]()
    for kind, (line, load, budget) in loads.items():
        group = machine.budget_groups[budget]
        name = min(group, key=lambda name: specs[name][f"{kind}_s"])
        limit = kind if kind == "steps" else specs[name]["bound"]
        found[limit] = Place(line, load, name if machine.boards else None)
    return found


def _unsure_s(loads: Mapping[str, tuple[int, float, int]], machine: MachineConfig) -> float:
    """The limit of commands per second, if it is low and forces a lower speed; else 0."""
    if "commands" not in loads:
        return 0.0
    _, load, budget = loads["commands"]
    saved = (_WIDEST_US / machine.board.compression_tolerance_us) ** 0.25
    specs = machine.budget_specs
    rate = min(specs[name]["commands_s"] for name in machine.budget_groups[budget])
    return rate if rate < SURE_COMMANDS_S and load > saved else 0.0


def _densest(
    peaks: Mapping[str, list[tuple[int, float]]], machine: MachineConfig
) -> dict[str, Place]:
    """For each limit, the load of the board that has the highest one, by its own motors."""
    specs, found = machine.budget_specs, dict[str, Place]()
    for i, group in enumerate(machine.budget_groups):
        own = {kind: peaks[kind][i] for kind in ("steps_s", "commands_s")}
        for name in group:
            shares = _shares(own, machine.all_boards[name], specs[name]["steps_s"])
            for kind, (line, load) in shares.items():
                if kind not in found or load > found[kind].load:
                    found[kind] = Place(line, load, name if machine.boards else None)
    return {kind: found[kind] for kind in _NAMES if kind in found}


def _shares(
    peaks: Mapping[str, tuple[int, float]], board: Board, most_steps_s: float
) -> dict[str, tuple[int, float]]:
    """Line and fraction of each load of the plan on one board."""
    (step_line, steps_s), (line, commands_s) = peaks["steps_s"], peaks["commands_s"]
    found = {"slots": (line, min(1.0, commands_s * board.ahead_s / board.move_count))}
    if budget := board.budget:
        most_cycles_s = budget.command_share * (budget.cpu_hz or board.clock_hz)
        found["steps"] = step_line, steps_s / most_steps_s
        found["commands"] = line, commands_s * budget.cycles_per_command / most_cycles_s
    if isfinite(board.link_bytes_s):
        asked = commands_s * COMMAND_BYTES + board.commit_bytes_s
        found["link"] = line, asked / board.link_bytes_s
    return found
