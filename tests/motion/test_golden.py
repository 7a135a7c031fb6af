"""Published speeds and times: StuFW's junction speeds, APrinter's measured batch times, Klipper's
print times."""

from __future__ import annotations

from math import cos, pi, radians, sin, tan

import pytest

from passo._core import Job, Motion
from passo.config import load

from .machines import aprinter, axis, cartesian, stepper

HZ = 16e6


def planned(spec, moves, feed=100.0):
    motion = Motion(spec, False)
    for move in moves:
        motion.push(**({"feed_mm_s": feed} | move))
    motion.flush()
    return motion.take_moves(), motion.clock / HZ


@pytest.mark.parametrize(
    ("deflection", "accel", "deviation", "speed"),
    [
        (45, 3000.0, 0.02, 26.99),
        (90, 3000.0, 0.02, 12.035),
        (135, 3000.0, 0.02, 6.10),
        (45, 800.0, 0.1, 31.16),
        (90, 800.0, 0.1, 13.897),
        (135, 800.0, 0.1, 7.04),
    ],
)
def test_junction_deviation_limits_corner_speed(deflection, accel, deviation, speed):
    spec = cartesian(print_accel=accel, travel_accel=accel, junction_deviation=deviation)
    a = radians(deflection)
    end = [50 + 50 * cos(a), 50 * sin(a), 0, 0]
    moves, _ = planned(spec, [{"target": [50, 0, 0, 0]}, {"target": end}])
    assert moves[1].start_cap == pytest.approx(speed, abs=0.01)
    assert moves[0].end_speed == moves[1].start_speed == pytest.approx(speed, abs=0.01)


@pytest.mark.parametrize(("accel", "seconds"), [(1500.0, 16.473), (500.0, 21.624), (150.0, 36.995)])
def test_square_corners_take_as_long_as_with_klipper(accel, seconds):
    """The print time of Klipper's batch mode (v0.13), less the 0.25 s before its first move."""
    spec = cartesian(
        print_accel=accel, travel_accel=accel, junction="square_corner", square_corner=5.0
    )
    for part in spec["axes"]:
        part |= {"speed": 300.0, "accel": 1500.0}
    spec["extruders"][0] |= {"speed": 45.0, "accel": 250.0}
    ways = [{"target": [60, 10, 0, 0]}, {"target": [60, 10, 0, 1], "kind": "extrude"}]
    for i in range(1, 60):
        target = [60 + i % 7 * 5, 10 + i * 13 % 50, 0, i + 1]
        ways.append({"target": target, "kind": "print"})
    _, total = planned(spec, ways)
    assert total == pytest.approx(seconds, abs=0.005)


@pytest.mark.parametrize(("deflection", "speed"), [(45, 11.211), (90, 5.0), (135, 2.534)])
def test_square_corner_speed_is_that_of_a_right_angle_at_any_acceleration(deflection, speed):
    a = radians(deflection)
    end = [50 + 50 * cos(a), 50 * sin(a), 0, 0]
    for accel in (3000.0, 300.0):
        spec = cartesian(print_accel=accel, travel_accel=accel, junction="square_corner")
        moves, _ = planned(spec, [{"target": [50, 0, 0, 0]}, {"target": end}])
        assert moves[1].start_cap == pytest.approx(speed, abs=0.001)


def test_a_slower_axis_has_slower_square_corners():
    """As the junction deviation, whose speed falls with the root of the acceleration."""
    spec = cartesian(junction="square_corner")
    spec["axes"][1]["accel"] = 750.0
    moves, _ = planned(spec, [{"target": [50, 0, 0, 0]}, {"target": [50, 50, 0, 0]}])
    assert moves[1].start_cap == pytest.approx(2.5, rel=1e-9)


@pytest.mark.parametrize(
    ("deflection", "speed"),
    [
        (0, 100.0),
        (30, 20.0),  # Y changes by half of it
        (45, 14.142),
        (60, 11.547),
        (90, 10.0),
        (120, 10.0),  # X turns back: its larger speed counts, all of it
        (180, 10.0),
    ],
)
def test_classic_jerk_limits_corner_speed(deflection, speed):
    a = radians(deflection)
    end = [50 + 50 * cos(a), 50 * sin(a), 0, 0]
    moves, _ = planned(cartesian(junction="jerk"), [{"target": [50, 0, 0, 0]}, {"target": end}])
    assert moves[1].start_cap == pytest.approx(speed, abs=0.001)
    assert moves[0].end_speed == moves[1].start_speed == pytest.approx(speed, abs=0.001)


