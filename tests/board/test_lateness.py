"""How long before its time a frame is at the board, and who is to blame when that is little."""

from __future__ import annotations

from tests.support.link_bench import HZ, MS, Bench, Planner, description

from passo._core import LATE_S, Cause, Slack

from .test_link import Wire, start

LATE = round(LATE_S * HZ)


def long_plan(seconds: float) -> Planner:
    """Both motors step evenly; a command takes 12.5 ms."""
    plan = Planner()
    for _ in range(round(seconds * 80)):
        for target in (0, 1):
            if target not in plan.clocks:
                plan.steps(target, True, HZ // 2, 1)
            plan.steps(target, True, MS, 12)
    return plan


def running(bench: Bench, plan: Planner, delay: int = 0) -> tuple[Wire, int]:
    """A job that has run for a second without trouble."""
    wire = Wire(bench, delay)
    base = start(bench, plan)
    wire.run(base + HZ)
    least = bench.link.take_slack()
    assert 120 * MS <= least.slack <= 150 * MS
    assert bench.link.longest_stall == 0
    return wire, base


def late(bench: Bench) -> dict[Cause, int]:
    return {cause: n for cause, n in bench.link.late_frames.items() if n}


def assert_blamed(bench: Bench, cause: Cause, least: int, most: int) -> Slack:
    slack = bench.link.take_slack()
    assert slack.cause == cause
    assert least <= slack.slack <= most
    assert late(bench).keys() == {cause}
    assert bench.link.min_slack.slack == slack.slack
    assert not bench.link.take_slack().known
    return slack


def test_no_frame_is_late_on_a_good_link():
    bench = Bench()
    wire, base = running(bench, long_plan(3.0), delay=MS)
    wire.run(base + 3 * HZ)
    least = bench.link.min_slack
    assert 122 * MS <= least.slack <= 124 * MS  # the way there and that of the answer
    assert late(bench) == {}


def test_late_frames_are_explained_by_a_stalled_program():
    bench = Bench()
    wire, base = running(bench, long_plan(3.0), delay=MS)
    wire.now += 100 * MS
    bench.device.poll(wire.now)
    wire.run(base + 2 * HZ)
    slack = assert_blamed(bench, Cause.STALL, 20 * MS, 50 * MS)
    assert 75 * MS <= slack.held <= 100 * MS
    assert base + HZ < slack.clock < base + HZ + 300 * MS
    assert 75 * MS <= bench.link.longest_stall <= 100 * MS


def test_answer_delayed_by_a_stall_is_not_a_slow_link():
    bench = Bench()
    wire, _ = running(bench, long_plan(3.0), delay=MS)
    sent = len(wire.sent)
    while len(wire.sent) == sent:
        wire.run(wire.now)
    wire.now += 90 * MS
    bench.device.poll(wire.now)
    bench.link.feed(b"", wire.now)
    wire.run(wire.now + 5 * MS)
    slack = bench.link.take_slack()
    assert slack.cause == Cause.STALL
    assert 60 * MS <= slack.slack <= 70 * MS
    assert late(bench) == {}


def test_late_frames_are_explained_by_late_planning():
    bench = Bench()
    plan = long_plan(1.4)
    wire, base = running(bench, plan)
    end = base + plan.clocks[0][-1]
    wire.run(end - 120 * MS)
    assert late(bench) == {}
    wire.now = end - 40 * MS
    bench.link.poll(wire.now)
    plan.steps(0, True, MS, 12)
    wire.run(end)
    slack = assert_blamed(bench, Cause.PLAN, 40 * MS, 41 * MS)
    assert slack.clock == end + MS
    assert 84 * MS <= slack.held <= 85 * MS


def test_late_frames_are_explained_by_lost_bytes():
    bench = Bench()
    wire, base = running(bench, long_plan(3.0), delay=MS)
    wire.spoil = lambda data: data if wire.now > base + HZ + 150 * MS else b""
    wire.run(base + 2 * HZ)
    slack = assert_blamed(bench, Cause.RETRANSMITS, -150 * MS, 40 * MS)
    assert slack.held > 80 * MS
    assert bench.link.retransmitted_bytes > 0


def test_late_frames_are_explained_by_a_slow_link():
    bench = Bench()
    plan = long_plan(1.5)
    for _ in range(800):
        for target in (0, 1):
            plan.steps(target, True, MS, 2)
    wire = Wire(bench)
    free = wire.now

    def narrow(data: bytes) -> bytes:
        """Bytes of both ways go one behind the other, 8 in a millisecond."""
        nonlocal free
        free = max(free, wire.now) + len(data) * MS // 8
        wire.delay = free - wire.now
        return data

    wire.spoil = narrow
    base = start(bench, plan)
    wire.run(base + HZ)
    assert bench.link.take_slack().slack > 100 * MS
    before = bench.link.retransmitted_bytes
    wire.run(base + 3 * HZ)
    slack = assert_blamed(bench, Cause.BYTES, -2 * HZ, 40 * MS)
    assert slack.held > 85 * MS
    assert bench.link.retransmitted_bytes == before


def test_late_frames_are_explained_by_a_full_move_queue():
    bench = Bench(description(move_count=20))
    plan = Planner()
    plan.steps(0, True, HZ // 2, 1)
    for _ in range(2000):
        plan.steps(0, True, MS // 2, 2)
    wire = Wire(bench)
    base = start(bench, plan)
    wire.run(base + HZ)
    slack = bench.link.take_slack()
    assert slack.cause == Cause.SLOTS
    assert 10 * MS <= slack.slack <= 20 * MS
    assert late(bench).keys() == {Cause.SLOTS}
