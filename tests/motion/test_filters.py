"""Shapers and pressure advance, from planned moves to executed steps, against the plain oracle."""

from __future__ import annotations

import random
from itertools import pairwise
from math import ceil, inf

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import filters as oracle
from tests.oracles import motion as executed

from passo._core import Job, Motion
from passo.config import load
from passo.config.shapers import SHAPER_TYPES, impulses

from . import machines
from .test_replan import assert_arrived, push_all
from .test_steps import paths

HZ = 16e6
SCALES = {0: 80.0, 1: 80.0, 2: 400.0, 3: 95.5}
NONE: list[tuple[float, float]] = []


def filtered(
    spec=None,
    x=NONE,
    y=NONE,
    z=NONE,
    smooth=0.0,
    advance=0.0,
    box=0.0,
    knees=(),
    in_step=False,
    gaps=(),
):
    filters = {
        "shapers": [x, y, z],
        "smooth_s": [smooth / 2],
        "box_s": box,
        "knees": [list(knees)],
        "shaped": [in_step],
        "gaps": list(gaps),
    }
    spec = spec or machines.cartesian()
    extruders = [extruder | {"advance_s": advance} for extruder in spec["extruders"]]
    return spec | {"extruders": extruders, "filters": filters}


def mean_of(shaper):
    return sum(a * t for a, t in shaper)


def delay_of(*shapers, half=0.0, box=0.0):
    means = [mean_of(s) + box / 2 for s in shapers]
    return ceil(max(*means, (max(half, box) + half) / 2 if half else 0.0) * HZ)


def law_of(planned, impulses, delay, box):
    """The law of an axis with a shaper, or without one, and with a limit of jerk, or without."""
    averaged = oracle.averaged(planned, box * HZ) if box else planned
    return oracle.shaped(averaged, impulses or [(1.0, 0.0)], delay)


def print_path(seed, moves):
    """Random moves, most of them short: prints, retracts, hops and dwells."""
    rng = random.Random(seed)
    at = [0.0, 0.0, 0.0, 0.0]
    for _ in range(moves):
        kind = rng.choices(["print", "travel", "extrude", "hop", "dwell"], [12, 2, 1, 1, 1])[0]
        if kind == "dwell":
            yield list(at), 1.0, "dwell", rng.choice([0.005, 0.05])
            continue
        mm = rng.choice([0.02, 0.3, 1.0, 8.0])
        if kind == "hop":
            at[2] += rng.choice([0.2, -0.2])
        elif kind == "extrude":
            at[3] += rng.choice([0.8, -0.8])
        else:
            dx, dy = rng.uniform(-mm, mm), rng.uniform(-mm, mm)
            at[0] += dx
            at[1] += dy
            if kind == "print":
                at[3] += 0.04 * (dx * dx + dy * dy) ** 0.5
        kind = "travel" if kind == "hop" else kind
        yield list(at), rng.choice([20.0, 60.0, 150.0]), kind, 0.0


def plan(spec, path):
    motion = Motion(spec)
    for target, feed, kind, seconds in path:
        motion.push(target, feed, kind, duration_s=seconds)
    motion.flush()
    return motion, motion.take_moves()


def advance_of(seconds):
    def advance(move):
        moves = move.start_mm[0] != move.end_mm[0] or move.start_mm[1] != move.end_mm[1]
        return (
            seconds if move.kind == "print" and moves and move.end_mm[3] > move.start_mm[3] else 0
        )

    return advance


@pytest.mark.parametrize("kind", SHAPER_TYPES)
def test_shaped_steps_are_those_of_the_oracle(kind):
    x, y = impulses(kind, 47.0, 0.08), impulses("zvd", 35.0, 0.12)
    motion, moves = plan(filtered(x=x, y=y), print_path(kind, 25))
    messages, delay = motion.take_messages(), delay_of(x, y)
    for slot, shaper in ((0, x), (1, y)):
        law = oracle.shaped(oracle.Planned(moves, slot), shaper, delay)
        wanted = oracle.steps(law, 0, motion.clock, SCALES[slot], 2000)
        executed.assert_within_bound(executed.executed_ticks(messages, slot), wanted)


