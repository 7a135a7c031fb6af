"""Calibrates the geometry of a delta from heights of a flat bed and, for its rods, from measured
distances. Each probed point is stored as the distances of the carriages from their endstops, which
do not depend on the unknown parameters. Gauss-Newton steps change the parameters until the nozzle
heights at these points match the bed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, dist, radians, sin, sqrt
from typing import Literal

from passo.errors import CommandError
from passo.geometry.base import Point, Unreachable
from passo.geometry.delta import Delta
from passo.levelling.least_squares import RankError, solve

Factors = Literal[6, 7, 9]
"""The numbers of parameters. 6: radius, angles of towers A and B (the angle of C would only turn
the bed), three endstops. 7: also one length for all rods, which heights hardly determine: 0.01 mm
of noise changes it by 1.3 mm. 9: three rod lengths, only with measured distances."""

_ROUNDS = 10
_DIFFERENCE = 1e-3  # mm or degrees, for derivatives
_SETTLED = 1e-10


@dataclass(frozen=True, slots=True)
class DeltaMachine:
    """A delta geometry, and the position of each carriage at its endstop, mm."""

    geometry: Delta
    endstops: Point

    def drops(self, nozzle: Point) -> Point:
        """How far each carriage is below its endstop with the nozzle at a point, mm. Raises
        Unreachable."""
        a, b, c = self.geometry.inverse(nozzle)
        ea, eb, ec = self.endstops
        return ea - a, eb - b, ec - c

    def nozzle(self, drops: Point) -> Point:
        """The nozzle position, mm, for the drops of the carriages; the inverse of `drops`. Raises
        Unreachable."""
        ea, eb, ec = self.endstops
        a, b, c = drops
        return self.geometry.forward((ea - a, eb - b, ec - c))


@dataclass(frozen=True, slots=True)
class Distance:
    """Two marks of a printed part: the drops of the carriages at each, and the measured distance
    between them, mm."""

    first: Point
    second: Point
    mm: float


_DIRECTIONS = (210.0, 270.0, 330.0, 30.0, 90.0, 150.0)  # of the pillars, degrees
_PILLARS_MM = 65.0  # from the middle
_RIDGE_MM = 4.5  # from the middle of a pillar to its ridge
_WIDTH_OF_CENTER = (0, 2, 1, 0, 2, 1)  # the width across which each distance from the middle is


def printed_distances(
    machine: DeltaMachine,
    center_mm: Sequence[float],
    center_widths_mm: Sequence[float],
    outer_mm: Sequence[float],
    outer_widths_mm: Sequence[float],
    scale: float,
) -> list[Distance]:
    """The 12 distances on Klipper's calibration part, which `machine` has printed: a pillar in the
    middle and six around it. `center_mm` are the distances between the ridges of the middle pillar
    and each outer pillar; `outer_mm` those between each outer pillar and the second one after it.
    Both are in mm and counter-clockwise, from the direction of tower A. A measured distance
    includes one width of a pillar, which is subtracted: `center_widths_mm` are three widths of the
    middle pillar, `outer_widths_mm` one width of each outer pillar. `scale` is the size of the part
    divided by its nominal size. Raises Unreachable."""
    towards = [(cos(radians(a)), sin(radians(a))) for a in _DIRECTIONS]

    def at(x: float, y: float, direction: int, mm: float) -> Point:
        u, v = towards[direction % len(towards)]
        return machine.drops(((x + u * mm) * scale, (y + v * mm) * scale, 0.0))

    found: list[Distance] = []
    far = _PILLARS_MM + _RIDGE_MM
    for i, mm in enumerate(center_mm):
        width = center_widths_mm[_WIDTH_OF_CENTER[i]]
        found.append(Distance(at(0, 0, i, _RIDGE_MM), at(0, 0, i, far), mm - width))
    for i, (mm, width) in enumerate(zip(outer_mm, outer_widths_mm, strict=True)):
        x, y = (_PILLARS_MM * c for c in towards[i])
        found.append(Distance(at(x, y, i + 2, _RIDGE_MM), at(x, y, i + 2, far), mm - width))
    return found


@dataclass(frozen=True, slots=True)
class ChangeLimits:
    """The maximum changes by a calibration; a larger change suggests a mechanical fault."""

    radius_mm: float = 5.0
    angle_deg: float = 3.0
    endstop_mm: float = 5.0
    rod_mm: float = 3.0


@dataclass(frozen=True, slots=True)
class Calibration:
    """The parameters before and after, with the RMS deviation of the heights (and distances),
    mm."""

    before: DeltaMachine
    after: DeltaMachine
    rms_before: float
    rms_after: float

    def changes(self) -> list[tuple[str, float, float]]:
        """Name, value before, value after of each parameter: mm, angles in degrees."""
        names = _names()
        old, new = (_values(machine) for machine in (self.before, self.after))
        return list(zip(names, old, new, strict=True))

    def check(self, limits: ChangeLimits) -> None:
        """Raises CommandError unless the residual falls and every change is within its limit."""
        if self.rms_after > self.rms_before:
            raise CommandError.of(
                "levelling.delta-worse", value=self.rms_after, limit=self.rms_before
            )
        for name, old, new in self.changes():
            limit, unit = {
                "radius": (limits.radius_mm, "mm"),
                "angle": (limits.angle_deg, "degrees"),
                "endstop": (limits.endstop_mm, "mm"),
                "rod": (limits.rod_mm, "mm"),
            }[name.partition(" ")[0]]
            if abs(new - old) > limit:
                raise CommandError.of(
                    "levelling.delta-change",
                    axis=name,
                    before=old,
                    value=new,
                    limit=limit,
                    unit=unit,
                )


def calibrate(
    machine: DeltaMachine,
    heights: Sequence[tuple[Point, float]],
    factors: Factors = 6,
    distances: Sequence[Distance] = (),
) -> Calibration:
    """The parameters with the least squares of residuals. `heights`: the drops of the carriages
    where the nozzle touches the bed, and the height of the bed there, mm. Raises CommandError if
    the points do not determine the parameters, or if the lengths of rods are to be found without
    distances."""
    if factors == 9 and not distances:
        raise CommandError.of("levelling.delta-rods")
    start = [0.0] * factors

    def residuals(step: Sequence[float]) -> list[float]:
        changed = _changed(machine, step)
        found = [changed.nozzle(drops)[2] - z for drops, z in heights]
        for d in distances:
            found.append(dist(changed.nozzle(d.first), changed.nozzle(d.second)) - d.mm)
        return found

    before = residuals(start)
    try:
        step = _gauss_newton(residuals, start)
    except RankError as error:
        raise CommandError.of(
            "levelling.delta-points",
            value=len(before),
            rank=error.rank,
            limit=error.unknowns,
        ) from None
    except Unreachable as error:
        raise CommandError.of("levelling.delta-nowhere", value=error) from None
    after = residuals(step)
    return Calibration(machine, _changed(machine, step), _rms(before), _rms(after))


def _gauss_newton(
    residuals: Callable[[Sequence[float]], list[float]], start: Sequence[float]
) -> list[float]:
    at = list(start)
    for _ in range(_ROUNDS):
        columns: list[list[float]] = []
        for k in range(len(at)):
            high, low = at.copy(), at.copy()
            high[k] += _DIFFERENCE
            low[k] -= _DIFFERENCE
            pairs = zip(residuals(high), residuals(low), strict=True)
            columns.append([(a - b) / (2 * _DIFFERENCE) for a, b in pairs])
        step = solve(list(zip(*columns, strict=True)), [-r for r in residuals(at)])
        at = [a + s for a, s in zip(at, step, strict=True)]
        if max(map(abs, step)) < _SETTLED:
            break
    return at


def _changed(machine: DeltaMachine, step: Sequence[float]) -> DeltaMachine:
    """The machine after a step of the parameters: radius, the first two angles, the endstops, and
    one or three rod lengths."""
    geometry = machine.geometry
    rods = [*step[6:]] if len(step) == 9 else [*step[6:7]] * 3 if len(step) == 7 else [0.0] * 3
    a, b, c = geometry.angles
    ea, eb, ec = machine.endstops
    changed = geometry.model_copy(
        update={
            "radius": geometry.radius + step[0],
            "angles": [a + step[1], b + step[2], c],
            "rods": [rod + mm for rod, mm in zip(geometry.rods, rods, strict=True)],
        }
    )
    return DeltaMachine(changed, (ea + step[3], eb + step[4], ec + step[5]))


def _names() -> list[str]:
    return ["radius", *(f"{what} {m}" for what in ("angle", "endstop", "rod") for m in "ABC")]


def _values(machine: DeltaMachine) -> list[float]:
    geometry = machine.geometry
    return [geometry.radius, *geometry.angles, *machine.endstops, *geometry.rods]


def _rms(residuals: Sequence[float]) -> float:
    return sqrt(sum(r * r for r in residuals) / len(residuals))
