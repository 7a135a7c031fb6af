"""The budgets of board and link: rates of steps and commands, and what gives way to keep them."""

from __future__ import annotations

from bisect import bisect_left
from math import cos, inf, pi, sin
from random import Random

import pytest
from tests.oracles.motion import (
    assert_trapezoids,
    assert_within_bound,
    crossing_ticks,
    executed_ticks,
)

from passo import config
from passo._core import Motion

from .machines import cartesian

HZ = 16e6
WIDEST = 25e-6 * HZ


def budget(**values):
    least = {"steps_s": inf, "commands_s": inf, "burst": 0.0, "bound": "link", "commits_s": 0.0}
    return least | {"boards": [0]} | values


def machine(accel=3000.0, speed=500.0, *, budget=None, **values):
    spec = cartesian(print_accel=accel)
    for axis in spec["axes"]:
        axis.update(accel=accel, speed=speed)
    spec["extruders"][0].update(accel=2 * accel, jerk=50.0)
    return spec | {"budgets": [budget] if budget else []} | values


def delta(**values):
    geometry = {
        "kind": "delta",
        "radius": 81.0,
        "rods": [160.0, 160.0, 160.0],
        "angles": [210.0, 330.0, 90.0],
        "limit_radius": 75.1,
    }
    return machine(geometry=geometry, **values)


def wander(mm, moves, turn, seed):
    """Targets of moves of about so many mm that turn by about so many radians each."""
    random = Random(seed)
    x = y = angle = 0.0
    for i in range(moves):
        angle += random.gauss(0, turn)
        way = mm * random.uniform(0.5, 1.5)
        x += way * cos(angle)
        y += way * sin(angle)
        yield [x, y, 0.0, 0.03 * mm * i]


def planned(spec, targets, feed=300.0):
    motion = Motion(spec)
    motion.set_position([0.0, 0.0, 0.0, 0.0])
    for target in targets:
        motion.push(target, feed, "print")
    motion.flush()
    return motion, motion.take_moves(), motion.take_messages()


def most_in_a_window(ticks, seconds):
    """The most events within any so many seconds."""
    return max(bisect_left(ticks, t + seconds * HZ) - i for i, t in enumerate(ticks))


@pytest.mark.parametrize("spec", [machine, delta])
def test_no_window_holds_more_steps_than_the_board_takes(spec):
    rate, random = 20_000.0, Random(3)
    targets = [
        [random.uniform(-45, 45), random.uniform(-45, 45), random.uniform(0, 5), i * 2.0]
        for i in range(25)
    ]
    free = planned(spec(), targets, 400.0)
    bound = planned(spec(budget=budget(steps_s=rate)), targets, 400.0)
    most = {}
    for name, (_, _, messages) in (("free", free), ("bound", bound)):
        ticks = sorted(t for i in range(4) for t, _ in executed_ticks(messages, i))
        most[name] = most_in_a_window(ticks, 0.01)
    assert most["free"] > 1.5 * rate * 0.01
    assert 0.85 * rate * 0.01 < most["bound"] <= rate * 0.01 + 8
    assert_trapezoids(bound[1])
    assert bound[0].counts() == free[0].counts()
    assert all(move.tolerance_ticks == 0 for move in bound[1])


def most_ahead(messages, rate):
    """Of commands at their ends, the most beyond this rate."""
    ahead = most = last = 0.0
    for t in sorted(m[3] for m in messages if m[0] == "queue_step"):
        ahead = max(0.0, ahead - rate * (t - last) / HZ) + 1
        most, last = max(most, ahead), t
    return most


@pytest.mark.parametrize(
    "mm, moves, turn", [(0.02, 3000, 0.3), (0.05, 2500, 2.0), (0.2, 1500, 2.0)]
)
def test_commands_keep_to_the_rate_and_its_burst(mm, moves, turn):
    rate, burst = 1000.0, 100.0
    free = planned(machine(20_000.0), wander(mm, moves, turn, 1))
    spec = machine(20_000.0, budget=budget(commands_s=rate, burst=burst))
    motion, plan, messages = planned(spec, wander(mm, moves, turn, 1))
    assert most_ahead(messages, rate) <= 1.1 * burst
    asked = sum(m[0] == "queue_step" for m in free[2]) / (free[0].clock / HZ)
    assert asked > 1.5 * rate
    assert_trapezoids(plan)
    assert motion.counts() == free[0].counts()


def two_boards(x_rate, rest_rate):
    """X on the main board, the other motors on a second one, with a burst of 0.1 s each."""
    spec = machine(20_000.0)
    for stepper in spec["steppers"][1:]:
        stepper["board"] = 1
    spec["budgets"] = [
        budget(commands_s=rate, burst=0.1 * rate, boards=[i])
        for i, rate in enumerate((x_rate, rest_rate))
    ]
    return spec


