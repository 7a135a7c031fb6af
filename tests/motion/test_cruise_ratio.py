"""minimum_cruise_ratio against Klipper's law for moves between two stops."""

from __future__ import annotations

from math import sqrt

import pytest

from passo._core import Motion

from .machines import HZ, cartesian

PATH, RETRACT, Z, E = 3000.0, 1200.0, 200.0, 798.0  # mm/s²


def klippers_s(mm: float, speed: float, accel: float, path_accel: float, ratio: float) -> float:
    """Duration of a move between two stops, as Klipper plans it: the highest speed is the middle of
    what the move's own acceleration reaches, and of what the acceleration of the path without its
    share of cruise reaches, whichever is less."""
    own, cruise = 2 * mm * accel, 2 * mm * path_accel * (1 - ratio)
    peak = min(speed, sqrt(min(own, cruise) / 2))
    ramps = peak * peak / accel
    return 2 * peak / accel + (mm - ramps) / peak


def planned(spec, targets, feed):
    """The moves of the extruder alone have its acceleration, the others that of prints."""
    motion, place = Motion(spec, False), [0.0, 0.0, 0.0]
    for target in targets:
        motion.push(target, feed, "extrude" if target[:3] == place else "print")
        place = target[:3]
    motion.flush()
    return motion.take_moves()


def seconds(move) -> float:
    return (move.accelerate_ticks + move.cruise_ticks + move.decelerate_ticks) / HZ


def spec(ratio: float):
    machine = cartesian(print_accel=PATH, travel_accel=PATH, minimum_cruise_ratio=ratio)
    machine["limits"]["retract_accel"] = RETRACT
    machine["axes"][2]["accel"], machine["axes"][2]["speed"] = Z, 100.0
    machine["extruders"][0]["accel"] = E
    return machine


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.5, 0.7, 0.95])
@pytest.mark.parametrize(
    ("target", "mm", "accel"),
    [
        ([0, 0, 0, -0.8], 0.8, E),
        ([0, 0, 0.4, 0], 0.4, Z),
        ([0, 0, 2.0, 0], 2.0, Z),
        ([8.0, 0, 0, 0], 8.0, PATH),
        ([3.0, 4.0, 0, 0.2], 5.0, PATH),
    ],
)
def test_moves_between_stops_take_klippers_time(ratio, target, mm, accel):
    (move,) = planned(spec(ratio), [target], 90.0)
    assert seconds(move) == pytest.approx(klippers_s(mm, 90.0, accel, PATH, ratio), rel=1e-9)


def test_retraction_and_lift_cost_nothing_at_half_a_cruise():
    """Z and the extruder have less than half of the acceleration of the path anyway."""
    ends = [[0, 0, 0, -0.8], [0, 0, 0.4, -0.8], [0, 0, 0, -0.8], [0, 0, 0, 0]]
    half, none = ([seconds(m) for m in planned(spec(r), ends, 35.0)] for r in (0.5, 0.0))
    assert half == none


def test_the_extruder_alone_cruises_where_the_path_is_slow():
    """As after SET_VELOCITY_LIMIT ACCEL=500."""
    slow = spec(0.5)
    slow["limits"]["print_accel"] = 500.0
    (move,) = planned(slow, [[0, 0, 0, 1.0]], 90.0)
    assert move.cruise_speed == pytest.approx(sqrt(2 * 500 * 0.5 / 2))
    assert move.cruise_ticks > 0
