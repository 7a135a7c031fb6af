"""Inputs that a board samples and reports when they change: switches, buttons, pulses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from passo.board.description import Input, inverted

GROUP_SIZE = 8  # inputs that a board samples together
SAMPLE_S = 0.002  # interval of the samples; a level counts if two in a row agree
RETRANSMIT_COUNT = 50  # samples until the board reports states again that are not acknowledged
SETTLING_S = 0.2  # after this time without a report, all inputs of a group are released

_COUNTS = 256  # the board counts acknowledged states in a byte


class InputChange(NamedTuple):
    """The levels that an input had one after the other since the last call, and whether they are
    the first after the start or after a lost link. True is the active level."""

    name: str
    levels: tuple[bool, ...]
    first: bool


def groups_of(inputs: Iterable[Input]) -> tuple[tuple[Input, ...], ...]:
    """The inputs in groups that a board samples together."""
    rest = tuple(inputs)
    return tuple(rest[i : i + GROUP_SIZE] for i in range(0, len(rest), GROUP_SIZE))


def inversion(group: Iterable[Input]) -> int:
    """The inverted inputs of a group, as a bit for each."""
    return sum(1 << i for i, entry in enumerate(group) if inverted(entry.pin))


@dataclass(slots=True)
class _Group:
    names: tuple[str, ...]
    received: int = 0  # states of this query, modulo 256
    reported: int = 0  # the last state, as a bit for each input
    fresh: bool = True  # the levels are not certain yet
    certain_at: int = 0  # clock of this board


class InputReports:
    """The inputs of one board, from its reports. Until the first report or `SETTLING_S` after the
    question, the levels are those from before."""

    def __init__(self, groups: Mapping[int, tuple[Input, ...]]) -> None:
        """`groups` has the inputs of each object of the board, by its number."""
        self._groups = {oid: _Group(tuple(i.name for i in g)) for oid, g in groups.items()}
        self.levels: dict[str, bool] = {}  # of the inputs whose level is known

    def asked_anew(self, certain_at: int) -> None:
        """Call this when the board has been asked to report its inputs; from the board's clock
        `certain_at` on, an input without a report is released."""
        for group in self._groups.values():
            group.received, group.reported = 0, 0
            group.fresh, group.certain_at = True, certain_at

    def take(self, oid: int, acknowledged: int, states: bytes) -> tuple[int, list[InputChange]]:
        """Handles a report. Returns the number of states that the host has to acknowledge, and the
        changes."""
        group = self._groups[oid]
        # The board repeats states whose acknowledgement is still on its way.
        new = states[(group.received - acknowledged) % _COUNTS :]
        group.received = (group.received + len(new)) % _COUNTS
        return len(new), self._changes(group, new)

    def settled(self, clock: int) -> list[InputChange]:
        """The changes of groups that are certain at this board's clock without a report."""
        found: list[InputChange] = []
        for group in self._groups.values():
            if group.fresh and clock >= group.certain_at:
                found += self._changes(group, bytes((group.reported,)))
        return found

    def _changes(self, group: _Group, states: bytes) -> list[InputChange]:
        if not states:
            return []
        first, group.fresh = group.fresh, False
        group.reported = states[-1]
        return list(self._named(group.names, states, first=first))

    def _named(
        self, names: tuple[str, ...], states: bytes, *, first: bool
    ) -> Iterator[InputChange]:
        for i, name in enumerate(names):
            was = self.levels.get(name)
            levels: list[bool] = []
            for state in states:
                level = bool(state >> i & 1)
                if level != was:
                    levels.append(level)
                was = level
            if levels:
                self.levels[name] = levels[-1]
                yield InputChange(name, tuple(levels), first)
