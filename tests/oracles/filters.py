"""Motion filters in plain Python: the planned position from the moves' own formulas, shaped by sums
of delayed copies, the advance by numerical convolution, and steps by sampling and bisection.

Nothing here knows breakpoints of the filtered law, closed forms or incremental sums.
"""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from math import cos, exp, floor, pi, sin, sqrt

from tests.oracles.motion import HZ, position_at

# Gauss-Legendre nodes and weights on -1..1, exact to degree 11.
_HALF = (
    (0.2386191860831969, 0.4679139345726910),
    (0.6612093864662645, 0.3607615730481386),
    (0.9324695142031521, 0.1713244923791704),
)
_GAUSS = [(sign * x, w) for x, w in _HALF for sign in (-1, 1)]


class Planned:
    """Position of one slot over ticks, and of filament its advance times its speed, from moves."""

    def __init__(self, moves, slot, advance=lambda move: 0.0):
        self.moves = [m for m in moves if m.kind != "dwell"]
        self.starts = [m.start_ticks for m in self.moves]
        self.slot, self.advance = slot, advance

    def _move(self, tick):
        return self.moves[max(bisect_right(self.starts, tick) - 1, 0)]

    def __call__(self, tick):
        m = self._move(tick)
        part = position_at(m, min(max(tick, m.start_ticks), m.end_ticks)) / m.length
        return m.start_mm[self.slot] + (m.end_mm[self.slot] - m.start_mm[self.slot]) * part

    def advanced(self, tick):
        """Advance in s times mm/s of filament."""
        m = self._move(tick)
        if not m.start_ticks <= tick < m.end_ticks:
            return 0.0
        t = (tick - m.start_ticks) / HZ
        t0, t1 = m.accelerate_ticks / HZ, m.cruise_ticks / HZ
        if t < t0:
            speed = m.start_speed + m.acceleration * t
        else:
            speed = m.cruise_speed - m.deceleration * max(t - t0 - t1, 0.0)
        return self.advance(m) * speed * (m.end_mm[self.slot] - m.start_mm[self.slot]) / m.length

    def cuts(self, low, high):
        """Ticks at which the law of the speed changes."""
        found = {low, high}
        for m in self.moves:
            at = m.start_ticks
            for ticks in (0.0, m.accelerate_ticks, m.cruise_ticks, m.decelerate_ticks):
                at += ticks
                if low < at < high:
                    found.add(at)
        return sorted(found)


def shaped(planned, impulses, delay_ticks):
    """Position over ticks: a sum of delayed copies, in the middle `delay_ticks` late."""
    mean = sum(a * t for a, t in impulses)

    def position(tick):
        return sum(a * planned(tick - delay_ticks - (t - mean) * HZ) for a, t in impulses)

    return position


def advanced(planned, half_s, delay_ticks):
    """e, and what is advanced in the mean of a triangle of this half width."""

    def position(tick):
        middle, half = tick - delay_ticks, half_s * HZ
        total = 0.0
        for low, high in ((middle - half, middle), (middle, middle + half)):
            cuts = planned.cuts(low, high)
            for a, b in pairwise(cuts):
                for x, w in _GAUSS:
                    at = 0.5 * (a + b) + 0.5 * (b - a) * x
                    kernel = (half - abs(at - middle)) / half**2
                    total += 0.5 * (b - a) * w * kernel * planned.advanced(at)
        return planned(middle) + total

    return position


def steps(position, start, end, steps_per_mm, every):
    """(tick, direction) of each step between two ticks, sampled each so many ticks. Two turns
    within a sample are not seen."""
    found = []

    def q(tick):
        return position(tick) * steps_per_mm

    n = int((end - start) / every) + 1
    before, at = q(start), start
    for i in range(1, n + 1):
        tick = start + (end - start) * i / n
        here = q(tick)
        first, last = floor(before + 0.5), floor(here + 0.5)
        direction = 1 if last > first else -1
        for count in range(first, last, direction):
            value = count + 0.5 * direction
            low, high = at, tick
            for _ in range(60):
                middle = 0.5 * (low + high)
                if (q(middle) - value) * direction < 0:
                    low = middle
                else:
                    high = middle
            found.append((0.5 * (low + high), direction))
        before, at = here, tick
    return found


def residual(impulses, frequency_hz, damping):
    """What is left of the vibration that one impulse makes, where the mass has this frequency."""
    omega = 2 * pi * frequency_hz
    damped = omega * sqrt(1 - damping**2)
    last = impulses[-1][1]
    parts = [(a * exp(-damping * omega * (last - t)), damped * t) for a, t in impulses]
    return sqrt(sum(a * sin(x) for a, x in parts) ** 2 + sum(a * cos(x) for a, x in parts) ** 2)
