"""The angle range of an arm that turns about a shoulder in the X, Y plane."""

from __future__ import annotations

from math import atan2, degrees, radians, tau

Limits = tuple[float, float]

# excluded at both ends: an almost stretched or folded arm would have to turn too fast
_LEFT_MM = 0.01
_AT_END_DEG = 1e-4


def reach(part1: float, part2: float) -> Limits:
    """The minimum and maximum distance, mm, that an arm of two parts reaches from its shoulder."""
    return abs(part1 - part2) + _LEFT_MM, part1 + part2 - _LEFT_MM


def direction(y: float, x: float, middle_deg: float) -> float:
    """atan2 in radians, within half a turn of `middle_deg`."""
    middle = radians(middle_deg)
    angle = atan2(y, x)
    while angle <= middle - tau / 2:
        angle += tau
    while angle > middle + tau / 2:
        angle -= tau
    return angle


def at_end(y: float, x: float, middle_deg: float) -> bool:
    """Whether the angle range ends in this direction, where the arm would jump by a full turn."""
    return abs(degrees(direction(y, x, middle_deg)) - middle_deg) > 180 - _AT_END_DEG


def turned(angle_deg: float, limits: Limits) -> float:
    """The degrees to add so that an angle is within the limits: 0 or a full turn; 0 if neither
    helps."""
    low, high = limits
    return next((turn for turn in (0.0, 360.0, -360.0) if low <= angle_deg + turn <= high), 0.0)


def why_it_ends(x: float, y: float) -> str:
    """The reason why no line may cross the boundary on the far side of the shoulder at x, y, mm."""
    return (
        f"behind the shoulder at X {x:g}, Y {y:g} its arms would have to turn back by a full turn;"
        " lead the line round the shoulder's other side"
    )