@pytest.mark.parametrize("smooth", [0.04, 0.02, 0.001])
def test_advanced_steps_are_those_of_the_oracle(smooth):
    motion, moves = plan(filtered(smooth=smooth, advance=0.05), print_path(3, 25))
    half = smooth / 2
    law = oracle.advanced(oracle.Planned(moves, 3, advance_of(0.05)), half, half * HZ)
    wanted = oracle.steps(law, 0, motion.clock, SCALES[3], 4000)
    assert len(wanted) > 200
    executed.assert_within_bound(executed.executed_ticks(motion.take_messages(), 3), wanted)


@pytest.mark.parametrize(
    ("name", "index", "numbers", "reason"),
    [
        ("shaper", 0, [1.0, 0.0], "no motion filter has the setting shaper"),
        ("shapers", 3, [1.0, 0.0], "no such axis or extruder"),
        ("shapers", 0, [0.5, 0.0, 0.5], "each a weight and a time"),
        ("shapers", 0, [0.125, 0.0] * 8, "5 impulses at most"),
        ("gaps", 0, [2.0, 1.0], "no such gap"),
        ("box_s", 0, [], "one number"),
    ],
)
def test_refused_setting_of_a_filter_changes_nothing(name, index, numbers, reason):
    shaper = impulses("zv", 50.0, 0.1)
    job = Job(load("i3").core_spec() | {"filters": {"shapers": [shaper, [], []]}})
    with pytest.raises(ValueError, match=reason):
        job.filters.set(name, index, numbers)
    assert job.filters.delay_s == delay_of(shaper) / HZ


BOX = 0.03


def test_limited_jerk_is_the_profile_of_seven_segments():
    """20 mm at 100 mm/s, 3000 mm/s² and 1e5 mm/s³: each ramp takes a/j longer."""
    motion = Motion(machines.cartesian())
    motion.push([20.0, 0.0, 0.0, 0.0], 100.0)
    motion.flush()
    jerk, begin, total = 1e5, -0.5 * BOX, 0.79 / 3
    law = oracle.averaged(oracle.Planned(motion.take_moves(), 0), BOX * HZ)
    for seconds, mm in {
        0.0: 0.0,
        0.01: jerk * 0.01**3 / 6,
        0.03: 0.45,
        0.19 / 3: 9.5 / 3,
        total - 0.01: 20 - jerk * 0.01**3 / 6,
        total: 20.0,
    }.items():
        assert law((begin + seconds) * HZ) == pytest.approx(mm, abs=1e-8)


@pytest.mark.parametrize("box", [0.012, BOX])
def test_steps_of_limited_jerk_are_those_of_the_oracle(box):
    """On X with a shaper, on Y without one, and on an extruder with advance."""
    x = impulses("mzv", 47.0, 0.08)
    motion, moves = plan(filtered(x=x, smooth=0.04, advance=0.05, box=box), print_path(3, 9))
    messages, delay = motion.take_messages(), delay_of(x, half=0.02, box=box)
    planned = [oracle.Planned(moves, slot, advance_of(0.05)) for slot in (0, 1, 2, 3)]
    for slot, law in (
        (0, law_of(planned[0], x, delay, box)),
        (1, law_of(planned[1], NONE, delay, box)),
        (3, oracle.advanced(planned[3], 0.02, delay, box * HZ)),
    ):
        wanted = oracle.steps(law, 0, motion.clock, SCALES[slot], 4000)
        assert len(wanted) > 10
        executed.assert_within_bound(executed.executed_ticks(messages, slot), wanted)


KNEES = [(1.0, 0.6), (2.5, 0.2), (4.0, 0.0)]  # mm/s, share of the advance


@pytest.mark.parametrize("box", [0, BOX])
def test_advance_with_knees_is_that_of_the_oracle(box):
    """The polyline acts before the smoothing, at speeds below and above each knee."""
    motion, moves = plan(
        filtered(smooth=0.04, advance=0.3, box=box, knees=KNEES), print_path(3, 12)
    )
    planned = oracle.Planned(moves, 3, advance_of(0.3), KNEES)
    fastest = max(m.cruise_speed * abs(m.end_mm[3] - m.start_mm[3]) / m.length for m in moves)
    assert fastest > KNEES[-1][0]
    law = oracle.advanced(planned, 0.02, delay_of(NONE, half=0.02, box=box), box * HZ)
    wanted = oracle.steps(law, 0, motion.clock, SCALES[3], 3000)
    executed.assert_within_bound(executed.executed_ticks(motion.take_messages(), 3), wanted)


