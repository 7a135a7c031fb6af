"""What a report shows of a print, gathered in bounded memory."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from passo import _core
from passo.job.batch.simulated_print import Progress

_MOST_PATHS = 120_000  # lines drawn at most, over all layers
_BUCKETS = 1200  # columns of the charts over time
_MOST_READINGS = 3000  # of the temperature of each heater
_APART_MM = 2.0  # where the planner looks at the slopes of a line, too


# How many steps a motor makes for each mm of a move's path, where they are most.
Density = Callable[[_core.Move], float]


def of_axis(slot: int, steps_per_unit: float, extruder: int | None = None) -> Density:
    """Of a motor that follows one place of a move's positions; an extruder's follows E in its own
    moves."""

    def density(move: _core.Move) -> float:
        if extruder not in (None, move.extruder):
            return 0.0
        return abs(move.end_mm[slot] - move.start_mm[slot]) / move.length * steps_per_unit

    return density


def of_actuator(geometry: _core.Geometry, actuator: int, steps_per_unit: float) -> Density:
    """Of a motor of the geometry: where it is most of places `_APART_MM` apart."""

    def density(move: _core.Move) -> float:
        (x0, y0, z0), (x1, y1, z1) = move.start_mm[:3], move.end_mm[:3]
        start, end = (x0, y0, z0), (x1, y1, z1)
        way = math.dist(start, end)
        if way == 0:
            return 0.0
        parts = math.ceil(way / _APART_MM)
        places = (way * i / parts for i in range(parts + 1))
        slope = max(abs(geometry.slopes(actuator, start, end, s)[0]) for s in places)
        return slope * way / move.length * steps_per_unit

    return density


def way_mm(move: _core.Move) -> float:
    """How far a move goes, in mm also where its path is measured in steps."""
    ways = [abs(end - start) for start, end in zip(move.start_mm, move.end_mm, strict=True)]
    return math.hypot(*ways[:3]) or max(ways)


@dataclass(slots=True)
class Bucket:
    """One column of the charts: the largest values within it, mm/s, mm/s² and steps/s."""

    speed: float = 0.0
    accel: float = 0.0
    rates: dict[str, float] = field(default_factory=dict[str, float])


class Collector:
    """Takes planned moves in order. Lines and temperatures are thinned by half whenever they get
    too many, and the columns over time are joined in pairs, so that memory stays the same for any
    file."""

    def __init__(self, clock_hz: int, motors: dict[str, Density]) -> None:
        self._hz = clock_hz
        self._motors = motors
        self._every, self._count = 1, 0
        self.bucket_s = 0.25
        self.buckets: list[Bucket] = []
        self.celsius: dict[str, list[tuple[float, float]]] = {}  # (s, °C) of each heater
        self._reading_s = 0.5  # from one to the next
        # (layer, x0, y0, x1, y1, mm/s, prints)
        self.paths: list[tuple[int, float, float, float, float, float, bool]] = []

    def take(self, moves: list[_core.Move]) -> None:
        """Adds settled moves."""
        for move in moves:
            self._chart(move)
            if move.kind in ("dwell", "extrude"):
                continue
            self._count += 1
            if self._count % self._every == 0:
                a, b = move.start_mm, move.end_mm
                prints = move.kind == "print"
                speed = move.cruise_speed * way_mm(move) / move.length
                self.paths.append((move.layer, a[0], a[1], b[0], b[1], speed, prints))
                if len(self.paths) > _MOST_PATHS:
                    self.paths = self.paths[::2]
                    self._every *= 2

    def look(self, at: Progress) -> None:
        """Adds the temperatures of a moment."""
        for name, celsius in at.celsius.items():
            rows = self.celsius.setdefault(name, [])
            told = celsius > 0  # the sensor has spoken
            if told and (not rows or at.print_s >= rows[-1][0] + self._reading_s):
                rows.append((at.print_s, celsius))
        if any(len(rows) > _MOST_READINGS for rows in self.celsius.values()):
            self._reading_s *= 2
            self.celsius = {name: rows[::2] for name, rows in self.celsius.items()}

    def _chart(self, move: _core.Move) -> None:
        first = int(move.start_ticks / self._hz / self.bucket_s)
        last = int(move.end_ticks / self._hz / self.bucket_s)
        while last >= 2 * _BUCKETS:
            self._join()
            first, last = first // 2, last // 2
        while len(self.buckets) <= last:
            self.buckets.append(Bucket())
        if move.kind == "dwell":
            return
        unit = way_mm(move) / move.length
        speed = move.cruise_speed * unit
        accel = max(abs(move.acceleration), move.deceleration) * unit
        rates = {name: of(move) * move.cruise_speed for name, of in self._motors.items()}
        for bucket in self.buckets[first : last + 1]:
            bucket.speed = max(bucket.speed, speed)
            bucket.accel = max(bucket.accel, accel)
            for name, rate in rates.items():
                bucket.rates[name] = max(bucket.rates.get(name, 0.0), rate)

    def _join(self) -> None:
        pairs = [self.buckets[i : i + 2] for i in range(0, len(self.buckets), 2)]
        self.buckets = [
            Bucket(
                max(b.speed for b in pair),
                max(b.accel for b in pair),
                {name: max(b.rates.get(name, 0.0) for b in pair) for name in self._motors},
            )
            for pair in pairs
        ]
        self.bucket_s *= 2