def test_the_jerk_of_a_slow_axis_counts_too():
    """Z may change by 0.4 mm/s and E by 5: a corner into a slope of 2 % Z goes at 20 mm/s, and one
    into an extrusion of 0.5 mm for a mm at 10."""
    spec = cartesian(junction="jerk")
    spec["axes"][2]["jerk"], spec["extruders"][0]["jerk"] = 0.4, 5.0
    slope, print_ = [150, 0, 2, 0], [150, 0, 0, 50]
    for end, length, speed in ((slope, (1e4 + 4) ** 0.5 / 100, 20.0), (print_, 1.0, 10.0)):
        moves, _ = planned(spec, [{"target": [50, 0, 0, 0]}, {"target": end}])
        assert moves[1].start_cap == pytest.approx(speed * length, abs=0.001)


@pytest.mark.parametrize(("junction", "speed"), [("jerk", 20.0), ("deviation", 20.0)])
def test_alternating_extruders_use_their_own_jerk(junction, speed):
    """The first may stop at once from 2 mm/s, the second start at 3: with 0.1 mm for a mm each the
    first bounds the corner."""
    spec = cartesian(junction=junction)
    spec["extruders"] = [
        {"name": name, "speed": 100.0, "accel": 5000.0, "jerk": jerk}
        for name, jerk in (("e", 2.0), ("e1", 3.0))
    ]
    spec["steppers"].append(stepper("e1", "extruder", 1, 95.5))
    moves, _ = planned(
        spec,
        [
            {"target": [50, 0, 0, 5], "kind": "print"},
            {"target": [100, 0, 0, 5], "kind": "print", "extruder": 1},
        ],
    )
    assert moves[1].start_cap == pytest.approx(speed, abs=0.001)


@pytest.mark.parametrize("lengths", [(0.1, 50), (50, 0.1), (0.1, 0.2)])
def test_a_short_move_bounds_its_corners(lengths):
    """The circle of the junction deviation touches either move within half of its length."""
    a = radians(30)
    x = lengths[0]
    end = [x + lengths[1] * cos(a), lengths[1] * sin(a), 0, 0]
    moves, _ = planned(cartesian(), [{"target": [x, 0, 0, 0]}, {"target": end}])
    tangent = tan(radians(150 / 2))
    assert moves[1].start_cap == pytest.approx((0.5 * 3000 * 0.1 * tangent) ** 0.5, rel=1e-9)


@pytest.mark.parametrize("junction", ["deviation", "jerk"])
def test_filament_alone_begins_and_ends_at_rest(junction):
    moves, _ = planned(
        cartesian(junction=junction),
        [
            {"target": [50, 0, 0, 5], "kind": "print"},
            {"target": [50, 0, 0, 6], "kind": "extrude"},
            {"target": [100, 0, 0, 11], "kind": "print"},
        ],
    )
    assert [m.start_speed for m in moves] == [0, 0, 0]
    assert [m.start_cap for m in moves[1:]] == [0, 0]


TIMES = {
    "90 degrees": ([[10, 0], [10, 10]], 0.3018),
    "straight": ([[10, 0], [20, 0]], 0.2667),
    "reversal": ([[10, 0], [0, 0]], 0.3100),
    "45 degrees": ([[10, 0], [17.071, 7.071]], 0.2833),
}


@pytest.mark.parametrize("name", TIMES)
def test_cornering_distance_gives_aprinters_times(name):
    points, seconds = TIMES[name]
    _, total = planned(aprinter(), [{"target": [*p, 0, 0]} for p in points])
    assert total == pytest.approx(seconds, abs=1e-3)


def test_a_dwell_between_moves_stops_the_machine():
    moves = [
        {"target": [10, 0, 0, 0]},
        {"target": [10, 0, 0, 0], "kind": "dwell", "duration_s": 0.2},
        {"target": [20, 0, 0, 0]},
    ]
    assert planned(aprinter(), moves)[1] == pytest.approx(0.5333, abs=1e-3)


def test_slower_next_move_limits_the_end_speed():
    moves = [{"target": [10, 0, 0, 0]}, {"target": [20, 0, 0, 0], "feed_mm_s": 20.0}]
    assert planned(aprinter(), moves)[1] == pytest.approx(0.6616, abs=1e-3)


def test_the_extruder_limits_acceleration_and_corner():
    moves = [{"target": [10, 0, 0, 0]}, {"target": [20, 0, 0, 1], "kind": "print"}]
    assert planned(aprinter(), moves)[1] == pytest.approx(0.2948, abs=1e-3)


def test_polygon_of_36_corners_takes_its_golden_time():
    points = [[20 * cos(2 * pi * i / 36), 20 * sin(2 * pi * i / 36)] for i in range(1, 37)]
    moves = [{"target": [20, 0, 0, 0], "feed_mm_s": 1000.0}]
    moves += [{"target": [*p, 0, 0]} for p in points]
    spec = aprinter()
    start = planned(spec, moves[:1])[1]
    motion = Motion(spec, False)
    motion.push(**moves[0])
    motion.flush()
    for move in moves[1:]:
        motion.push(**({"feed_mm_s": 100.0} | move))
    motion.flush()
    assert motion.clock / HZ - start == pytest.approx(1.5671, abs=1e-3)