X, Y = impulses("mzv", 47.0, 0.08), impulses("ei", 33.0, 0.1)


@pytest.mark.parametrize(
    ("y", "advance", "box", "knees"),
    [
        (X, 0, 0, ()),
        (X, 0.05, 0, KNEES),
        (Y, 0, 0, ()),
        (Y, 0.05, 0, KNEES),
        (Y, 0.05, BOX, ()),
    ],
)
def test_filament_is_in_step_with_the_shaped_head(y, advance, box, knees):
    half = 0.02 if advance else 0.0
    smoothed = {"smooth": 2 * half, "advance": advance, "knees": knees}
    spec = filtered(x=X, y=y, box=box, in_step=True, **smoothed)
    motion, moves = plan(spec, print_path(4, 12))
    delay = ceil((max(mean_of(X), mean_of(y)) + (max(half, box) + half if half else box) / 2) * HZ)
    parts = []
    for axis, shaper in enumerate((X, y, [(1.0, 0.0)])):
        planned = oracle.Share(moves, axis, advance_of(advance), knees)
        law = oracle.advanced(planned, half, 0, box * HZ) if advance else planned
        parts.append(oracle.shaped(law, X if y is X else shaper, delay))
    wanted = oracle.steps(lambda t: sum(p(t) for p in parts), 0, motion.clock, SCALES[3], 8000)
    assert len(wanted) > 40
    executed.assert_within_bound(executed.executed_ticks(motion.take_messages(), 3), wanted)


def test_filters_end_at_the_counts_of_the_plan():
    x, y, z = impulses("3hump_ei", 20.0, 0.2), impulses("ei", 60.0, 0.0), impulses("zv", 90.0, 0.1)
    for seed in range(40):
        path = list(print_path(seed, 60))
        plain, _ = plan(machines.cartesian(), path)
        more = {"box": seed % 2 * BOX, "in_step": seed % 4 > 1}
        every, _ = plan(filtered(x=x, y=y, z=z, smooth=0.04, advance=0.3, **more), path)
        assert every.counts() == plain.counts()
        messages = every.take_messages()
        for target, count in enumerate(plain.counts()):
            assert sum(d for _, d in executed.executed_ticks(messages, target)) == count


def test_axis_without_a_filter_is_only_delayed():
    path = list(print_path(7, 40))
    plain, _ = plan(machines.cartesian(), path)
    x = impulses("mzv", 50.0, 0.1)
    shaped, _ = plan(filtered(x=x), path)
    before, after = plain.take_messages(), shaped.take_messages()
    delay = delay_of(x)
    for target in (1, 2):
        wanted = executed.executed_ticks(before, target)
        found = executed.executed_ticks(after, target)
        assert [d for _, d in wanted] == [d for _, d in found]
        assert all(abs(b + delay - a) <= 64 for (b, _), (a, _) in zip(wanted, found, strict=True))


def test_smoothing_alone_does_not_move_the_filament():
    path = list(print_path(7, 40))
    plain, _ = plan(machines.cartesian(), path)
    smoothed, _ = plan(filtered(smooth=0.2), path)
    wanted = executed.executed_ticks(plain.take_messages(), 3)
    found = executed.executed_ticks(smoothed.take_messages(), 3)
    delay = delay_of(NONE, half=0.1)
    assert [d for _, d in wanted] == [d for _, d in found]
    assert all(abs(b + delay - a) <= 64 for (b, _), (a, _) in zip(wanted, found, strict=True))


def test_motors_of_one_extruder_are_advanced_alike():
    spec = filtered(smooth=0.04, advance=0.05, knees=KNEES)
    spec["steppers"] = [*spec["steppers"], machines.stepper("e_2", "extruder", 0, SCALES[3])]
    motion, _ = plan(spec, print_path(4, 20))
    messages = motion.take_messages()
    first = executed.executed_ticks(messages, 3)
    assert len(first) > 100
    assert executed.executed_ticks(messages, 4) == first


