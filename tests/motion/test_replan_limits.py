"""Cuts at random clocks: no motor is ever faster, or speeds up harder, than it may."""

from __future__ import annotations

import itertools
from bisect import bisect_right
from dataclasses import dataclass
from math import dist
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import motion as oracle

from passo._core import Motion

from .machines import REACH, cartesian, nonlinear, of_box
from .test_nonlinear import in_the_middle, point, push_shares
from .test_replan import push_all
from .test_steps import paths

H_S = 1e-3
H = H_S * oracle.HZ
SAMPLES = 60  # along the whole plan, and as many again around each cut

what = st.sampled_from(["replan", "hold", "slower", "faster"])
cuts = st.lists(st.tuples(st.floats(0, 1), what, st.floats(0.2, 3)), min_size=1, max_size=3)


@dataclass
class Executed:
    """The plan as it was carried out: each move up to the cut that has taken the rest of it back.
    A move is at `at` mm of its own between two clocks."""

    moves: list[Any]
    until: list[float]

    def cut(self, clock: float, after: list[Any]) -> None:
        """What is executed from this clock on."""
        while self.moves and self.moves[-1].start_ticks >= clock:
            self.moves.pop()
            self.until.pop()
        if self.until:
            self.until[-1] = min(self.until[-1], clock)
        self.moves += after
        self.until += [m.end_ticks for m in after]

    def at(self, tick: float) -> list[float]:
        """X, Y, Z and E."""
        i = min(bisect_right(self.until, tick), len(self.moves) - 1)
        m = self.moves[i]
        part = min(max(oracle.position_at(m, tick) / m.length, 0.0), 1.0)
        return [a + (b - a) * part for a, b in zip(m.start_mm[:4], m.end_mm[:4], strict=True)]

    def corners(self) -> list[float]:
        """Clocks at which the path turns: there the law of junctions has its jumps of speed."""

        def way(m: Any) -> list[float]:
            return [(b - a) / m.length for a, b in zip(m.start_mm, m.end_mm, strict=True)]

        return [
            until
            for before, until, after in zip(self.moves, self.until, self.moves[1:], strict=False)
            if dist(way(before), way(after)) > 1e-6
        ]


def carried_out(motion, changes) -> tuple[Executed, list[float]]:
    """Changes a plan that is settled, again and again; what is carried out of it in the end, and
    the clocks of the cuts."""
    motion.flush()
    executed = Executed([], [])
    executed.cut(0.0, motion.take_moves())
    clocks = []
    for where, what, by in sorted(changes):
        from_clock = motion.clock * where
        if what == "hold":
            clocks.append(cut := motion.hold_from(from_clock))
            executed.cut(cut, motion.take_moves())
            motion.wait_until(motion.clock + 0.1 * oracle.HZ)
            motion.release()
            motion.flush()
            after = motion.take_moves()
            executed.moves += after
            executed.until += [m.end_ticks for m in after]
            continue
        if what == "replan":
            motion.set_accel(1000 * by)
        else:
            motion.set_speed_factor(by if what == "faster" else 0.1 * by)
        clocks.append(cut := motion.replan_from(from_clock))
        motion.flush()
        executed.cut(cut, motion.take_moves())
    pairs = itertools.pairwise(executed.moves)
    for (before, after), until in zip(pairs, executed.until, strict=False):
        cut = until < before.end_ticks  # a hold may come right after it
        assert cut or dist(before.end_mm, after.start_mm) < 1e-6
    return executed, clocks


def assert_limits(executed, clocks, motors, rows):
    """`motors(point)`: where each motor is, in its own unit; rows have its limits."""
    if not executed.moves:
        return
    end, corners = executed.until[-1], executed.corners()
    ticks = [end * (i + 0.5) / SAMPLES for i in range(SAMPLES)]
    ticks += [cut + H * (i - SAMPLES / 4) for cut in clocks for i in range(SAMPLES)]
    for tick in ticks:
        near = bisect_right(corners, tick - H)
        turns = near < len(corners) and corners[near] <= tick + H
        if turns or not H < tick < end - H:
            continue
        before, here, after = (motors(executed.at(tick + d)) for d in (-H, 0, H))
        for row, a, b, c in zip(rows, before, here, after, strict=True):
            assert abs(c - a) / (2 * H_S) <= row["speed"] * 1.01, (row["name"], tick)
            assert abs(c - 2 * b + a) / H_S**2 <= row["accel"] * 1.01 + 1e-3, (row["name"], tick)


@given(path=paths, changes=cuts)
@settings(max_examples=60, deadline=None)
def test_each_axis_keeps_its_limits(path, changes):
    spec = cartesian()
    motion = Motion(spec, True)
    push_all(motion, path)
    executed, clocks = carried_out(motion, changes)
    assert_limits(executed, clocks, lambda p: p, [*spec["axes"], *spec["extruders"]])


lines = st.lists(st.tuples(point, st.integers(20, 250)), min_size=1, max_size=4)


@pytest.mark.parametrize("name", REACH)
@given(path=lines, changes=cuts)
@settings(max_examples=20, deadline=None)
def test_each_arm_keeps_its_limits(name, path, changes):
    motion, spec, geometry = in_the_middle(name)
    push_shares(motion, name, path)
    executed, clocks = carried_out(motion, changes)

    def motors(point):
        return of_box(name, geometry, (point[0], point[1], point[2]))

    assert_limits(executed, clocks, motors, spec["steppers"][: len(geometry.actuators)])


@pytest.mark.parametrize("back_s", [0.001, 0.005, 0.02])
def test_faster_feedrate_while_braking_lets_it_stop(back_s):
    """A plan at the full speed brakes with 1612 mm/s² here: the one of before had more."""
    spec, _ = nonlinear("delta")
    motion = Motion(spec, True)
    motion.set_speed_factor(0.2)
    motion.set_position([-45.0, -40.0, 60.0, 0.0])
    motion.push([45, 40, 60, 0], 250.0)
    motion.flush()
    last = motion.take_moves()[-1]
    motion.set_speed_factor(1.0)
    assert motion.replan_from(motion.clock - back_s * oracle.HZ)
    motion.flush()
    (stop,) = motion.take_moves()
    assert stop.start_speed == pytest.approx(last.deceleration * back_s, rel=1e-3)
    assert stop.deceleration == pytest.approx(last.deceleration, rel=1e-3)
    assert last.deceleration == pytest.approx(2117, abs=0.1)
    assert stop.end_speed == 0.0


def test_slower_feedrate_brakes_as_hard_as_corners_allow():
    # Bends take a carriage's acceleration with the square of the speed: a plan at a fifth of it
    # may use 2921 mm/s² along this line, one at the full speed 2024 mm/s² where it is cut.
    spec, _ = nonlinear("delta")
    motion = Motion(spec, True)
    motion.set_position([-45.0, -40.0, 60.0, 0.0])
    motion.push([45, 40, 60, 0], 250.0)
    motion.flush()
    cut = 0.45 * oracle.HZ
    under_way = next(m for m in motion.take_moves() if m.end_ticks > cut)
    motion.set_speed_factor(0.2)
    assert motion.replan_from(cut) == cut
    motion.flush()
    braking, _ = motion.take_moves()
    assert braking.start_speed == pytest.approx(under_way.cruise_speed)
    assert braking.start_speed > 3 * braking.speed_cap
    assert braking.acceleration == pytest.approx(-under_way.deceleration)
    assert under_way.deceleration == pytest.approx(2024.03, abs=0.01)