@pytest.mark.parametrize("rates", [(400.0, 4000.0), (4000.0, 700.0), (500.0, 800.0)])
@pytest.mark.parametrize("cut", [False, True])
def test_each_board_keeps_to_its_own_rate(rates, cut):
    motion = Motion(two_boards(*rates))
    for i, target in enumerate(wander(0.1, 1500, 0.5, 4)):
        motion.push(target, 300.0, "print")
        if cut and i % 20 == 19:
            motion.flush()
            motion.replan_from(motion.clock - 0.02 * HZ)
    motion.flush()
    messages = motion.take_messages()
    for rate, slots in zip(rates, ((0,), (1, 2, 3)), strict=True):
        own = [m for m in messages if m[1] in slots]
        assert most_ahead(own, rate) <= (1.6 if cut else 1.1) * 0.1 * rate


def test_a_board_is_not_charged_with_the_motors_of_another():
    """A slow board of motors at standstill bounds nothing."""
    line = [[0.05 * i, 0.0, 0.0, 0.0] for i in range(1000)]
    free = planned(machine(20_000.0), line)
    apart = planned(two_boards(4000.0, 20.0), line)
    together = planned(machine(20_000.0, budget=budget(commands_s=20.0, burst=2.0)), line)
    assert apart[0].clock == free[0].clock
    assert apart[2] == free[2]
    assert together[0].clock > 1.05 * free[0].clock


def zigzag(mm, moves, turn):
    """`wander`, with Z going up and down as well, and filament in portions of its own."""
    random, e = Random(7), 0.0
    for x, y, _, _ in wander(mm, moves, turn, 1):
        e += 0.03 * mm * random.choice([0.5, 1, 1, 2])
        yield [x, y, 2.5 + 0.05 * mm * random.uniform(-1, 1), e]


@pytest.mark.parametrize("accel, z_accel", [(1000.0, 100.0), (3000.0, 100.0), (20_000.0, 2000.0)])
@pytest.mark.parametrize(
    "mm, turn",
    [(0.02, 0.3), (0.05, 2.0), (0.2, 2.0), (0.2, 0.05), (0.5, 2.0), (1.0, 0.2), (3.0, 2.0)],
)
def test_link_budget_with_35_ms_burst_is_respected(accel, z_accel, mm, turn):
    """From 600 commands a second on, whatever the file asks; nothing is late by 60 ms."""
    for rate in (600.0, 1174.0):
        spec = machine(accel, budget=budget(commands_s=rate, burst=0.035 * rate))
        spec["axes"][2].update(accel=z_accel, speed=12.0)
        motion, plan, messages = planned(spec, zigzag(mm, 700, turn))
        assert most_ahead(messages, rate) < 0.06 * rate
        assert motion.counts()[0] == round(80 * plan[-1].end_mm[0])


@pytest.mark.parametrize("name", ["delta", "rotary-delta", "scara"])
def test_link_budget_holds_for_nonlinear_motors(name):
    """They cost it commands all along."""
    rate = 600.0
    spec = config.load(name).core_spec()
    spec["budgets"] = [budget(commands_s=rate, burst=0.035 * rate)]
    x, y = (100.0, 100.0) if name == "scara" else (0.0, 0.0)
    motion = Motion(spec)
    motion.set_position([x - 12.0, y - 8.0, 5.0, 0.0])
    for i in range(40):
        way = [x + (12.0 if i % 2 else -12.0), y - 8.0 + 0.4 * i, 5.0, 0.5 * i]
        motion.push(way, 80.0, "print")
    motion.flush()
    assert most_ahead(motion.take_messages(), rate * HZ / spec["clock_hz"]) < 0.06 * rate


def test_smooth_curves_of_short_moves_need_few_commands():
    """A command lasts as long as the curve lets it, over as many moves as that may be."""
    spec = machine(budget=budget(commands_s=1100.0, burst=40.0))
    _, plan, messages = planned(spec, circle(0.05, 3), 100.0)
    assert len(plan) > 5 * sum(m[0] == "queue_step" for m in messages)
    assert {m.cruise_speed for m in plan[200:-200]} == {100.0}
    assert {m.tolerance_ticks for m in plan} == {0.0}


def circle(mm, turns, radius=20.0):
    n = round(2 * pi * radius * turns / mm)
    return [[radius * sin(i * mm / radius), radius * cos(i * mm / radius), 0, 0] for i in range(n)]


def test_the_tolerance_widens_before_the_speed_drops():
    targets = circle(0.05, 3)
    free = planned(machine(), targets, 100.0)[1]
    little = planned(machine(budget=budget(commands_s=1000.0)), targets, 100.0)[1]
    much = planned(machine(budget=budget(commands_s=150.0)), targets, 100.0)[1]
    assert [m.cruise_speed for m in little] == [m.cruise_speed for m in free]
    widths = [m.tolerance_ticks for m in little]
    assert 32 < max(widths) < WIDEST
    fastest = max(m.cruise_speed for m in much[1:])
    assert fastest < 0.5 * max(m.cruise_speed for m in free)
    for move in much:
        if move.speed_cap < 99.9:
            assert move.tolerance_ticks == WIDEST