def test_wipe_while_retracting_is_not_advanced():
    """With an advance far too large for the extruder, which is as fast as it may be."""
    spec = machines.cartesian()
    spec["extruders"][0] |= {"speed": 8.0, "accel": 500.0}
    line, wipe = [40.0, 0.0, 0.0, 2.0], [36.0, 1.0, 0.0, 1.0]
    path = [(line, 100.0, "print", 0.0), (wipe, 100.0, "print", 0.0)]
    motion, moves = plan(filtered(spec, smooth=0.04, advance=1.5), path)
    assert [m.advance_s for m in moves] == [1.5, 0.0]
    ticks = executed.executed_ticks(motion.take_messages(), 3)
    closest = min(b - a for (a, d), (b, e) in pairwise(ticks) if d == e)
    assert closest > 0.95 * HZ / (8.0 * SCALES[3])


EVERY = {
    "x": impulses("mzv", 40.0, 0.1),
    "y": impulses("3hump_ei", 30.0, 0.05),
    "z": impulses("zv", 60.0, 0.0),
    "smooth": 0.04,
    "advance": 0.05,
}


class Joined:
    """The plan before a cut, and the one that follows it."""

    def __init__(self, before, after, cut):
        self.before, self.after, self.at = before, after, cut
        earlier = [t for t in before.breaks if t < cut]
        self.breaks = [*earlier, cut, *(t for t in after.breaks if t > cut)]

        self.apart = before(cut) - after(cut)  # shares of filament count from a plan's beginning

    def __call__(self, tick):
        return self.before(tick) if tick < self.at else self.after(tick) + self.apart

    def advanced(self, tick):
        return (self.before if tick < self.at else self.after).advanced(tick)

    def cuts(self, low, high):
        parts = (*self.before.cuts(low, high), *self.after.cuts(low, high), self.at)
        return sorted({t for t in parts if low <= t <= high})


def filament_in_step(before, after, cut, box, delay):
    """The law of an extruder with all filters, whose parts follow the shapers of X and Y."""
    parts = []
    for axis, shaper in enumerate((EVERY["x"], EVERY["y"], [(1.0, 0.0)])):
        shares = [
            oracle.Share(moves, axis, advance_of(0.05)) for moves in (before, after or before)
        ]
        law = oracle.advanced(Joined(*shares, cut if after else inf), 0.02, 0, box * HZ)
        parts.append(oracle.shaped(law, shaper, delay))
    return lambda tick: sum(part(tick) for part in parts)


@pytest.mark.parametrize(("seed", "box"), [(0, 0), (1, 0), (2, 0), (3, 0), (4, BOX), (5, BOX)])
@pytest.mark.parametrize("action", ["replan", "hold"])
def test_cut_continues_the_filtered_law(seed, box, action):
    path = list(print_path(seed, 40))
    motion, before = plan(filtered(**EVERY, box=box, in_step=box > 0), path)
    rng = random.Random(seed)
    total, sent = motion.clock, rng.random()
    messages = motion.take_messages(before=total * sent)
    motion.set_speed_factor(rng.choice([0.5, 1.6]))
    if action == "replan":
        cut = motion.replan_from(total * rng.random())
    else:
        cut = motion.hold_from(total * rng.random())
        motion.wait_until(motion.clock + rng.choice([0, HZ]))
        motion.release()
    motion.flush()
    after = motion.take_moves()
    messages += motion.take_messages()
    assert [m[2] for m in messages] == sorted(m[2] for m in messages)
    delay = delay_of(EVERY["x"], EVERY["y"], EVERY["z"], half=0.02, box=box)
    if box:
        delay = ceil((mean_of(EVERY["y"]) + (box + 0.02) / 2) * HZ)
    for slot in (0, 1, 3):
        found = executed.executed_ticks(messages, slot)
        count = motion.counts()[slot]
        assert sum(d for _, d in found) == count
        old = oracle.Planned(before, slot, advance_of(0.05))
        new = oracle.Planned(after or before, slot, advance_of(0.05))
        joined = Joined(old, new, cut) if after else old
        if slot == 3 and box:
            law = filament_in_step(before, after, cut, box, delay)
        elif slot == 3:
            law = oracle.advanced(joined, 0.02, delay)
        else:
            law = law_of(joined, EVERY["xy"[slot]], delay, box)
        start, end = max(cut - 0.1 * HZ, 0), min(cut + 0.15 * HZ, motion.clock)
        wanted = oracle.steps(law, start, end, SCALES[slot], 4000)
        near = 300 + 64  # ticks: where a step that is due is pushed to, after a cut
        inside = [s for s in found if start + 99 < s[0] < end - 99 and abs(s[0] - cut) > near]
        ideal = [s for s in wanted if start + 99 < s[0] < end - 99 and abs(s[0] - cut) > near]
        assert abs(len(inside) - len(ideal)) <= 2
        for tick, direction in inside:
            assert any(
                abs(t - tick) < 40 and d == direction for t, d in ideal if abs(t - tick) < 40
            )


