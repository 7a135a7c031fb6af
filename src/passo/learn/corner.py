"""Describes the limit of the speed between two planned moves."""

from __future__ import annotations

from math import acos, degrees, sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo import _core
    from passo.config.machine import MachineConfig

LAWS = {
    "deviation": "junction deviation: v² = a·δ·s/(1-s), s = sin(θ/2), θ the angle that the moves"
    " enclose; and v² is at most ½·a·d·tan(θ/2) of either move, d its length",
    "square_corner": "speed at right angles: v² = w²·(√2-1)·s/(1-s), s = sin(θ/2), θ the angle that"
    " the moves enclose, w = square_corner_mm_s, less where an axis limits the acceleration; and v²"
    " is at most ½·a·d·tan(θ/2) of either move, d its length",
    "cornering_distance": "cornering distance: no axis changes its share of the speed too fast",
    "jerk": "jerk: no axis changes its speed by more than its jerk",
}
_OF_CIRCLE = ("deviation", "square_corner")  # laws under which only extruders may jump
_E = 3  # index of the extruder in a move's positions; further axes come after it
_STRAIGHT_DEG = 0.01
_STILL_MM_S = 1e-3
_SAME = 1e-6  # fraction by which two equal speeds may differ


def corner(a: _core.Move | None, b: _core.Move | None, machine: MachineConfig) -> str:
    """The speed between `a` and `b`, and its limit; None means no move."""
    if a is None or b is None:
        return f"the machine stops there: there is no move {'before' if a is None else 'after'} it"
    if "dwell" in (a.kind, b.kind):
        return "the machine stops there, because it waits"
    turn = _turn(a, b)
    path = "one of the moves has no X, Y or Z" if turn is None else f"the path turns by {turn:.1f}°"
    if b.inner:
        path = "the same path continues"
    if b.start_cap < _STILL_MM_S:
        return f"{path}; the machine stops there{_why_it_stands(a, b, turn, machine)}"
    unit = path_unit(machine)
    text = f"{path}, at most {b.start_cap:.2f} {unit}/s, taken at {b.start_speed:.2f} {unit}/s"
    if b.start_speed < b.start_cap * (1 - _SAME):
        text += ": what comes before or after it allows no more"
    return f"{text}\n  bound by {_bound(a, b, turn, machine)}"


def path_unit(machine: MachineConfig) -> str:
    """The unit of a move's path: steps of the axis with the most steps, or mm."""
    return "steps" if machine.limits.junction == "cornering_distance" else "mm"


def _travel(move: _core.Move) -> list[float]:
    return [end - start for start, end in zip(move.start_mm, move.end_mm, strict=True)]


def _turn(a: _core.Move, b: _core.Move) -> float | None:
    """The angle between the moves, degrees; None if one of them has no X, Y or Z."""
    u, v = _travel(a)[:_E], _travel(b)[:_E]
    lengths = sqrt(sum(x * x for x in u)) * sqrt(sum(x * x for x in v))
    if lengths == 0:
        return None
    cosine = sum(p * q for p, q in zip(u, v, strict=True)) / lengths
    return degrees(acos(min(max(cosine, -1.0), 1.0)))


def _why_it_stands(a: _core.Move, b: _core.Move, turn: float | None, machine: MachineConfig) -> str:
    law = machine.limits.junction
    if turn is not None and turn > 180 - _STRAIGHT_DEG:
        return f"\n  {LAWS[law]}"
    if a.extruder != b.extruder and (turn is None or law == "cornering_distance"):
        return ", for the extruder changes"
    if turn is None and law != "cornering_distance":
        if any(_travel(a)[:_E]) != any(_travel(b)[:_E]):
            return ""
        if not _alongside(a, b):
            return ", for the extruder turns back or the axes share the way in another manner"
    waits = "a command between the moves waits for that"
    if law not in _OF_CIRCLE or _jump_speed(a, b, machine) == 0:
        return f": {waits}, or an axis may not jump at all"
    return f": {waits}"


def _alongside(a: _core.Move, b: _core.Move) -> bool:
    pairs = zip(_travel(a), _travel(b), strict=True)
    return all(abs(x / a.length - y / b.length) <= 1e-9 for x, y in pairs)


def _bound(a: _core.Move, b: _core.Move, turn: float | None, machine: MachineConfig) -> str:
    """The limit that sets the speed of the corner."""
    law = machine.limits.junction
    if b.start_cap >= min(a.speed_cap, b.speed_cap) * (1 - _SAME):
        return "the slower of the two moves; the corner itself does not bound it"
    if b.advance_binds:
        return "pressure advance: its change there, which the extruder has to follow"
    jump = _jump_speed(a, b, machine) if law in _OF_CIRCLE or b.inner else None
    straight = b.inner or turn is None or turn < _STRAIGHT_DEG
    if straight or (jump is not None and b.start_cap >= jump * (1 - _SAME)):
        own = "cornering distance" if law == "cornering_distance" else "jerk"
        return f"the extruder, or a further axis, whose speed may jump only as its {own} allows"
    return LAWS[law]


def _jump_speed(a: _core.Move, b: _core.Move, machine: MachineConfig) -> float | None:
    """The path speed, mm/s, at which the extruder's speed changes by its jerk limit; None if it
    does not change."""
    before, after = (_travel(move)[_E] / move.length for move in (a, b))
    jerks = [extruder.jerk_mm_s for extruder in machine.extruders.values()]
    if not jerks:
        return None
    if a.extruder == b.extruder:
        jumps = [(abs(after - before), jerks[b.extruder])]
    else:
        jumps = [(abs(before), jerks[a.extruder]), (abs(after), jerks[b.extruder])]
    return min((jerk / change for change, jerk in jumps if change > 1e-12), default=None)
