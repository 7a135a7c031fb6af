"""Frames, identification, outputs, analog reports, heat; hostile input at both ends."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.oracles import wire
from tests.support.link_bench import HZ, START, Bench
from tests.support.raw_board import RawBoard

from passo import _core


def acknowledgement(sequence: int) -> bytes:
    return wire.frame(b"", sequence)


def test_frames_in_order_are_acknowledged_and_others_refused():
    board = RawBoard()
    nop = board.commands.encode("debug_nop", [])

    def answer(data: bytes) -> bytes:
        board.device.feed(data, board.now)
        return board.device.poll(board.now)

    assert answer(wire.frame(nop, 0)) == acknowledgement(1)
    assert answer(wire.frame(nop, 1) + wire.frame(nop, 2)) == acknowledgement(2) + acknowledgement(
        3
    )
    assert answer(wire.frame(nop, 2)) == acknowledgement(3)
    assert answer(wire.frame(nop, 9)) == acknowledgement(3)
    spoilt = bytearray(wire.frame(nop, 3))
    spoilt[-2] ^= 1
    assert answer(bytes(spoilt)) == acknowledgement(3)
    assert answer(b"\x7e\x7e" + wire.frame(nop, 3)) == acknowledgement(4)
    assert (board.device.frames, board.device.naks) == (4, 3)


def test_the_number_wraps_after_sixteen_frames():
    board = RawBoard()
    for i in range(40):
        assert board.tell("debug_nop") == []
        assert board.device.frames == i + 1


def test_identify_gives_the_dictionary_piece_by_piece():
    board = RawBoard()
    data = b""
    while part := board.tell(f"identify offset={len(data)} count=40")[0][1]["data"]:
        assert len(part) <= 40
        data += part
    assert data == board.compressed
    assert board.tell("identify offset=4294967295 count=255")[0][1]["data"] == b""


def test_uptime_has_64_bits():
    board = RawBoard()
    assert board.tell("get_uptime") == [("uptime", {"high": 0, "clock": START})]
    board.wait(HZ + 5)
    assert board.tell("get_uptime") == [("uptime", {"high": 1, "clock": 5})]
    assert board.tell("get_clock") == [("clock", {"clock": 5})]


def test_outputs_change_at_their_clock_in_order():
    board = RawBoard()
    board.configure()
    start = board.now
    for name in ("fan", "light"):
        board.simulated.trace_output(name)
    for at, value in ((500, 1), (700, 0), (900, 1)):
        board.tell(f"queue_digital_out oid=2 clock={board.clock(at)} on_ticks={value}")
    board.tell(f"queue_pwm_out oid=3 clock={board.clock(600)} value=77")
    board.tell(f"queue_pwm_out oid=3 clock={board.clock(601)} value=9999")
    board.wait(699)
    assert board.simulated.take_changes("fan") == [(start + 500, 1)]
    board.wait(1000)
    assert board.simulated.take_changes("fan") == [(start + 700, 0), (start + 900, 1)]
    assert board.simulated.take_changes("light") == [(start + 600, 77), (start + 601, 255)]


def test_analog_reports_have_period_and_sum_of_samples():
    board = RawBoard()
    board.configure()
    first = board.now + 1000
    board.tell(f"query_analog_in oid=4 clock={board.clock(1000)} sample_ticks=100 sample_count=8"
               " rest_ticks=40000 bytes_per_report=2 min_value=0 max_value=9000"
               " range_check_count=4")  # fmt: skip
    board.wait(1699)
    said = board.wait(1) + board.wait(40_000)
    sums = [int.from_bytes(v["values"], "little") for _, v in said]
    assert sums == [8 * round(0.95 * 1023)] * 2
    assert [v["next_clock"] for _, v in said] == [
        first + 40_000 & 0xFFFFFFFF,
        first + 80_000 & 0xFFFFFFFF,
    ]


def test_analog_reports_continue_after_a_shutdown():
    board = RawBoard()
    board.configure()
    board.tell(f"query_analog_in oid=4 clock={board.clock(1000)} sample_ticks=100 sample_count=1"
               " rest_ticks=40000 bytes_per_report=4 min_value=0 max_value=10"
               " range_check_count=3")  # fmt: skip
    board.wait(80_999)
    assert board.device.fault == ""
    board.wait(1)
    assert board.device.fault == "ADC out of range"
    said = board.wait(400_000)
    assert [len(v["values"]) for name, v in said if name == "analog_in_state"] == [4] * 5


def test_heat_does_not_depend_on_when_it_is_read():
    def heat(looks: int) -> float:
        bench = Bench()
        bench.connection.set_target("hotend", 150.0)
        for _ in range(looks):
            bench.run(60.0 / looks)
            bench.simulated.temperature("hotend")
        return bench.simulated.temperature("hotend")

    assert heat(1) == heat(60) == heat(600)


def test_full_power_warms_along_the_exponential():
    bench = Bench()
    bench.connection.set_target("hotend", 290.0)
    bench.run(1.0)
    begin = bench.simulated.temperature("hotend")
    bench.run(30.0)
    left = (325 - begin) * 2.718281828 ** (-30 / 100)
    assert bench.simulated.temperature("hotend") == pytest.approx(325 - left, abs=0.1)


@settings(max_examples=200, deadline=None)
@given(st.lists(st.binary(max_size=80), max_size=8))
def test_random_bytes_leave_the_board_alive(chunks):
    board = RawBoard()
    board.configure()
    before = board.device.frames
    for chunk in chunks:
        board.device.feed(chunk, board.now)
        board.wait(100)
    assert board.device.frames == before
    board.device.feed(b"\x7e" * 64, board.now)
    board.read()
    assert board.tell("get_clock") == [("clock", {"clock": board.clock(0)})]


@settings(max_examples=300, deadline=None)
@given(st.lists(st.binary(max_size=59), min_size=1, max_size=8))
def test_random_payloads_leave_the_board_alive(payloads):
    board = RawBoard()
    board.configure()
    for payload in payloads:
        board.feed(payload)
        board.wait(1000)
        if board.sequence % 16 == 0 and not board.device.stopped:
            break
    board.feed(board.commands.encode("reset", []))
    board.sequence = 0
    assert board.tell("get_config")[0][1]["is_config"] == 0


known = st.sampled_from([text.split()[0] for _, text in _core.board_commands()])
numbers = st.one_of(st.integers(0, 8), st.integers(0, 2**32 - 1))


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(known, st.lists(numbers, min_size=9, max_size=9)), max_size=12))
def test_random_commands_leave_the_board_alive(commands):
    board = RawBoard()
    board.configure()
    declared = {text.split()[0] for _, text in board.dictionary.commands}
    for name, values in commands:
        if name == "reset" or name not in declared:
            continue
        blobs = [blob for _, blob in board.commands.parameters(name)]
        given_values = [b"\x01" if blob else v for blob, v in zip(blobs, values, strict=False)]
        board.feed(board.commands.encode(name, given_values))
        board.wait(1000)
    assert board.tell("get_clock") == [("clock", {"clock": board.clock(0)})]


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.one_of(
            st.binary(max_size=80),
            st.builds(wire.frame, st.binary(max_size=59), st.integers(0, 15)),
        ),
        max_size=8,
    )
)
def test_random_bytes_leave_the_link_alive(chunks):
    link = _core.Link(16e6)
    link.set_dictionary(_core.board_commands(), _core.board_reports(), 192)
    link.follow_clock(0)
    for i, chunk in enumerate(chunks):
        link.poll(i * 1000)
        link.feed(chunk, i * 1000 + 500)
    out, wake = link.poll(10**9)
    assert wake > 10**9
    link.restart()
    link.send("debug_nop", [])
    out, _ = link.poll(2 * 10**9)
    frames = [f for f in _core.FrameScanner().feed(out) if f is not None]
    assert len(frames) == 1
