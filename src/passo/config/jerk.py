"""The jerk limit: the time over which positions are averaged, and the distance by which it cuts
corners.

The mean of a position over a time w has the acceleration (v(t + w/2) - v(t - w/2)) / w and the jerk
(a(t + w/2) - a(t - w/2)) / w. So an axis that accelerates and brakes by at most A has a jerk of at
most 2 A / w."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from passo.config.shapers import Impulses

MAX_BOX_S = 0.15
MAX_JERK = 1e9  # mm/s³


def box_s(accel: float, jerk_mm_s3: float) -> float:
    """The time over which all positions are averaged, s, in whole nanoseconds, so that no axis that
    accelerates by at most `accel`, mm/s², exceeds the jerk limit. 0 for no limit."""
    return round(2 * accel / jerk_mm_s3 * 1e9) / 1e9 if jerk_mm_s3 > 0 else 0.0


def least_jerk(accel: float) -> float:
    """The lowest limit of jerk, mm/s³: the positions are averaged over MAX_BOX_S."""
    return 2 * accel / MAX_BOX_S


def spread_mm(box_s: float, impulses: Impulses, accel: float) -> float:
    """The deviation of an axis from the plan, mm, in the middle of a long constant acceleration,
    mm/s². The impulses are those of its shaper."""
    mean = sum(weight * at for weight, at in impulses)
    variance = box_s**2 / 12 + sum(weight * (at - mean) ** 2 for weight, at in impulses)
    return 0.5 * accel * variance


def right_angle_mm(box_s: float, impulses: Sequence[Impulses], accel: float, speed: float) -> float:
    """The maximum distance by which a corner of 90° is cut, mm, if both axes brake to this speed
    (mm/s) with this acceleration (mm/s²) and the next line begins in the same way. The impulses are
    those of the shapers of the axes; the largest result counts."""
    one = (*impulses, [(1.0, 0.0)])
    distances = [_cut_mm(box_s, of, accel, speed, end) for of in one for end in (-1.0, 1.0)]
    return sqrt(2) * max(distances)


def _cut_mm(box_s: float, impulses: Impulses, accel: float, speed: float, end: float) -> float:
    """The distance after the corner, or before it if `end` is negative: its mean over the time that
    the filters average."""
    mean = sum(weight * at for weight, at in impulses)
    moments = [(weight, (at - mean) * end) for weight, at in impulses]

    def distance(seconds: float) -> float:
        s = max(seconds, 0.0)
        return s * (speed + 0.5 * accel * s)

    def integral(seconds: float) -> float:
        s = max(seconds, 0.0)
        return s * s * (0.5 * speed + accel * s / 6)

    if box_s == 0:
        return sum(weight * distance(at) for weight, at in moments)
    half = 0.5 * box_s
    return sum(w * (integral(at + half) - integral(at - half)) / box_s for w, at in moments)