@pytest.mark.parametrize("box", [0.0, BOX])
@pytest.mark.parametrize(
    ("spec", "z"), [(machines.cartesian(), 0.0), (machines.nonlinear("delta")[0], 50.0)]
)
def test_resumed_motion_is_at_standstill_during_a_dwell(spec, z, box):
    """The moves up to the dwell are solved before the one that follows it is known."""

    def executed_steps(spec, holds):
        motion = Motion(spec)
        motion.set_position([0.0, 0.0, z, 0.0])
        motion.push([-1.4, 6.4, z, 0.3], 20.0)
        motion.push([-1.4, 6.4, z, 0.3], 1.0, "dwell", duration_s=0.05)
        motion.push([-1.5, 6.5, z, 0.3], 20.0, "travel")
        motion.flush()
        messages = motion.take_messages(before=0.6 * motion.clock)
        if holds:
            motion.hold_from(0.4 * motion.clock)
            motion.release()
            motion.flush()
        messages += motion.take_messages()
        return [[d for _, d in executed.executed_ticks(messages, target)] for target in range(4)]

    shaper = EVERY["x"]
    found = executed_steps(filtered(spec, x=shaper, y=shaper, z=shaper, box=box), True)
    for steps, plain in zip(found, executed_steps(spec, False), strict=True):
        assert sum(steps) == sum(plain)
        assert len(steps) - len(plain) in (0, 2)  # a motor of a delta may turn at another place


BOXES = st.sampled_from([0.0, BOX])


@given(
    paths,
    st.floats(0, 1),
    st.floats(0, 1),
    st.floats(0.2, 3),
    st.floats(500, 6000),
    BOXES,
    st.booleans(),
)
@settings(max_examples=40, deadline=None)
def test_replanned_filtered_path_arrives(path, sent, where, factor, accel, box, in_step):
    motion = Motion(filtered(**EVERY, box=box, in_step=in_step))
    end = push_all(motion, path)
    motion.flush()
    total = motion.clock
    messages = motion.take_messages(before=total * sent)
    motion.set_speed_factor(factor)
    motion.set_accel(accel)
    motion.replan_from(total * where)
    motion.flush()
    assert_arrived(motion, messages + motion.take_messages(), end)


@given(paths, st.floats(0, 1), st.floats(0, 1), BOXES, st.booleans())
@settings(max_examples=40, deadline=None)
def test_held_filtered_path_arrives(path, sent, where, box, in_step):
    motion = Motion(filtered(**EVERY, box=box, in_step=in_step))
    end = push_all(motion, path)
    motion.flush()
    total = motion.clock
    messages = motion.take_messages(before=total * sent)
    motion.hold_from(total * where)
    messages += motion.take_messages()
    motion.wait_until(motion.clock + HZ)
    motion.release()
    motion.flush()
    assert_arrived(motion, messages + motion.take_messages(), end)


def test_oracle_has_the_golden_positions_of_shaped_motion():
    """20 mm at 100 mm/s and 3000 mm/s², mzv and ei at 50 Hz and 0.1, in their own middle."""
    motion = Motion(machines.cartesian())
    motion.push([20.0, 0.0, 0.0, 0.0], 100.0)
    motion.flush()
    planned = oracle.Planned(motion.take_moves(), 0)
    for kind, golden in {
        "mzv": {
            -0.005: 0.001231470,
            0.0: 0.023136353,
            0.01: 0.198880988,
            0.05: 3.333333333,
            0.2: 18.310196980,
            0.24: 19.998756496,
        },
        "ei": {0.0: 0.038075227, 0.2: 18.295258107, 0.24: 19.992862340},
    }.items():
        law = oracle.shaped(planned, impulses(kind, 50.0, 0.1), 0)
        for seconds, mm in golden.items():
            assert law(seconds * HZ) == pytest.approx(mm, abs=2e-8)


