"""Skew of the axes, from the diagonals of a printed square."""

from __future__ import annotations

from math import acos, atan, degrees, pi, sqrt, tan

from passo.errors import CommandError


def skew_factor(ac: float, bd: float, ad: float) -> float:
    """The tangent of the angle by which two axes deviate from a right angle. It follows from the
    diagonals AC and BD and the side AD of a printed parallelogram, mm. Raises CommandError if no
    parallelogram has these lengths."""
    square = 2 * ac**2 + 2 * bd**2 - 4 * ad**2
    side = sqrt(square) / 2 if square > 0 and ad > 0 else 0.0
    cosine = (ac**2 - side**2 - ad**2) / (2 * side * ad) if side else 2.0
    if not -1 < cosine < 1:
        raise CommandError.of("levelling.skew", value=f"{ac:g}, {bd:g}, {ad:g} mm")
    return tan(pi / 2 - acos(cosine))


def skew_degrees(factor: float) -> float:
    """The angle, in degrees, by which the axes deviate from a right angle."""
    return degrees(atan(factor))
