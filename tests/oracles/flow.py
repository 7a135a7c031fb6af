"""Where filament ends when the flow changes in the midst of a plan, in plain Python."""

from __future__ import annotations

from tests.oracles.motion import HZ, position_at


def behind_the_way_to_brake(moves, cut):
    """E lengths that a plan, cut at a tick, leaves behind the way on which the machine could stop,
    each move by its own deceleration: the part of a move that is left, then whole moves. `moves`
    are as they were planned before, all of them, to a stop at the end."""
    left = [m for m in moves if m.end_ticks > cut]
    e = [m.end_mm[3] - m.start_mm[3] for m in left]
    if not left:
        return e
    first = left[0]
    gone = position_at(first, max(cut, first.start_ticks)) if first.length else 0.0
    speed2 = speed_at(first, max(cut, first.start_ticks)) ** 2
    for i, m in enumerate(left):
        way = m.length - (gone if i == 0 else 0.0)
        brakes = speed2 / (2 * m.deceleration)
        if brakes < way * (1 - 1e-9):
            share = (way - brakes) / m.length if m.length else 1.0
            return [e[i] * share, *e[i + 1 :]]
        speed2 = max(0.0, speed2 - 2 * m.deceleration * way)
    return []


def speed_at(move, tick):
    """Of a planned move, by its trapezoid."""
    t = (tick - move.start_ticks) / HZ
    t0, t1 = move.accelerate_ticks / HZ, move.cruise_ticks / HZ
    if t <= t0:
        return move.start_speed + move.acceleration * t
    return move.cruise_speed - move.deceleration * max(0.0, t - t0 - t1)


def fed(lengths, factor, owed=0.0):
    """mm that moves of filament make, planned as `lengths` with a flow of 1, from a place where
    `owed` mm are drawn back, when the flow is `factor` there: what was drawn back comes back by the
    length that it was drawn back by."""
    total, before, now = 0.0, owed, owed
    for mm in lengths:
        if mm < 0:
            made = mm * factor
            before, now = before - mm, now - made
        else:
            back = min(mm, before)
            returned = now * back / before if before else 0.0
            made = returned + (mm - back) * factor
            before, now = before - back, now - returned
        total += made
    return total