def test_oracle_has_the_golden_positions_of_advanced_filament():
    """10 mm at 50 mm/s and 1000 mm/s² with 0.04 mm of filament a mm, 0.05 s over 0.04 s."""
    motion = Motion(machines.cartesian(print_accel=1000.0))
    motion.push([10.0, 0.0, 0.0, 0.4], 50.0, "print")
    motion.flush()
    law = oracle.advanced(oracle.Planned(motion.take_moves(), 3, advance_of(0.05)), 0.02, 0)
    golden = {
        -0.01: 0.000833333,
        0.0: 0.006666667,
        0.02: 0.048,
        0.05: 0.143333333,
        0.15: 0.35,
        0.22: 0.442,
        0.25: 0.406666667,
        0.27: 0.4,
    }
    for seconds, mm in golden.items():
        assert law(seconds * HZ) == pytest.approx(mm, abs=1e-9)


@pytest.mark.parametrize(("moves", "box"), [(25, 0.0), (7, BOX)])
def test_belts_of_core_machines_follow_both_shaped_axes(moves, box):
    """And end at the counts of the plan, which rounds the sum of X and Y otherwise."""
    spec = machines.cartesian() | {"geometry": {"kind": "corexy"}}
    x, y = impulses("mzv", 47.0, 0.1), impulses("ei", 33.0, 0.1)
    path = list(print_path(11, moves))
    plain, _ = plan(spec, path)
    motion, moves = plan(filtered(spec, x=x, y=y, box=box), path)
    assert motion.counts() == plain.counts()
    delay, messages = delay_of(x, y, box=box), motion.take_messages()
    laws = [law_of(oracle.Planned(moves, s), i, delay, box) for s, i in ((0, x), (1, y))]
    for motor, sign in ((0, 1.0), (1, -1.0)):
        wanted = oracle.steps(
            lambda tick, sign=sign: laws[0](tick) + sign * laws[1](tick),
            0,
            motion.clock,
            80.0,
            2000,
        )
        executed.assert_within_bound(executed.executed_ticks(messages, motor), wanted)


FAR = (0.2, 0.2, 0.2, 0.01, 0.01, 0.01, 0.001, 0.001, 0.2)
NEAR = (0.1, 0.01, 0.01, 0.001, 0.001)  # of the reach


@pytest.mark.parametrize(
    ("kind", "shares", "box"),
    [
        ("delta", FAR, 0.0),
        ("rotary-delta", FAR, 0.0),
        ("scara", FAR, 0.0),
        ("polar", FAR, 0.0),
        ("winch", FAR, 0.0),
        ("delta", NEAR, BOX),
        ("polar", NEAR, BOX),
        ("scara", NEAR, BOX),
    ],
)
def test_nonlinear_motors_follow_the_shaped_nozzle(kind, shares, box):
    """On long moves, on short ones, and where a motor turns in the middle of an interval."""
    spec, geometry = machines.nonlinear(kind)
    x, y, z = (impulses("mzv", hz, 0.1) for hz in (47.0, 33.0, 60.0))
    if box:
        y = z = NONE
    motion = Motion(filtered(spec, x=x, y=y, z=z, box=box))
    centre, half = machines.REACH[kind]
    motion.set_position([*map(float, centre), 0.0])
    rng = random.Random(5)
    for share in shares:
        target = [c + h * rng.uniform(-share, share) for c, h in zip(centre, half, strict=True)]
        motion.push([*target, 0.0], 120.0)
    begin = motion.counts()
    motion.flush()
    moves, messages, delay = motion.take_moves(), motion.take_messages(), delay_of(x, y, z, box=box)
    shapers = enumerate((x, y, z))
    laws = [law_of(oracle.Planned(moves, i), shaper, delay, box) for i, shaper in shapers]
    assert begin != motion.counts()

    def true_at(tick):
        return machines.of_box(kind, geometry, tuple(law(tick) for law in laws))

    for motor in range(len(geometry.actuators)):
        per_unit = spec["steppers"][motor]["steps_per_unit"]
        wanted = oracle.steps(
            lambda tick, motor=motor: true_at(tick)[motor],
            0,
            motion.clock,
            per_unit,
            3000,
        )
        assert len(wanted) > (80 if box else 500)
        executed.assert_within_bound(executed.executed_ticks(messages, motor), wanted)


