"""Steps of motors along polynomials of time, in plain Python with 40 digits: sample the position,
find the turns, bisect every half-integer."""

from __future__ import annotations

from decimal import Decimal, getcontext
from itertools import pairwise
from math import floor

from tests.oracles.geometry import bisect, turn

getcontext().prec = 40
SAMPLES = 400


def polynomial(coefficients):
    """Position by seconds, both Decimal, from coefficients as they are in binary."""
    exact = [Decimal(c) for c in coefficients]

    def position(t):
        total = Decimal(0)
        for c in reversed(exact):
            total = total * t + c
        return total

    return position


def linear(row, coefficients):
    """Position of an actuator that is a fixed sum of axes."""
    axes = [polynomial(c) for c in coefficients]

    def position(t):
        return sum((Decimal(c) * axis(t) for c, axis in zip(row, axes, strict=True)), Decimal(0))

    return position


def tower(x, y, rod, coefficients):
    """Carriage of a linear delta: z + √(rod² - (x tower - x)² - (y tower - y)²)."""
    px, py, pz = (polynomial(c) for c in coefficients[:3])
    x, y, rod = Decimal(x), Decimal(y), Decimal(rod)

    def position(t):
        dx, dy = x - px(t), y - py(t)
        return pz(t) + (rod * rod - dx * dx - dy * dy).sqrt()

    return position


def actuator(inverse, index, coefficients):
    """An actuator by the geometry's inverse in Python, which is as exact as a float."""
    axes = [polynomial(c) for c in coefficients[:3]]

    def position(t):
        return Decimal(inverse(tuple(float(axis(t)) for axis in axes))[index])

    return position


def step_times(position, seconds, steps_per_unit):
    """(seconds, direction) of each step from t = 0 to `seconds`, and how near in steps a turn comes
    to the threshold of a step, or an end to that of rounding: there one pair more or less is right
    too."""
    scale = Decimal(steps_per_unit)

    def q(t):
        return position(t) * scale

    seconds = Decimal(seconds)
    knots = [seconds * i / SAMPLES for i in range(SAMPLES + 1)]
    values = [q(t) for t in knots]
    cuts = [knots[0]]
    for i in range(1, SAMPLES):
        before, here, after = values[i - 1 : i + 2]
        if (here - before) * (after - here) <= 0 and before != here:
            cuts.append(turn(q, knots[i - 1], knots[i + 1], 1 if here >= before else -1))
    cuts.append(seconds)
    margin = min(abs(q(t) % 1 - Decimal("0.5")) for t in cuts)
    steps = []
    for a, b in pairwise(cuts):
        first, last = floor(q(a) + Decimal("0.5")), floor(q(b) + Decimal("0.5"))
        direction = 1 if last > first else -1
        for count in range(first, last, direction):
            value = Decimal(count) + Decimal(direction) / 2
            steps.append((bisect(q, value, a, b), direction))
    return steps, float(margin)
