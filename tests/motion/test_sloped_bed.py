"""Above a bed that is not flat no motor exceeds its speed or its acceleration."""

from __future__ import annotations

from math import hypot
from random import Random

import pytest
from tests.oracles import motion as oracle

from passo._core import Motion

from .machines import REACH, cartesian, nonlinear, of_box
from .test_nonlinear import nozzle

H = 1e-3  # seconds between two looks
# Heights, mm, at the four corners of a square of 400 mm: beyond what anybody prints on.
BEDS = {
    "a slope": lambda x, y: 0.25 * x - 0.15 * y,
    "a twist": lambda x, y: 0.05 * x + 0.0012 * x * y,
}


def above(name, bed):
    spec, geometry = nonlinear(name)
    for row in spec["steppers"]:
        row["accel"] = min(row["accel"], 3000.0)
        row["speed"] = min(row["speed"], 250.0)
    spec["axes"][2] |= {"speed": 200.0, "accel": 2000.0}
    spec["limits"] |= {"print_accel": 8000.0, "travel_accel": 8000.0}
    centre, half = REACH.get(name, ((100, 100, 50), (80, 80, 30)))
    motion = Motion(spec, False)
    z = centre[2] - bed(*centre[:2])
    motion.set_height_map(
        (-200.0, -200.0), (400.0, 400.0), [[bed(x, y) for x in (-200, 200)] for y in (-200, 200)]
    )
    motion.set_position([*map(float, centre[:2]), z, 0.0])
    return geometry, spec, centre, half, motion


@pytest.mark.parametrize("bed", BEDS)
@pytest.mark.parametrize("name", [*REACH, "i3", "corexy"])
def test_no_motor_exceeds_its_limits(name, bed):
    height = BEDS[bed]
    geometry, spec, centre, half, motion = above(name, height)
    random = Random(name + bed)
    if name in REACH:
        half = tuple(0.5 * h for h in half)
    for _ in range(12):
        x, y = (c + h * random.uniform(-1, 1) for c, h in zip(centre[:2], half, strict=False))
        lowest = centre[2] - half[2] * random.uniform(0, 0.5)
        motion.push([x, y, lowest - height(x, y), 0.0], 1000.0)
    motion.flush()

    def actuators(move, tick):
        x, y, low = nozzle(move, tick)
        at = (x, y, low + height(x, y))
        return of_box(name, geometry, at) if name in REACH else geometry.inverse(at)

    h = H * oracle.HZ
    limits = [(row["speed"], row["accel"]) for row in spec["steppers"][: len(geometry.actuators)]]
    axes = spec["axes"][2]
    if name in ("i3", "corexy"):
        limits = [
            (row["speed"], min(r["accel"], row["accel"]))
            for row, r in zip(spec["axes"][:3], spec["steppers"], strict=False)
        ]
        limits[2] = (axes["speed"], axes["accel"])
    fastest, hardest = [0.0] * len(limits), [0.0] * len(limits)
    for move in motion.take_moves():
        edges = (
            move.start_ticks + move.accelerate_ticks,
            move.end_ticks - move.decelerate_ticks,
        )
        tick = move.start_ticks + h
        while tick < move.end_ticks - h:
            q = [actuators(move, tick + d) for d in (-h, 0, h)]
            at_an_edge = any(abs(tick - edge) < 1.1 * h for edge in edges)
            for i, (a, b, c) in enumerate(zip(*q, strict=True)):
                fastest[i] = max(fastest[i], abs(c - a) / (2 * H) / limits[i][0])
                if not at_an_edge:
                    hardest[i] = max(hardest[i], abs(c - 2 * b + a) / H**2 / limits[i][1])
            tick += 1.7 * h
    assert max(fastest) < 1.01
    assert max(hardest) < 1.01
    assert max(*fastest, *hardest) > 0.25  # and not for nothing


def test_steepest_slope_combines_x_and_y():
    """By 0.3 in X and by 0.2 in Y at one corner, of the 12 mm/s that Z may go."""
    motion = Motion(cartesian(), False)
    motion.set_height_map((0, 0), (10, 10), [[0, 1], [0, 3]])
    motion.push([8, 6, 0, 0], 300.0)
    motion.flush()
    (move,) = motion.take_moves()
    assert move.speed_cap == pytest.approx(12 / hypot(0.3, 0.2))


def test_twisted_bed_costs_a_part_of_acceleration():
    """Half of Z's 10 mm/s² at most: with 2e-4/mm by the square of the speed, then 0.0141 a mm."""
    spec = cartesian()
    spec["axes"][2]["accel"] = 10.0
    motion = Motion(spec, False)
    motion.set_height_map((0, 0), (100, 100), [[0, 1], [1, 0]])
    motion.push([90, 90, 0, 0], 300.0)
    motion.flush()
    (move,) = motion.take_moves()
    assert move.speed_cap == pytest.approx((5 / 2e-4) ** 0.5)
    assert move.acceleration == pytest.approx(5 / (0.01 * 2**0.5))


def test_a_new_height_of_the_bed_moves_no_motor():
    motion = Motion(cartesian(), True)
    motion.push([5, 5, 5, 0], 50.0)
    motion.flush()
    motion.set_height_map((0, 0), (10, 10), [[1, 1], [1, 1]])
    assert motion.counts()[2] == 2000
    motion.push([5, 5, 5, 0], 50.0)
    motion.flush()
    assert motion.take_moves()[-1].start_mm[2] == 4.0
    assert motion.counts()[2] == 2400


def test_a_twisted_bed_bends_the_way_of_carriages_too():
    """Next to its curve above a flat bed, by twice the twist of 2e-3/mm times the half that a
    diagonal has of both; half of a carriage's acceleration at most goes to that."""
    bends = []
    for height in (0.0, 1e-3):
        spec, _ = nonlinear("delta")
        for row in spec["steppers"][:3]:
            row |= {"speed": 1e4, "accel": 10.0}
        motion = Motion(spec, False)
        motion.set_position([0, 0, 20, 0])
        motion.set_height_map((0, 0), (1, 1), [[0, height], [height, 0]])
        motion.push([0.5, 0.5, 20, 0], 300.0)
        motion.flush()
        bends.append(5.0 / motion.take_moves()[0].speed_cap ** 2)
    assert bends[1] - bends[0] == pytest.approx(2e-3, rel=0.02)
