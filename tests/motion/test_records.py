"""Records of outputs: one value a place, and a part of what the board takes."""

from math import inf

import pytest
from tests.motion.machines import cartesian, nonlinear
from tests.oracles import motion as oracle

from passo._core import Motion


def pins(motion):
    """Output, clock and value of each pin message."""
    return [(m[1], m[2], m[4]) for m in motion.take_messages() if m[0] == "pin"]


@pytest.mark.parametrize("moves", [True, False])
def test_of_many_values_at_one_place_the_last_is_sent(moves):
    """A board has a slot for each until its clock: hundreds would leave no room."""
    motion = Motion(cartesian())
    motion.push([5.0, 0.0, 0.0, 0.0], 10.0)
    if not moves:
        motion.flush()
    for i in range(1000):
        motion.record(i % 2, i)
    if moves:
        motion.push([10.0, 0.0, 0.0, 0.0], 10.0)
    motion.flush()
    (first, clock, a), (second, same, b) = pins(motion)
    assert clock == same
    assert {first: a, second: b} == {0: 998, 1: 999}


def test_values_at_different_places_are_all_sent():
    motion = Motion(cartesian())
    for i in range(20):
        motion.record(0, i % 2)
        motion.push([0.5 * (i + 1), 0.0, 0.0, 0.0], 10.0)
    motion.flush()
    found = pins(motion)
    assert [value for _, _, value in found] == [0, 1] * 10
    assert len({clock for _, clock, _ in found}) == 20


def test_motion_from_a_stop_comes_after_the_record_there():
    """Commands are due 20 ms before their first step, but messages of a board in order."""
    motion = Motion(cartesian())
    for i in range(3):
        motion.push([5.0 * (i + 1), 0.0, 0.0, 0.0], 10.0)
        motion.record(0, i)
        motion.flush()
    messages = motion.take_messages()
    clocks = [m[2] for m in messages]
    assert clocks == sorted(clocks)
    stops = [round(m.end_ticks) for m in motion.take_moves()]
    assert oracle.pins(messages) == [(stop, i) for i, stop in enumerate(stops)]


def test_records_are_a_part_of_what_the_link_takes():
    """At 500 commands a second 2000 values take 4 s at least, the moves by themselves 2 s."""
    limits = {"steps_s": inf, "commands_s": 500.0, "burst": 10.0, "bound": "link", "commits_s": 0.0}
    limits["boards"] = [0]
    seconds = []
    for records in (0, 1):
        motion = Motion(cartesian() | {"budgets": [limits]})
        for i in range(2000):
            for _ in range(records):
                motion.record(0, i % 256)
            motion.push([0.1 * (i + 1), 0.0, 0.0, 0.0], 100.0)
        motion.flush()
        seconds.append(motion.clock / oracle.HZ)
    assert seconds[0] < 2.1
    assert 3.9 <= seconds[1] < 5.0


def test_event_before_split_move_is_done_once():
    spec, _ = nonlinear("delta")
    motion = Motion(spec, True)
    motion.set_position([-40, 0, 50, 0])
    motion.push([-40, 0, 49, 0], 300.0)
    motion.record(2, 7)
    motion.push([40, 10, 49, 0], 300.0)
    motion.record(2, 8)
    motion.flush()
    moves = motion.take_moves()
    (begin,) = (m.start_ticks for m in moves if m.start_mm[:3] == (-40, 0, 49))
    assert moves[-1].start_ticks > begin
    pins = [(round(begin), 7), (round(motion.clock), 8)]
    assert oracle.pins(motion.take_messages()) == pins
