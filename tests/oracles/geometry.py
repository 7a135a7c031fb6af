"""Step crossings of a line by brute force: sample, find the turns, bisect every half-integer."""

from __future__ import annotations

from itertools import pairwise
from math import dist, floor

SAMPLE_MM = 0.05


def line(start, end):
    """The points of a line by path length in mm."""
    length = dist(start, end)

    def point(s):
        return tuple(a + (b - a) * s / length for a, b in zip(start, end, strict=True))

    return point, length


def turn(q, a, b, sign):
    """Where sign * q is greatest between a and b, by ternary search."""
    for _ in range(100):
        left, right = a + (b - a) / 3, b - (b - a) / 3
        if sign * q(left) < sign * q(right):
            a = left
        else:
            b = right
    return (a + b) / 2


def bisect(q, value, a, b):
    rises = q(b) > q(a)
    for _ in range(60):
        middle = (a + b) / 2
        if (q(middle) < value) == rises:
            a = middle
        else:
            b = middle
    return (a + b) / 2


def crossings(position, length, steps_per_unit):
    """(s, direction) of every step, and how near a turn comes to a step's threshold, in steps."""

    def q(s):
        return position(s) * steps_per_unit

    n = max(2, int(length / SAMPLE_MM))
    knots = [length * i / n for i in range(n + 1)]
    values = [q(s) for s in knots]
    cuts, margin = [0.0], abs(values[0] % 1 - 0.5)
    for i in range(1, n):
        before, here, after = values[i - 1 : i + 2]
        if (here - before) * (after - here) <= 0:
            cuts.append(turn(q, knots[i - 1], knots[i + 1], 1 if here >= before else -1))
    cuts.append(length)
    steps = []
    for a, b in pairwise(cuts):
        margin = min(margin, abs(q(b) % 1 - 0.5))
        first, last = floor(q(a) + 0.5), floor(q(b) + 0.5)
        direction = 1 if last > first else -1
        for count in range(first, last, direction):
            steps.append((bisect(q, count + direction / 2, a, b), direction))
    return steps, margin