@pytest.mark.parametrize(("feed", "fastest"), [(54.9, 50.0), (55.1, 55.1), (200.0, 200.0)])
def test_small_gains_of_speed_are_skipped(feed, fastest):
    """A tenth more than the faster end, which is 50 mm/s."""
    ways = [(50, 50.0), (70, feed), (120, 50.0)]
    moves, _ = planned(
        cartesian(least_speed_gain=0.1),
        [{"target": [x, 0, 0, 0], "feed_mm_s": f} for x, f in ways],
    )
    assert [m.cruise_speed for m in moves] == pytest.approx([50.0, fastest, 50.0])


def test_further_axis_uses_its_own_jerk():
    """It reverses from 0.1 mm for a mm of X: a change by 0.2, of which 2 mm/s are allowed."""
    spec = cartesian()
    spec["axes"].append(axis("A", jerk=2.0))
    spec["steppers"].insert(3, stepper("a", "axis", 3, 80.0))
    ways = [{"target": [50, 0, 0, 5, 0]}, {"target": [100, 0, 0, 0, 0]}]
    moves, _ = planned(spec, ways)
    assert moves[1].start_cap == pytest.approx(10.0)


@pytest.mark.parametrize(("feed", "speed"), [(8.0, 16.0), (1000.0, 20.0)])
def test_slower_of_time_and_feedrate_counts(feed, speed):
    """100 mm in 10 s, twice as fast."""
    motion = Motion(cartesian(), False)
    motion.set_speed_factor(2.0)
    motion.push([100, 0, 0, 0], feed, duration_s=10.0)
    motion.flush()
    assert motion.take_moves()[0].cruise_speed == pytest.approx(speed)


@pytest.mark.parametrize(
    ("key", "value", "rate"), [("max_rate_hz", 955, 955), ("pulse_s", 5e-4, 1000)]
)
def test_the_rate_of_its_steps_bounds_an_extruder(key, value, rate):
    """Either its own, or that of two pulses a step."""
    spec = cartesian()
    spec["steppers"][3][key] = value
    moves, _ = planned(spec, [{"target": [0, 0, 0, -20], "kind": "extrude"}])
    assert moves[0].cruise_speed == pytest.approx(rate / 95.5)


def test_cornering_distance_does_not_join_extruders():
    spec = aprinter()
    spec["extruders"].append(spec["extruders"][0] | {"name": "e1"})
    spec["tools"].append({"extruder": 1, "offset": [0.0, 0.0, 0.0]})
    spec["steppers"].append(stepper("e1", "extruder", 1, 100.0))
    ways = [{"target": [50, 0, 0, 0], "extruder": 0}, {"target": [100, 0, 0, 0], "extruder": 1}]
    moves, _ = planned(spec, ways)
    assert moves[0].end_speed == moves[1].start_cap == 0


def test_path_speed_limit_does_not_apply_to_filament_alone():
    ways = [{"target": [20, 0, 0, 0]}, {"target": [20, 0, 0, 20], "kind": "extrude"}]
    moves, _ = planned(cartesian(speed=50.0), ways, 80.0)
    assert [m.cruise_speed for m in moves] == pytest.approx([50.0, 80.0])


@pytest.mark.parametrize(("x", "length"), [(0.0019, 20.0), (0.0021, 0.0021)])
def test_tiny_path_next_to_much_filament_is_ignored(x, length):
    """A ten thousandth of it."""
    moves, _ = planned(cartesian(), [{"target": [x, 0, 0, 20]}])
    assert moves[0].length == pytest.approx(length)


def test_filament_of_two_extruders_is_a_corner():
    spec = cartesian()
    spec["extruders"].append(spec["extruders"][0] | {"name": "e1"})
    spec["tools"].append({"extruder": 1, "offset": [0.0, 0.0, 0.0]})
    spec["steppers"].append(stepper("e1", "extruder", 1, 95.5))
    ways = [{"target": [0, 0, 0, 20], "kind": "extrude", "extruder": i} for i in (0, 1)]
    moves, _ = planned(spec, ways)
    assert [m.length for m in moves] == [20, 20]
    assert moves[0].end_speed == moves[1].start_cap == 0


def test_a_limit_of_an_axis_is_never_more_than_the_machine_s():
    job = Job(load("i3").core_spec())
    most = job.limits.of_axis("x", "speed")
    for share, then in ((10, 1), (0.5, 0.5), (2, 1)):
        job.limits.set_of_axis("x", "speed", share * most)
        assert job.limits.of_axis("x", "speed") == then * most