def test_wider_bounds_need_fewer_commands():
    targets = list(wander(0.2, 800, 0.3, 5))
    spec = machine(6000.0, budget=budget(commands_s=1800.0))
    motion, plan, messages = planned(spec, targets)
    wide = [m for m in plan if m.tolerance_ticks > 0]
    assert 0.2 * len(plan) < len(wide) < len(plan)
    for axis in (0, 1):
        ideal, widths = [], []
        for move in plan:
            steps = list(crossing_ticks(move, axis, 80.0))
            ideal += steps
            widths += [move.tolerance_ticks or 32.0] * len(steps)
        done = executed_ticks(messages, axis)
        if motion.dropped_pairs(axis) == 0:
            assert_within_bound(done, ideal, widths)
    strict = planned(machine(6000.0), targets)
    ours, theirs = (sum(m[0] == "queue_step" for m in ms) for ms in (messages, strict[2]))
    assert ours < 0.9 * theirs


def test_a_burst_within_the_slots_is_free():
    targets = list(wander(0.05, 60, 0.3, 2))
    free = planned(machine(20_000.0), targets)[1]
    bound = planned(machine(20_000.0, budget=budget(commands_s=500.0, burst=400.0)), targets)[1]
    assert all(m.tolerance_ticks == 0 for m in bound)
    assert [m.cruise_speed for m in bound] == [m.cruise_speed for m in free]


@pytest.mark.parametrize("seed", range(6))
def test_a_cut_keeps_counts_and_commands_valid(seed):
    targets = list(wander(0.1, 600, 0.5, seed))
    spec = machine(20_000.0, budget=budget(commands_s=1200.0, burst=50.0))
    whole = planned(spec, targets)[0]
    motion = Motion(spec)
    for i, target in enumerate(targets):
        motion.push(target, 300.0, "print")
        if i % 150 == 149:
            motion.flush()
            motion.hold_from(motion.clock * Random(seed * 10 + i).uniform(0.6, 1.0))
            motion.release()
    motion.flush()
    assert motion.counts() == whole.counts()
    messages = motion.take_messages()
    for i, count in enumerate(motion.counts()):
        assert sum(way for _, way in executed_ticks(messages, i)) == count


@pytest.mark.parametrize("how", ["replan", "hold", "flush"])
def test_a_cut_gives_no_new_burst(how):
    """However often the plan is cut, the board's slots fill only once."""
    rate, burst = 500.0, 60.0
    motion = Motion(machine(20_000.0, budget=budget(commands_s=rate, burst=burst)))
    messages = []
    for i, target in enumerate(wander(0.1, 1200, 0.5, 4)):
        motion.push(target, 300.0, "print")
        if i % 20 != 19:
            continue
        if how == "flush":
            motion.flush()
        elif how == "replan":
            motion.flush()
            motion.replan_from(motion.clock - 0.02 * HZ)
        else:
            motion.flush()
            motion.hold_from(motion.clock - 0.02 * HZ)
            motion.release()
    motion.flush()
    messages = motion.take_messages()
    # Commands that a cut shortens count as whole ones.
    assert most_ahead(messages, rate) <= 1.6 * burst


def test_messages_do_not_depend_on_when_they_are_taken():
    targets = list(wander(0.1, 900, 0.5, 8))
    spec = machine(20_000.0, budget=budget(commands_s=1200.0, burst=50.0))
    whole = planned(spec, targets)[2]
    motion, pieces = Motion(spec), []
    for target in targets:
        motion.push(target, 300.0, "print")
        pieces += motion.take_messages(motion.clock - 0.3 * HZ)
    motion.flush()
    assert pieces + motion.take_messages() == whole


def with_room_for_once():
    """Slots for these moves once, with a tenth to spare, of which one a second becomes free."""
    targets = list(wander(0.05, 60, 0.3, 2))

    def spec(burst):
        return machine(20_000.0, budget=budget(commands_s=1.0, burst=burst))

    def fits(burst):
        return all(m.tolerance_ticks == 0 for m in planned(spec(burst), targets)[1])

    least = next(burst for burst in range(1000) if fits(burst))
    return Motion(spec(1.1 * least)), targets, least


@pytest.mark.parametrize("settled", [True, False])
def test_cut_returns_the_budget_of_revoked_moves(settled):
    motion, targets, _ = with_room_for_once()
    for target in targets:
        motion.push(target, 300.0, "print")
    if settled:
        motion.flush()
    for _ in range(5):
        motion.replan_from(0.5 * motion.clock)
        if settled:
            motion.flush()
    motion.flush()
    assert all(m.tolerance_ticks == 0 for m in motion.take_moves())


@pytest.mark.parametrize("how", ["dwell", "wait"])
def test_while_the_machine_is_idle_the_slots_become_free(how):
    motion, targets, least = with_room_for_once()
    motion.set_position([0.0, 0.0, 0.0, 0.0])
    for target in targets:
        motion.push(target, 300.0, "print")
    if how == "dwell":
        motion.push(targets[-1], 300.0, "dwell", duration_s=least)
    else:
        motion.flush()
        motion.wait_until(motion.clock + least * HZ)
    for target in targets:
        motion.push([a + b for a, b in zip(targets[-1], target, strict=True)], 300.0, "print")
    motion.flush()
    assert all(m.tolerance_ticks == 0 for m in motion.take_moves())
