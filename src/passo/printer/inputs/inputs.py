"""The inputs of a running printer: passes their levels and edges to the parts that use them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.printer.status import InputStatus

if TYPE_CHECKING:
    from passo.motion.rig import Rig


@dataclass(slots=True)
class _Level:
    debounce_s: float
    call: Callable[[bool, bool], None]
    level: bool | None = None  # the level that was passed on last
    new: bool | None = None  # the level of the board, if it differs or is not known yet
    since_s: float = 0.0  # of `new`


class Inputs:
    """The inputs of one printer, by the names that its boards have for them."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._levels: dict[str, _Level] = {}
        self._edges: dict[str, Callable[[int], None]] = {}
        self._changes: dict[str, int] = {}
        # called with each change that a board reports: the input, and whether it is active now
        self.watchers: list[Callable[[str, bool], None]] = []

    @property
    def active(self) -> dict[str, bool]:
        """Whether each input is active, as far as its board has reported it."""
        return {
            name: level
            for connection in self._rig.connection.connections
            for name, level in connection.input_levels.items()
        }

    @property
    def shares(self) -> dict[str, float]:
        """The last reading of each analog input, as a fraction of full scale."""
        return {
            name: share
            for connection in self._rig.connection.connections
            for name, share in connection.analog.shares.items()
        }

    def status(self) -> dict[str, InputStatus]:
        """The inputs of the machine file for the status of the printer."""
        active = self.active
        return {
            name: InputStatus(active.get(name), self._changes.get(name, 0))
            for name in self._rig.machine.input_pins
        }

    def on_level(self, name: str, debounce_s: float, call: Callable[[bool, bool], None]) -> None:
        """Calls `call` with each new level of an input that stays for `debounce_s`, and whether it
        is the first level that is known. True is the active level."""
        self._levels[name] = _Level(debounce_s, call)

    def on_edges(self, name: str, call: Callable[[int], None]) -> None:
        """Calls `call` with the number of changes of an input."""
        self._edges[name] = call

    def time_passed(self) -> None:
        """Handles the reports of the boards. Call this often."""
        connection = self._rig.connection
        if not (self._levels or self._edges or connection.board.analog_inputs):
            return
        now_s = connection.now / connection.board.clock_hz
        for change in connection.input_changes():
            for watcher in self.watchers:
                watcher(change.name, change.levels[-1])
            if not change.first:
                self._changes[change.name] = self._changes.get(change.name, 0) + len(change.levels)
            if change.name in self._edges and not change.first:
                self._edges[change.name](len(change.levels))
            elif (level := self._levels.get(change.name)) is not None:
                level.new, level.since_s = change.levels[-1], now_s
        for level in self._levels.values():
            self._settle(level, now_s)

    @staticmethod
    def _settle(level: _Level, now_s: float) -> None:
        if level.new is None or now_s - level.since_s < level.debounce_s:
            return
        was, level.level, level.new = level.level, level.new, None
        if level.level != was:
            level.call(level.level, was is None)
