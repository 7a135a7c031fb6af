"""Pulses, direction edges and stops, against step times in plain Python."""

from __future__ import annotations

from array import array

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.oracles.wire import step_clocks
from tests.support.raw_board import RawBoard

PULSE = 32  # step_pulse_ticks of RawBoard.configure()

moves = st.lists(
    st.tuples(
        st.sampled_from([0, 1]),
        st.booleans(),
        st.integers(100, 40_000),
        st.integers(1, 40),
        st.integers(-3, 3),
    ),
    min_size=1,
    max_size=12,
).filter(lambda rows: all(interval + add * count > PULSE for _, _, interval, count, add in rows))


def pin(board: RawBoard, name: str) -> int:
    return board.dictionary.enumerations["pin"][name]


def queue(board: RawBoard, rows) -> tuple[dict[int, list[int]], dict[int, list[int]]]:
    """Queues moves; returns clocks and directions by motor."""
    clocks: dict[int, list[int]] = {0: [], 1: []}
    signs: dict[int, list[int]] = {0: [], 1: []}
    for motor, forward, interval, count, add in rows:
        board.tell(f"set_next_step_dir oid={motor} dir={int(forward)}")
        board.tell(f"queue_step oid={motor} interval={interval} count={count} add={add}")
        last = clocks[motor][-1] if clocks[motor] else board.now
        clocks[motor] += step_clocks(last, interval, count, add)
        signs[motor] += [1 if forward else -1] * count
    assert board.device.fault == ""
    return clocks, signs


@settings(max_examples=300)
@given(moves)
def test_pulse_length_and_direction_changes(rows):
    board = RawBoard()
    board.configure()
    names = {0: ("PF0", "PF1"), 1: ("PF6", "PF7")}
    for name in (n for pair in names.values() for n in pair):
        board.device.trace_edges(pin(board, name))
    start = board.now
    clocks, signs = queue(board, rows)
    board.wait(max(map(max, filter(None, clocks.values()))) - board.now + PULSE)
    for motor, (step, direction) in names.items():
        pulses = [edge for c in clocks[motor] for edge in ((c, 1), (c + PULSE, 0))]
        assert board.device.take_edges(pin(board, step)) == pulses
        changes = []
        level, before = -1, None
        for clock, sign in zip(clocks[motor], signs[motor], strict=True):
            if sign != level:
                # At once after the last pulse; the first move's is set when it is queued.
                changes.append((start if before is None else before + PULSE,
                                int(sign > 0)))  # fmt: skip
                level = sign
            before = clock
        assert board.device.take_edges(pin(board, direction)) == changes


@pytest.mark.parametrize("pulses", [(32, 100), (100, 32)])
def test_simultaneous_steps_take_longest_pulse(pulses):
    board = RawBoard()
    board.tell("allocate_oids count=2")
    for oid, (ticks, wires) in enumerate(zip(pulses, ("PF0 PF1", "PF6 PF7"), strict=True)):
        step, direction = wires.split()
        board.tell(
            f"config_stepper oid={oid} step_pin={step} dir_pin={direction} invert_step=0"
            f" step_pulse_ticks={ticks}"
        )
    board.tell("finalize_config crc=1")
    for name in ("PF0", "PF6"):
        board.device.trace_edges(pin(board, name))
    start = board.now
    for oid in (0, 1):
        board.tell(f"reset_step_clock oid={oid} clock={start & 0xFFFFFFFF}")
        board.tell(f"queue_step oid={oid} interval=5000 count=1 add=0")
    board.wait(10_000)
    for name in ("PF0", "PF6"):
        edges = board.device.take_edges(pin(board, name))
        assert edges == [(start + 5000, 1), (start + 5100, 0)]


@settings(max_examples=300)
@given(moves, st.data())
def test_a_stop_leaves_the_steps_done_so_far(rows, data):
    board = RawBoard()
    board.configure()
    clocks, signs = queue(board, rows)
    end = max(map(max, filter(None, clocks.values())))
    at = data.draw(st.integers(board.now, end))
    board.wait(at - board.now)
    how = data.draw(st.sampled_from(["trsync_trigger", "emergency_stop"]))
    if how == "trsync_trigger":
        board.tell("stepper_stop_on_trigger oid=0 trsync_oid=6")
        board.tell("stepper_stop_on_trigger oid=1 trsync_oid=6")
        board.tell("trsync_start oid=6 report_clock=0 report_ticks=0 expire_reason=4")
        # Starting forgets the group, as a host expects: it names the motors behind it.
        board.tell("stepper_stop_on_trigger oid=0 trsync_oid=6")
        board.tell("stepper_stop_on_trigger oid=1 trsync_oid=6")
        board.tell("trsync_trigger oid=6 reason=2")
    else:
        board.tell("emergency_stop")
        board.tell("clear_shutdown")
    board.wait(end)
    board.tell("queue_step oid=0 interval=5000 count=9 add=0")  # ignored until the clock is set
    board.wait(100_000)
    for motor, name in ((0, "x"), (1, "y")):
        done = sum(s for c, s in zip(clocks[motor], signs[motor], strict=True) if c <= at)
        assert board.tell(f"stepper_get_position oid={motor}")[0][1]["pos"] == done
        assert board.simulated.net_steps(name) == (done if motor == 0 else -done)
    assert board.device.fault == ""
    board.tell(f"reset_step_clock oid=0 clock={board.clock(0)}")
    board.simulated.trace_steps("x", 0, 2**62)
    start = board.now
    board.tell("queue_step oid=0 interval=5000 count=9 add=7")
    board.wait(50_000)
    assert list(array("q", board.simulated.take_steps("x", 0, 2**62)[0])) == step_clocks(
        start, 5000, 9, 7
    )


@given(st.integers(0, 2**32 - 1), st.integers(1, 65_535), st.integers(-(2**15), 2**15 - 1))
@example(2**31 - 10, 5, 2)
@example(2**31 - 10, 6, 2)
@example(10, 6, -2)
@example(10, 7, -2)
def test_intervals_that_leave_the_clock_are_refused(interval, count, add):
    board = RawBoard()
    board.configure()
    board.tell(f"queue_step oid=0 interval={interval} count={count} add={add}")
    last = interval + add * (count - 1)
    wrong = interval >= 2**31 or not 0 <= last < 2**31 or (interval == 0 and count > 1)
    assert board.device.fault == ("Stepper too far in past" if wrong else "")
