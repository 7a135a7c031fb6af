"""The data of a print for a report, collected in bounded memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from itertools import pairwise
from typing import NamedTuple

from passo import _core
from passo.job.batch.simulated_print import Progress
from passo.learn.series import Series
from passo.learn.toolpath import Line, Toolpath

_APART_MM = 2.0  # the planner checks the slopes of a line at the same distance
_FIRST_LOOK_S = 0.1
_MANY_LOOKS = 6000


class Phase(NamedTuple):
    """A part of a move with constant acceleration: times in s, path positions in mm and speeds in
    mm/s at its ends, and the acceleration in mm/s², negative for braking."""

    start_s: float
    end_s: float
    start_mm: float
    end_mm: float
    start: float
    end: float
    acceleration: float


# A function that adds the step rates of a motor in a move: the move, its length in mm, and its
# phases.
Rates = Callable[[Series, _core.Move, float, list[Phase]], None]


def of_axis(slot: int, steps_per_unit: float, extruder: int | None = None) -> Rates:
    """The step rates of a motor that follows one coordinate of a move's positions; an extruder's
    follows E in its own moves."""

    def add(series: Series, move: _core.Move, length_mm: float, phases: list[Phase]) -> None:
        steps_mm = 0.0
        if extruder in (None, move.extruder):
            steps_mm = abs(move.end_mm[slot] - move.start_mm[slot]) / length_mm * steps_per_unit
        _add_even(series, steps_mm, phases)

    return add


def of_actuator(geometry: _core.Geometry, actuator: int, steps_per_unit: float) -> Rates:
    """The step rates of a motor of the geometry. A non-linear one is sampled at points at most
    `_APART_MM` apart."""
    linear = geometry.linear(actuator)

    def add_linear(series: Series, move: _core.Move, length_mm: float, phases: list[Phase]) -> None:
        ends = zip(linear or (), move.start_mm, move.end_mm, strict=False)
        steps_mm = abs(sum(c * (b - a) for c, a, b in ends)) / length_mm * steps_per_unit
        _add_even(series, steps_mm, phases)

    def add(series: Series, move: _core.Move, length_mm: float, phases: list[Phase]) -> None:
        (x0, y0, z0), (x1, y1, z1) = move.start_mm[:3], move.end_mm[:3]
        start, end = (x0, y0, z0), (x1, y1, z1)
        if start == end:
            return _add_even(series, 0.0, phases)
        for phase in phases:
            parts = max(1, math.ceil((phase.end_mm - phase.start_mm) / _APART_MM))
            took_s, a = phase.end_s - phase.start_s, phase.acceleration
            before_s, before = phase.start_s, 0.0
            for i in range(parts + 1):
                tau = took_s * i / parts
                s = phase.start_mm + phase.start * tau + a * tau * tau / 2
                slope = geometry.slopes(actuator, start, end, min(max(s, 0.0), length_mm))[0]
                rate = abs(slope) * (phase.start + a * tau) * steps_per_unit
                if i:
                    series.add(before_s, before, phase.start_s + tau, rate)
                before_s, before = phase.start_s + tau, rate
        return None

    return add if linear is None else add_linear


def _add_even(series: Series, steps_mm: float, phases: list[Phase]) -> None:
    if steps_mm == 0:
        series.add(phases[0].start_s, 0.0, phases[-1].end_s, 0.0)
        return
    for phase in phases:
        series.add(phase.start_s, phase.start * steps_mm, phase.end_s, phase.end * steps_mm)


def length_of(move: _core.Move) -> float:
    """The length of a move in mm, even if its path is measured in steps."""
    start, end = move.start_mm, move.end_mm
    return math.dist(start[:3], end[:3]) or max(abs(b - a) for a, b in zip(start, end, strict=True))


class HeaterSeries:
    """The curves of a heater: temperature and target in °C, and power in percent."""

    def __init__(self) -> None:
        self.celsius, self.target, self.power = Series(), Series(), Series()
        self.last: tuple[float, float] | None = None  # s, °C


class Collector:
    """Collects planned moves and readings in the order of time. Series and path are exact for a
    short job, and their memory is bounded for a long one: see Series and Toolpath."""

    def __init__(self, clock_hz: int, motors: Mapping[str, Rates], path: Toolpath) -> None:
        self._hz = clock_hz
        self._motors = motors
        self.path = path
        self.speed, self.acceleration, self.line = Series(), Series(), Series()
        self.rates = {name: Series() for name in motors}
        self.heaters = dict[str, HeaterSeries]()
        self._looks = 0
        self.look_s = _FIRST_LOOK_S  # interval of readings
        self.looked_s = 0.0  # print time of the last reading

    @property
    def planned_s(self) -> float:
        """The print time, in s, at which the moves so far end."""
        return self.speed.end_s

    def take(self, moves: Iterable[_core.Move]) -> None:
        """Adds settled moves."""
        for move in moves:
            self._rest(move.start_ticks / self._hz)
            if move.kind == "dwell":
                self._rest(move.end_ticks / self._hz)
                continue
            length_mm = length_of(move)
            phases = self._phases(move, length_mm / move.length)
            if not phases:
                continue
            first_s, last_s = phases[0].start_s, phases[-1].end_s
            for start_s, end_s, _, _, start, end, acceleration in phases:
                self.speed.add(start_s, start, end_s, end)
                self.acceleration.add(start_s, acceleration, end_s, acceleration)
            self.line.add(first_s, move.line, last_s, move.line)
            for name, add in self._motors.items():
                add(self.rates[name], move, length_mm, phases)
            if move.kind != "extrude":
                a, b = move.start_mm, move.end_mm
                speed, prints = max(p.end for p in phases), move.kind == "print"
                drawn = Line(move.layer, a[0], a[1], b[0], b[1], speed, prints)
                self.path.add(drawn, b[2], first_s, last_s)

    def look(self, at: Progress) -> None:
        """Adds the current readings. `look_s` grows with the length of the job."""
        self._looks += 1
        if self._looks % _MANY_LOOKS == 0:
            self.look_s *= 2
        self.looked_s = at.print_s
        for name, celsius in at.celsius.items():
            heater = self.heaters.setdefault(name, HeaterSeries())
            if celsius <= 0:  # the sensor has not reported yet
                continue
            if heater.last is not None:
                before_s, before = heater.last
                target, power = at.target_c[name], 100 * at.power[name]
                heater.celsius.add(before_s, before, at.print_s, celsius)
                heater.target.add(before_s, target, at.print_s, target)
                heater.power.add(before_s, power, at.print_s, power)
            heater.last = (at.print_s, celsius)

    def finish(self, end_s: float) -> None:
        """Ends the collection: the machine is at standstill from the last move to `end_s`."""
        self._rest(end_s)

    def _phases(self, move: _core.Move, unit: float) -> list[Phase]:
        """The phases of a move; `unit` is mm per unit of the path."""
        phases, at, mm = list[Phase](), move.start_ticks, 0.0
        speeds = (move.start_speed, move.cruise_speed, move.cruise_speed, move.end_speed)
        lasting = (move.accelerate_ticks, move.cruise_ticks, move.decelerate_ticks)
        for ticks, (start, end) in zip(lasting, pairwise(speeds), strict=True):
            start_s, end_s = at / self._hz, (at + ticks) / self._hz
            took_s = end_s - start_s
            if took_s <= 0:
                continue
            start, end = start * unit, end * unit
            to_mm = mm + (start + end) / 2 * took_s
            a = (end - start) / took_s
            phases.append(Phase(start_s, end_s, mm, to_mm, start, end, a))
            at, mm = at + ticks, to_mm
        return phases

    def _rest(self, until_s: float) -> None:
        if until_s <= self.speed.end_s:
            return
        for series in (self.speed, self.acceleration, *self.rates.values()):
            series.add(series.end_s, 0.0, until_s, 0.0)
        self.line.hold(until_s)
