"""Steps as executed, homing, trigger groups."""

from __future__ import annotations

from array import array

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.oracles.wire import step_clocks
from tests.support.raw_board import RawBoard

command = st.tuples(
    st.booleans(), st.integers(2000, 70_000), st.integers(1, 60), st.integers(-30, 30)
)


@given(st.lists(command, min_size=1, max_size=8), st.data())
def test_executed_steps_equal_the_oracles(commands, data):
    board = RawBoard()
    board.configure()
    board.simulated.trace_steps("x", 0, 2**62)
    start = board.now
    clocks: list[int] = []
    directions: list[int] = []
    for forward, interval, count, add in commands:
        board.tell(f"set_next_step_dir oid=0 dir={int(forward)}")
        board.tell(f"queue_step oid=0 interval={interval} count={count} add={add}")
        clocks += step_clocks(clocks[-1] if clocks else start, interval, count, add)
        directions += [1 if forward else -1] * count
    # Looking in at any time shows the steps done so far.
    for look in sorted(data.draw(st.lists(st.integers(start, clocks[-1]), max_size=4))):
        board.wait(look - board.now)
        done = sum(c <= look for c in clocks)
        assert board.simulated.net_steps("x") == sum(directions[:done])
    board.wait(clocks[-1] - board.now)
    low, high = sorted(data.draw(st.tuples(*[st.integers(start, clocks[-1] + 1)] * 2)))
    ticks, signs = board.simulated.take_steps("x", low, high)
    kept = [(c, d) for c, d in zip(clocks, directions, strict=True) if low <= c < high]
    assert list(zip(array("q", ticks), array("b", signs), strict=True)) == kept
    assert board.simulated.steps("x") == len(clocks)


def test_only_the_asked_range_is_kept():
    board = RawBoard()
    board.configure()
    start = board.now
    board.simulated.trace_steps("x", start + 10_500, start + 20_500)
    for _ in range(4):
        board.tell("queue_step oid=0 interval=1000 count=10 add=0")
    board.wait(50_000)
    ticks, _ = board.simulated.take_steps("x", start + 10_500, start + 20_500)
    assert [t - start for t in array("q", ticks)] == list(range(11_000, 21_000, 1000))
    assert board.simulated.take_steps("x", 0, 2**62) == (b"", b"")


def test_position_is_reported_with_its_sign():
    board = RawBoard()
    board.configure()
    board.tell("queue_step oid=0 interval=1000 count=7 add=0")
    board.wait(5000)
    assert board.tell("stepper_get_position oid=0") == [("stepper_position", {"oid": 0, "pos": -5})]


def home(board: RawBoard, timeout: int) -> None:
    """x starts at 10 mm and runs down at 1000 ticks a step, 80 steps a millimetre."""
    board.tell(f"trsync_start oid=6 report_clock={board.clock(50_000)} report_ticks=50000"
               " expire_reason=4")  # fmt: skip
    board.tell("stepper_stop_on_trigger oid=0 trsync_oid=6")
    board.tell(f"trsync_set_timeout oid=6 clock={board.clock(timeout)}")
    board.tell(f"endstop_home oid=5 clock={board.clock(0)} sample_ticks=240 sample_count=4"
               " rest_ticks=2500 pin_value=1 trsync_oid=6 trigger_reason=1")  # fmt: skip
    board.tell("queue_step oid=0 interval=1000 count=2000 add=0")
    board.tell("queue_step oid=0 interval=1000 count=2000 add=0")


def test_homing_stops_at_the_switch():
    board = RawBoard()
    board.configure()
    start = board.now
    assert board.tell("endstop_query_state oid=5")[0][1]["pin_value"] == 0
    home(board, timeout=2_000_000)
    said = board.wait(1_500_000)
    states = [v for name, v in said if name == "trsync_state"]
    # The switch closes at step 800; the next look is at 800 000, the fourth sample 720 ticks later.
    hit = start + 800_000 + 3 * 240
    triggered = next(v for v in states if not v["can_trigger"])
    assert triggered == {
        "oid": 6, "can_trigger": 0, "trigger_reason": 1, "clock": hit & 0xFFFFFFFF
    }  # fmt: skip
    assert [v["can_trigger"] for v in states[:15]] == [1] * 15
    assert board.simulated.steps("x") == 800
    assert board.simulated.position("x") == 0.0
    state = board.tell("endstop_query_state oid=5")[0][1]
    assert state["homing"] == 0
    assert state["pin_value"] == 1
    assert state["next_clock"] == start + 800_000 + 2500 & 0xFFFFFFFF
    # Until its clock is set anew the motor ignores steps.
    board.tell("queue_step oid=0 interval=1000000 count=1 add=0")
    board.wait(2_000_000)
    assert board.simulated.steps("x") == 800
    assert board.device.fault == ""


def test_samples_come_at_their_times_after_a_bounce_too():
    board = RawBoard()
    board.configure()
    start = board.now
    home(board, timeout=2_000_000)
    board.wait(2499)
    board.simulated.force_switch("x", True)
    board.wait(1 + 239)
    board.simulated.force_switch("x", False)
    board.wait(100)
    state = board.tell("endstop_query_state oid=5")[0][1]
    assert (state["homing"], state["next_clock"]) == (1, start + 5000 & 0xFFFFFFFF)
    board.wait(100_000)
    assert board.simulated.steps("x") == 102


def test_a_lost_host_ends_homing():
    board = RawBoard()
    board.configure()
    home(board, timeout=100_500)
    said = board.wait(500_000)
    ended = [v for name, v in said if name == "trsync_state" and not v["can_trigger"]]
    assert ended[0]["trigger_reason"] == 4
    assert board.simulated.steps("x") == 100


def test_the_timeout_can_be_put_off():
    board = RawBoard()
    board.configure()
    home(board, timeout=100_500)
    for _ in range(5):
        board.wait(80_000)
        board.tell(f"trsync_set_timeout oid=6 clock={board.clock(100_500)}")
    assert board.simulated.steps("x") == 400


def test_timeout_extended_after_its_end_has_no_effect():
    """Word of the end and this cross on the wire."""
    board = RawBoard()
    board.configure()
    home(board, timeout=100_500)
    board.wait(500_000)
    assert board.tell(f"trsync_set_timeout oid=6 clock={board.clock(-1000)}") == []
    assert board.device.fault == ""


def test_the_host_can_trigger_and_ends_the_reports():
    board = RawBoard()
    board.configure()
    home(board, timeout=2_000_000)
    board.wait(10_000)
    said = board.tell("trsync_trigger oid=6 reason=2")
    assert said == [
        ("trsync_state",
         {"oid": 6, "can_trigger": 0, "trigger_reason": 2, "clock": board.clock(0)})
    ]  # fmt: skip
    assert board.wait(1_000_000) == []
    assert board.simulated.steps("x") == 10
    again = board.tell("trsync_trigger oid=6 reason=3")
    assert again[0][1]["trigger_reason"] == 2


@pytest.mark.parametrize("wanted", [0, 1])
def test_an_endstop_that_is_disarmed_never_triggers(wanted):
    board = RawBoard()
    board.configure()
    home(board, timeout=4_000_000)
    board.tell(f"endstop_home oid=5 clock={board.clock(0)} sample_ticks=0 sample_count=0"
               f" rest_ticks=0 pin_value={wanted} trsync_oid=0 trigger_reason=0")  # fmt: skip
    board.wait(1_500_000)
    assert board.simulated.steps("x") == 1500
