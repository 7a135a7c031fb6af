"""Analog inputs whose readings a board reports often: buttons with resistors, sensors of width."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from passo.board.inputs import InputChange

if TYPE_CHECKING:
    from passo.board.description import AnalogInput

_Values: TypeAlias = Mapping[str, int | bytes]

REPORT = "analog_in_state"


@dataclass(slots=True)
class _State:
    description: AnalogInput
    range: int | None = None  # number of the range at the last reading, -1 for none of them


class AnalogReports:
    """The analog inputs of one board, from its reports. An input of a range changes its level when
    two readings in a row agree."""

    def __init__(self, inputs: Mapping[int, AnalogInput], adc_full: int) -> None:
        """`inputs` has the inputs by the numbers of their objects; `adc_full` is the value of a
        report at full scale."""
        self._states = {oid: _State(entry) for oid, entry in inputs.items()}
        self._full = adc_full
        self.shares: dict[str, float] = {}  # the last reading of each input, of full scale
        self.levels: dict[str, bool] = {}  # of the ranges, as far as they are certain

    @property
    def oids(self) -> set[int]:
        """The numbers of the objects."""
        return set(self._states)

    def take(self, reports: Iterable[tuple[str, _Values]]) -> list[InputChange]:
        """Handles reports of these inputs, oldest first, and returns the changes."""
        found: list[InputChange] = []
        for _, report in reports:
            state = self._states[int(report["oid"])]
            share = newest(report) / self._full
            self.shares[state.description.name] = share
            now = state.description.range_at(share)
            if now == state.range:
                found += self._changes(state.description, now)
            state.range = now
        return found

    def _changes(self, entry: AnalogInput, now: int) -> Iterator[InputChange]:
        """The changes to this range; the old one ends before the new one begins."""
        levels = {name: i == now for i, (name, _, _) in enumerate(entry.ranges)}
        for name, level in sorted(levels.items(), key=lambda row: row[1]):
            was = self.levels.get(name)
            if level != was:
                self.levels[name] = level
                yield InputChange(name, (level,), was is None)


def newest(report: _Values) -> int:
    """The newest reading in a report: older firmware sends one number."""
    data = report.get("values")
    return int.from_bytes(data[-2:], "little") if isinstance(data, bytes) else int(report["value"])
