"""The move of each Z motor that levels a tilted gantry or bed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, sin

from passo.errors import CommandError
from passo.levelling.fits import MIN_DISTANCE_MM, Point, fit, line_through


def tilt_adjustments(pivots: Sequence[tuple[float, float]], points: Sequence[Point]) -> list[float]:
    """The height of the measured plane at each motor's pivot, mm. Each motor lifts its side of the
    gantry by this height, relative to the motor with the smallest height. If all points are on a
    line, as two points always are, the tilt across the line stays as it is. Raises CommandError for
    fewer than two places."""
    if len(points) < 2:
        raise CommandError.of("levelling.few-points", value=len(points), limit=2, method="tilt")
    angle, width = line_through(points)
    if width >= MIN_DISTANCE_MM:
        plane = fit(points, "linear")
        return [plane.height(x, y) for x, y in pivots]
    n, u, v = len(points), cos(angle), sin(angle)
    along = [x * u + y * v for x, y, _ in points]
    middle, height = sum(along) / n, sum(z for *_, z in points) / n
    square = sum((a - middle) ** 2 for a in along)
    if square < MIN_DISTANCE_MM**2:
        raise CommandError.of(
            "levelling.close-points",
            value=max(along) - min(along),
            limit=MIN_DISTANCE_MM,
            first=1,
            second=2,
        )
    slope = sum((a - middle) * p[2] for a, p in zip(along, points, strict=True)) / square
    return [height + slope * (x * u + y * v - middle) for x, y in pivots]


def gantry_adjustments(
    points: Sequence[Point], corners: tuple[tuple[float, float], tuple[float, float]]
) -> list[float]:
    """The lift of each motor of a gantry on four belts, mm, after which all corners have the same
    height above the bed.

    Points and motors: front left, back left, back right, front right. The third number of a point
    is the nozzle height at the trigger minus the height of the bed. `corners`: X, Y of the first
    and the third corner of the gantry, where its belts are."""
    front_left, back_left, back_right, front_right = points
    (x0, y0), (x1, y1) = corners

    def corner(x: float, y: float) -> float:
        front = _line(front_left[0], front_left[2], front_right[0], front_right[2], x)
        back = _line(back_left[0], back_left[2], back_right[0], back_right[2], x)
        near, far = (front_left, back_left) if x == x0 else (front_right, back_right)
        return _line(near[1], front, far[1], back, y)

    heights = [corner(x0, y0), corner(x0, y1), corner(x1, y1), corner(x1, y0)]
    mean = sum(heights) / 4
    return [mean - height for height in heights]


def lifts(adjustments: Mapping[str, float], max_adjust_mm: float) -> dict[str, float]:
    """The upward move of each motor, mm. The smallest is 0, so that no motor moves down against its
    limit. Raises CommandError if a motor would move by more than `max_adjust_mm` relative to
    another, which may damage the mechanics."""
    lowest = min(adjustments.values())
    found = {name: mm - lowest for name, mm in adjustments.items()}
    motor = max(found, key=lambda name: found[name])
    if found[motor] > max_adjust_mm:
        raise CommandError.of(
            "levelling.motor-adjustment", axis=motor, value=found[motor], limit=max_adjust_mm
        )
    return found


def check_progress(spreads: Sequence[float], motors: Sequence[str]) -> None:
    """Raises CommandError if the spread of the points, mm, is larger in the last round than in the
    round before. Probably the motors and the pivots are not in the same order."""
    if len(spreads) > 1 and spreads[-1] > spreads[-2]:
        raise CommandError.of(
            "levelling.motor-order",
            value=spreads[-1],
            limit=spreads[-2],
            order=", ".join(motors),
        )


def _line(a: float, at_a: float, b: float, at_b: float, x: float) -> float:
    return at_a + (at_b - at_a) * (x - a) / (b - a)
