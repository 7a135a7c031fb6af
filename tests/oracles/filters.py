"""Motion filters in plain Python: the planned position from the moves' own formulas, shaped by sums
of delayed copies, the advance by numerical convolution, and steps by sampling and bisection.

Nothing here knows breakpoints of the filtered law, closed forms or incremental sums.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from itertools import accumulate, pairwise
from math import cos, exp, floor, pi, sin, sqrt

from tests.oracles.motion import HZ, position_at

# Gauss-Legendre nodes and weights on -1..1, exact to degree 11.
_HALF = (
    (0.2386191860831969, 0.4679139345726910),
    (0.6612093864662645, 0.3607615730481386),
    (0.9324695142031521, 0.1713244923791704),
)
_GAUSS = [(sign * x, w) for x, w in _HALF for sign in (-1, 1)]
_GAUSS_2 = (-sqrt(1 / 3), sqrt(1 / 3))  # exact to degree 3, both of the weight 1


class Planned:
    """Position of one slot over ticks, and of filament its advance times its speed, from moves.
    Above the speed of each of the `knees` the speed counts less, by a share."""

    def __init__(self, moves, slot, advance=lambda move: 0.0, knees=()):
        self.moves = [m for m in moves if m.kind != "dwell"]
        self.starts = [m.start_ticks for m in self.moves]
        self.slot, self.advance, self.knees = slot, advance, knees
        self.breaks = sorted(
            m.start_ticks + ticks
            for m in self.moves
            for ticks in (
                0.0,
                m.accelerate_ticks,
                m.accelerate_ticks + m.cruise_ticks,
                m.accelerate_ticks + m.cruise_ticks + m.decelerate_ticks,
                *self._bends(m),
            )
        )

    def _bends(self, m):
        """Ticks of the move at which its filament has the speed of a knee."""
        part = (m.end_mm[self.slot] - m.start_mm[self.slot]) / m.length
        for knee, _ in self.knees if part > 0 else ():
            if m.acceleration != 0:
                ticks = (knee / part - m.start_speed) / m.acceleration * HZ
                if 0 < ticks < m.accelerate_ticks:
                    yield ticks
            ticks = (m.cruise_speed - knee / part) / m.deceleration * HZ
            if 0 < ticks < m.decelerate_ticks:
                yield m.accelerate_ticks + m.cruise_ticks + ticks

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
        speed *= (m.end_mm[self.slot] - m.start_mm[self.slot]) / m.length
        counts, share = speed, 1.0
        for knee, less in self.knees:
            counts -= (share - less) * max(speed - knee, 0.0)
            share = less
        return self.advance(m) * counts

    def cuts(self, low, high):
        """Ticks at which the law of the speed changes."""
        inside = self.breaks[bisect_right(self.breaks, low) : bisect_left(self.breaks, high)]
        return [low, *inside, high]


class Share(Planned):
    """The part of the filament that moves with X, with Y, or with neither: each move's is divided
    by its direction squared."""

    def __init__(self, moves, axis, advance, knees=()):
        super().__init__(moves, 3, advance, knees)
        self.shares = [self._share(m, axis) for m in self.moves]
        ways = [m.end_mm[3] - m.start_mm[3] for m in self.moves]
        steps = [way * share for way, share in zip(ways, self.shares, strict=True)]
        self.begins = list(accumulate(steps, initial=0.0))

    @staticmethod
    def _share(move, axis):
        squares = [(b - a) ** 2 for a, b in zip(move.start_mm, move.end_mm, strict=True)][:3]
        whole = sum(squares)
        of = [square / whole if whole else 0.0 for square in squares[:2]]
        return [*of, 1.0 - sum(of)][axis]

    def _number(self, tick):
        return max(bisect_right(self.starts, tick) - 1, 0)

    def __call__(self, tick):
        k = self._number(tick)
        return self.begins[k] + self.shares[k] * (
            super().__call__(tick) - self.moves[k].start_mm[3]
        )

    def advanced(self, tick):
        return self.shares[self._number(tick)] * super().advanced(tick)


def shaped(planned, impulses, delay_ticks):
    """Position over ticks: a sum of delayed copies, in the middle `delay_ticks` late."""
    mean = sum(a * t for a, t in impulses)

    def position(tick):
        return sum(a * planned(tick - delay_ticks - (t - mean) * HZ) for a, t in impulses)

    return position


def averaged(planned, box_ticks):
    """The mean of a planned law over so many ticks, from half of them before to half of them
    after. Its integral is that of Gauss, between breakpoints."""
    breaks, before = planned.breaks, [0.0]

    def integral(a, b):
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        return half * sum(planned(middle + half * x) for x in _GAUSS_2)

    for a, b in pairwise(breaks):
        before.append(before[-1] + integral(a, b))

    def up_to(tick):
        k = max(bisect_right(breaks, tick) - 1, 0)
        return before[k] + integral(breaks[k], tick)

    return lambda tick: (up_to(tick + 0.5 * box_ticks) - up_to(tick - 0.5 * box_ticks)) / box_ticks


def advanced(planned, half_s, delay_ticks, box_ticks=0.0):
    """e, or its mean over a box, and what is advanced in the mean of a triangle of this half width;
    where the box is wider than that, in the mean of it and of a box of the half width."""
    h = half_s * HZ
    wide = max(h, box_ticks)
    out, flat = 0.5 * (wide + h), 0.5 * (wide - h)
    filament = averaged(planned, box_ticks) if box_ticks else planned

    def position(tick):
        middle = tick - delay_ticks
        total = 0.0
        for low, high in ((-out, -flat), (-flat, flat), (flat, out)):
            cuts = planned.cuts(middle + low, middle + high) if low < high else []
            for a, b in pairwise(cuts):
                for x, w in _GAUSS:
                    at = 0.5 * (a + b) + 0.5 * (b - a) * x
                    kernel = min(h, out - abs(at - middle)) / (wide * h)
                    total += 0.5 * (b - a) * w * kernel * planned.advanced(at)
        return filament(middle) + total

    return position


def led(position, start, end, gap_mm, over_mm, cuts=(), every=600):
    """Position over ticks of a motor that takes up a gap: what it moves in each of many small
    intervals counts, in proportion, until the gap is taken up in that direction. `cuts`: ticks at
    which its speed may change at once."""
    n = int((end - start) / every) + 1
    ticks = sorted({*(start + (end - start) * i / n for i in range(n + 1)), *cuts})
    places, leads = [position(ticks[0])], [0.0]

    def after(lead, mm):
        return min(max(lead + mm * gap_mm / over_mm, 0.0), gap_mm)

    for tick in ticks[1:]:
        places.append(position(tick))
        leads.append(after(leads[-1], places[-1] - places[-2]))

    def at(tick):
        i = max(bisect_right(ticks, tick) - 1, 0)
        here = position(tick)
        return here + after(leads[i], here - places[i])

    return at


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
            found.append((_root(lambda t, value=value: q(t) - value, at, tick), direction))
        before, at = here, tick
    return found


def _root(function, low, high):
    """By false position; an end that stays is given half of its value (Illinois)."""
    at_low, at_high, last = function(low), function(high), low
    for _ in range(200):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        value = function(middle)
        if value * at_high > 0:
            high, at_high, at_low = middle, value, at_low / (2 if last == high else 1)
        else:
            low, at_low, at_high = middle, value, at_high / (2 if last == low else 1)
        if value == 0 or abs(middle - last) < 1e-4:
            return middle
        last = middle
    return last


def residual(impulses, frequency_hz, damping):
    """What is left of the vibration that one impulse makes, where the mass has this frequency."""
    omega = 2 * pi * frequency_hz
    damped = omega * sqrt(1 - damping**2)
    last = impulses[-1][1]
    parts = [(a * exp(-damping * omega * (last - t)), damped * t) for a, t in impulses]
    return sqrt(sum(a * sin(x) for a, x in parts) ** 2 + sum(a * cos(x) for a, x in parts) ** 2)