@pytest.mark.parametrize("box", [0.0, BOX])
def test_mesh_lifts_the_shaped_nozzle(box):
    """Z follows the bed where the nozzle is, not where the plan is."""
    x = impulses("zvd", 30.0, 0.1)
    motion = Motion(filtered(x=x, box=box))
    slope = 0.02  # mm of height a mm of X
    motion.set_height_map((-100.0, -100.0), (200.0, 200.0), [[-2.0, 2.0], [-2.0, 2.0]])
    motion.push([40.0, 0.0, 0.0, 0.0], 150.0)
    motion.push([0.0, 0.0, 0.0, 0.0], 150.0)
    motion.flush()
    moves, messages = motion.take_moves(), motion.take_messages()
    law = law_of(oracle.Planned(moves, 0), x, delay_of(x, NONE, box=box), box)
    wanted = oracle.steps(lambda tick: slope * law(tick), 0, motion.clock, 400.0, 2000)
    assert len(wanted) > 600
    executed.assert_within_bound(executed.executed_ticks(messages, 2), wanted)


def test_extruder_keeps_its_limits_with_advance():
    """Filament at its steepest: v + A a and a (1 + A/h) stay within speed and acceleration."""
    spec = machines.cartesian()
    spec["extruders"][0] |= {"speed": 8.0, "accel": 200.0}
    motion = Motion(filtered(spec, smooth=0.04, advance=0.06), False)
    for i in range(1, 12):
        motion.push([i % 2 * 20.0, i * 1.0, 0.0, i * 1.0], 150.0, "print")
    motion.flush()
    names = Job(load("i3").core_spec()).limits.names
    moves = motion.take_moves()
    for m in moves:
        part = (m.end_mm[3] - m.start_mm[3]) / m.length
        accel = max(m.acceleration, m.deceleration) * part
        assert accel * (1 + 0.06 / 0.02) <= 200.0 * (1 + 1e-9)
        assert m.cruise_speed * part + 0.06 * accel <= 8.0 * (1 + 1e-9)
    assert {names[m.accel_limit] for m in moves} == {"pressure advance"}


def test_advance_bounds_the_speed_where_printing_begins():
    """Straight on from a travel move into a line: the filament starts at once, and the advance with
    it. Smoothed over 2 h, a change by c of what is advanced adds c/h to the extruder's speed and
    c/h² to its acceleration."""
    spec = machines.cartesian()
    spec["extruders"][0] |= {"speed": 8.0, "accel": 200.0, "jerk": 100.0}
    motion = Motion(filtered(spec, smooth=0.04, advance=0.06), False)
    motion.push([40.0, 0.0, 0.0, 0.0], 150.0)
    motion.push([80.0, 0.0, 0.0, 2.0], 150.0, "print")
    motion.push([120.0, 0.0, 0.0, 2.0], 150.0)
    motion.flush()
    moves = motion.take_moves()
    h, change = 0.02, 0.06 * 0.05
    part, accel = 2.0 / 40.0, moves[1].deceleration
    fastest = (8.0 - 0.06 * part * accel) / (part + change / h)
    for m in moves[1:]:
        assert m.advance_binds
        assert m.start_cap == pytest.approx(min(fastest, 200.0 * h * h / change))
    assert not moves[0].advance_binds
    law = oracle.advanced(oracle.Planned(moves, 3, advance_of(0.06)), h, 0)
    every = 0.001 * HZ
    ticks = [i * every for i in range(int(motion.clock / every))]
    places = [law(tick) for tick in ticks]
    speeds = [(b - a) / 0.001 for a, b in pairwise(places)]
    assert 2.0 < max(speeds) <= 8.0
