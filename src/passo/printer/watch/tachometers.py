"""Watches the fans with a tachometer."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from passo.errors import MachineError, Problem

if TYPE_CHECKING:
    from passo.config.electronics import Fan, Tachometer
    from passo.errors import PassoError
    from passo.printer.live_rig import LiveRig
    from passo.printer.state import State

_log = logging.getLogger(__name__)

_LASTS_S = 3.0  # a fan must be too slow for this time
_OLD_S = 3.0  # a reading counts for this time


@dataclass(frozen=True, slots=True)
class FanFault:
    """A fan that has power and turns slower than its `min_rpm`."""

    fan: str
    rpm: float
    min_rpm: float

    @property
    def problem(self) -> Problem:
        """The fault as a problem of the catalogue."""
        values = {"axis": self.fan, "value": self.rpm, "limit": self.min_rpm}
        return Problem("fan.slow", values=values)


class Tachometers:
    """The tachometers of one printer's fans. `faults` are those that last; `listeners` are called
    with each new one of a fan that pauses the print."""

    def __init__(self, rig: LiveRig, state: State, halt: Callable[[PassoError, str], None]) -> None:
        self._rig, self._state, self._halt = rig, state, halt
        self._fans = {n: f for n, f in rig.machine.fans.items() if f.tachometer is not None}
        self._slow_since_s: dict[str, float] = {}
        self._loop = asyncio.get_running_loop()
        self.faults: dict[str, FanFault] = {}
        self.listeners: list[Callable[[FanFault], None]] = []

    def rpm(self, fan: str) -> float | None:
        """The revolutions per minute of a fan; None without a recent reading or a tachometer."""
        tachometer = self._rig.machine.fans[fan].tachometer
        if tachometer is None:
            return None
        changes_s = self._rig.connection.count_rate(fan, _OLD_S)
        return None if changes_s is None else changes_s * 30 / tachometer.pulses

    def status(self) -> dict[str, float | None]:
        """The revolutions per minute of the fans with a tachometer."""
        return {name: self.rpm(name) for name in self._fans}

    def time_passed(self) -> None:
        """Takes the reports of the boards, and handles faults that last."""
        if not self._fans:
            return
        self._rig.connection.take_counts()
        now_s = self._loop.time()
        for name, fan in self._fans.items():
            if fan.tachometer is not None and fan.tachometer.min_rpm > 0:
                self._watch(name, fan, fan.tachometer, now_s)

    def _watch(self, name: str, fan: Fan, tachometer: Tachometer, now_s: float) -> None:
        rpm = self.rpm(name)
        if not self._must_turn(name, fan) or (rpm is not None and rpm >= tachometer.min_rpm):
            self._slow_since_s.pop(name, None)
            self.faults.pop(name, None)
            return
        since_s = self._slow_since_s.setdefault(name, now_s)
        if rpm is None or name in self.faults or now_s < since_s + _LASTS_S:
            return
        fault = self.faults[name] = FanFault(name, rpm, tachometer.min_rpm)
        problem = fault.problem
        if tachometer.on_fault == "machine":
            self._halt(MachineError([problem]), problem.sentence)
        elif tachometer.on_fault == "job" and self.listeners:
            for listener in self.listeners:
                listener(fault)
        else:
            self._state.announce(_log, logging.WARNING, str(problem), problem)

    def _must_turn(self, name: str, fan: Fan) -> bool:
        """Whether the fan has power; one that follows a heater, only while that is warm."""
        if self._state.halted or self._rig.queue.interrupted:
            return False
        if self._rig.commands.outputs.fans.get(name, 0.0) <= 0:
            return False
        heaters = self._rig.connection.heaters
        return not fan.warmed_by or any(heaters[n].celsius > fan.above_c for n in fan.warmed_by)
