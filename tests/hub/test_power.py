"""Power groups: what heats, and which starts are admitted."""

from __future__ import annotations

from random import Random

import pytest

from passo.hub.power import Load, Start, admitted, heating, used_w
from passo.web.summary import Summary, SummaryHeater, SummaryJob


def summary(state="printing", celsius=210, target=210, mm=5.0, job=True) -> Summary:
    running = SummaryJob("/a.gcode", "run", 0.1, None, 60.0, 1, None, mm) if job else None
    heaters = (SummaryHeater("bed", 60, 60), SummaryHeater("hotend", celsius, target))
    return Summary("id", "a", "1", state, running, None, heaters)


@pytest.mark.parametrize(
    ("seen", "starting", "expected"),
    [
        (None, False, True),  # nothing is known
        (summary(), False, False),  # warm, and it prints
        (summary(), True, True),  # a start is on the way
        (summary(mm=0.0), False, True),  # all are warm between two waits of the program
        (summary(celsius=204), False, True),
        (summary(celsius=205), False, False),
        (summary(celsius=None), False, True),
        (summary("idle", 20, 0, job=False), False, False),
        (summary("idle", 20, 200, job=False), False, True),  # a user heats it
        (summary("halted", 20, 200), False, False),
        (summary("paused", 150, 210), False, True),
    ],
)
def test_printer_heats_until_it_is_warm_and_prints(seen, starting, expected):
    assert heating(seen, starting) is expected


def test_first_start_that_must_wait_keeps_later_ones_back():
    starts = [Start("a", "fuse", 500.0), Start("b", "fuse", 900.0), Start("c", "fuse", 100.0)]
    starts.append(Start("d", "", 5000.0))
    assert admitted(starts, [], {"fuse": 1000.0}) == ["a", "d"]
    assert admitted(starts, [Load("fuse", 500.0, True)], {"fuse": 1000.0}) == ["a", "d"]
    assert admitted(starts, [Load("fuse", 501.0, True)], {"fuse": 1000.0}) == ["d"]
    other = [Load("other", 501.0, True)]
    assert admitted(starts, other, {"fuse": 1500.0}) == ["a", "b", "c", "d"]


def test_sum_never_exceeds_the_limit():
    full = 0
    for seed in range(2000):
        chance = Random(seed)
        limits = {"x": chance.uniform(200, 2000), "y": chance.uniform(200, 2000)}
        loads = [
            Load(chance.choice(("x", "y", "")), chance.uniform(0, 300), chance.random() < 0.5)
            for _ in range(chance.randint(0, 8))
        ]
        starts = [
            Start(f"r{i}", chance.choice(("x", "y", "")), chance.uniform(0, 400))
            for i in range(chance.randint(0, 8))
        ]
        runs = admitted(starts, loads, limits)
        begun = [Load(s.group, s.heating_w, True) for s in starts if s.run in runs]
        before, after = used_w(loads), used_w([*loads, *begun])
        for group, limit in limits.items():
            assert after.get(group, 0.0) <= max(limit, before.get(group, 0.0))
            waits = [s for s in starts if s.group == group and s.run not in runs]
            if waits:  # the first one that waits does not fit
                full += 1
                earlier = starts[: starts.index(waits[0])]
                sum_w = before.get(group, 0.0) + sum(
                    s.heating_w for s in earlier if s.group == group
                )
                assert sum_w + waits[0].heating_w > limit
        assert {s.run for s in starts if not s.group} <= set(runs)
    assert full > 400
