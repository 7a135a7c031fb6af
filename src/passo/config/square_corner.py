"""Klipper's square corner velocity v and the junction deviation δ that gives it at a right angle,
under the acceleration a: v² = a δ s / (1 - s) with s = √½, so δ = v² (√2 - 1) / a."""

from __future__ import annotations

from math import sqrt

_RATIO = sqrt(2) - 1


def deviation_mm(corner_mm_s: float, accel_mm_s2: float) -> float:
    """The junction deviation of a speed at square corners."""
    return corner_mm_s**2 * _RATIO / accel_mm_s2


def corner_mm_s(deviation_mm: float, accel_mm_s2: float) -> float:
    """The speed at square corners of a junction deviation."""
    return sqrt(deviation_mm * accel_mm_s2 / _RATIO)
