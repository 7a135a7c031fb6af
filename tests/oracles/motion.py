"""The motion rules in plain Python: what planned moves and board messages must obey."""

from __future__ import annotations

import itertools
from math import floor, hypot, sqrt

HZ = 16e6


def position_at(move, tick):
    """Path position of a planned move at a tick, from its speeds alone."""
    t = (tick - move.start_ticks) / HZ
    t0, t1 = move.accelerate_ticks / HZ, move.cruise_ticks / HZ
    a = min(max(t, 0.0), t0)
    s = move.start_speed * a + 0.5 * move.acceleration * a * a
    c = min(max(t - t0, 0.0), t1)
    s += move.cruise_speed * c
    d = max(t - t0 - t1, 0.0)
    return s + move.cruise_speed * d - 0.5 * move.deceleration * d * d


def crossing_ticks(move, axis, steps_per_mm):
    """Ideal (tick, direction) of each step of a motor that follows one axis, by bisection."""
    start, end = move.start_mm[axis] * steps_per_mm, move.end_mm[axis] * steps_per_mm
    k0, k1 = floor(start + 0.5), floor(end + 0.5)
    direction = 1 if k1 > k0 else -1
    for k in range(k0, k1, direction):
        target = (k + 0.5 * direction - start) / (end - start) * move.length
        lo, hi = move.start_ticks, move.end_ticks
        for _ in range(80):
            middle = 0.5 * (lo + hi)
            if position_at(move, middle) < target:
                lo = middle
            else:
                hi = middle
        yield 0.5 * (lo + hi), direction


def executed_ticks(messages, target):
    """(tick, direction) of each step that a board executes for one motor."""
    last, direction, out = 0, 0, []
    for kind, who, clock, end, interval, count, add, forward in messages:
        if who != target:
            continue
        if kind == "reset_clock":
            last = clock
        elif kind == "set_dir":
            direction = 1 if forward else -1
        elif kind == "queue_step":
            assert 1 <= count <= 65535
            assert -32768 <= add <= 32767
            step = interval
            for _ in range(count):
                assert 0 < step < 2**31
                last += step
                out.append((last, direction))
                step += add
            assert last == end
    return out


def pins(messages):
    """(clock, value) of each record of an output."""
    return [(clock, value) for kind, _, clock, _, value, *_ in messages if kind == "pin"]


def assert_within_bound(executed, ideal, tolerance_ticks=32.0):
    """|executed - ideal| ≤ min(tolerance, ¼ of the smaller gap) + ½ tick, every step; one tolerance
    for all, or a list of one a step."""
    assert len(executed) == len(ideal)
    times = [t for t, _ in ideal]
    for i, ((done, went), (wanted, goes)) in enumerate(zip(executed, ideal, strict=True)):
        assert went == goes
        wide = tolerance_ticks[i] if isinstance(tolerance_ticks, list) else tolerance_ticks
        gaps = [wide * 4]
        if i > 0:
            gaps.append(times[i] - times[i - 1])
        if i + 1 < len(times):
            gaps.append(times[i + 1] - times[i])
        assert abs(done - wanted) <= 0.25 * min(gaps) + 0.5 + 2e-3, (i, done, wanted)


def assert_trapezoids(moves):
    """Speeds join, phases add up to the length and to the time, caps hold."""
    for before, after in itertools.pairwise(moves):
        assert abs(before.end_speed - after.start_speed) < 1e-9
        assert abs(before.end_ticks - after.start_ticks) < 1e-3
        assert after.start_speed <= after.start_cap + 1e-9
    for m in moves:
        if m.kind == "dwell":
            continue
        slow = m.length - m.accelerate_length - m.cruise_length
        assert slow > -1e-9
        peak2 = m.start_speed**2 + 2 * m.acceleration * m.accelerate_length
        assert abs(peak2 - m.cruise_speed**2) < 1e-6 * max(1.0, peak2)
        assert abs(m.cruise_speed**2 - 2 * m.deceleration * slow - m.end_speed**2) < 1e-6 * max(
            1, peak2
        )
        assert m.cruise_speed <= max(m.speed_cap, m.start_speed) + 1e-9
        assert abs(position_at(m, m.end_ticks) - m.length) < 1e-6 * max(1.0, m.length)


def junction_deviation_cap(before, after, deviation):
    """v at a corner: v² = a δ s / (1 - s), s = sin(half the enclosed angle); and the circle's
    tangent points lie within half of each move."""
    u = [b - a for a, b in zip(before.start_mm, before.end_mm, strict=True)][:3]
    w = [b - a for a, b in zip(after.start_mm, after.end_mm, strict=True)][:3]
    cosine = -sum(a * b for a, b in zip(u, w, strict=True)) / (hypot(*u) * hypot(*w))
    cosine = min(max(cosine, -1.0), 1.0)
    s, c = sqrt((1 - cosine) / 2), sqrt((1 + cosine) / 2)
    caps = [before.speed_cap, after.speed_cap]
    a, b = before.deceleration, after.deceleration
    if s < 1 - 1e-12:
        caps.append(sqrt(min(a, b) * deviation * s / (1 - s)))
    if c > 1e-9:
        caps.append(sqrt(0.5 * min(a * before.length, b * after.length) * s / c))
    return min(caps)
