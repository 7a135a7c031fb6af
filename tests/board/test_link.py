"""The link over a bad wire: lost, spoilt, doubled and swapped bytes; its timing; its promises."""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.link_bench import HZ, MS, PLANT, Bench, Planner, description, executed

from passo import _core
from passo.board.dictionary import decode
from passo.board.start_up import add_parts
from passo.simulator import SimulatedBoard

Noise = Callable[[bytes, random.Random], bytes]


def drop(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data))
    return data[:at] + data[at + rng.randint(1, 3) :]


def flip(data: bytes, rng: random.Random) -> bytes:
    spoilt = bytearray(data)
    spoilt[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(spoilt)


def double(data: bytes, rng: random.Random) -> bytes:
    return data + data


def swap(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data))
    return data[at:] + data[:at]


def insert(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data))
    return data[:at] + bytes(rng.randrange(256) for _ in range(4)) + data[at:]


NOISES: list[Noise] = [drop, flip, double, swap, insert]


class Wire:
    """Carries bytes between a bench's link and its board in virtual time, one way trip of `delay`
    ticks, and `byte` for each byte; `spoil` is asked for each delivery, `spoil_orders` and
    `spoil_answers` for those of one way. The board's clock may run at another rate."""

    def __init__(self, bench: Bench, delay: int = 0, rate: float = 1.0, byte: int = 0) -> None:
        self.bench = bench
        self.start = self.now = bench.connection.now
        self.delay = delay
        self.rate = rate
        self.byte = byte
        self.line_free = {True: 0, False: 0}  # when the line to the board is, or that to the host
        self.flying: list[tuple[int, bool, bytes]] = []
        self.sent: list[tuple[int, bytes]] = []
        self.spoil: Callable[[bytes], bytes] = lambda data: data
        self.spoil_orders: Callable[[bytes], bytes] = lambda data: data
        self.spoil_answers: Callable[[bytes], bytes] = lambda data: data

    def board_time(self, host: int) -> int:
        return self.start + int((host - self.start) * self.rate)

    def host_time(self, board: int) -> int:
        if board > 2**62:
            return board
        return self.start + int((board - self.start) / self.rate) + 1

    def run(self, until: int) -> None:
        link, device = self.bench.link, self.bench.device
        while self.now <= until:
            arrived = [f for f in self.flying if f[0] <= self.now]
            self.flying = [f for f in self.flying if f[0] > self.now]
            for _, down, data in arrived:
                if down:
                    device.feed(data, self.board_time(self.now))
                else:
                    link.feed(data, self.now)
            up = device.poll(self.board_time(self.now))
            down, wake = link.poll(self.now)
            for to_board, data in ((True, down), (False, up)):
                if data:
                    if to_board:
                        self.sent.append((self.now, data))
                    data = (self.spoil_orders if to_board else self.spoil_answers)(data)
                    data = self.spoil(data)
                    pieces = (
                        [data] if self.byte == 0 else [data[i : i + 1] for i in range(len(data))]
                    )
                    for piece in pieces:
                        free = max(self.now, self.line_free[to_board]) + self.byte
                        self.line_free[to_board] = free
                        self.flying.append((free + self.delay, to_board, piece))
            times = [wake, self.host_time(device.next_deadline), *(f[0] for f in self.flying)]
            self.now = max(min(times), self.now if self.flying or down else self.now + 1)


def busy_plan(seed: int, commands: int) -> Planner:
    rng = random.Random(seed)
    plan = Planner()
    pending = [(0, 0), (0, 1)]
    for _ in range(commands):
        # The motor that is behind comes next, so that messages are in the order of their clocks.
        target = min(pending)[1]
        interval, count = rng.randint(900, 4000), rng.randint(1, 40)
        if target in plan.clocks:
            plan.steps(target, rng.random() < 0.5, interval, count, rng.randint(-9, 9))
        else:
            plan.steps(target, True, HZ // 10, 1)
        pending[target] = (plan.clocks[target][-1], target)
    return plan


def start(bench: Bench, plan: Planner) -> int:
    for name in ("x", "y"):
        bench.simulated.trace_steps(name, 0, 2**62)
    return bench.connection.start_job(plan.queue)


def assert_executed(bench: Bench, plan: Planner, base: int) -> None:
    for target, name in enumerate(("x", "y")):
        expected = plan.clocks.get(target, []), plan.directions.get(target, [])
        assert executed(bench, name, base) == expected


@pytest.mark.parametrize("noise", NOISES, ids=lambda n: n.__name__)
@pytest.mark.parametrize("way", ["to the board", "to the host", "both"])
def test_job_arrives_complete_over_a_noisy_link(noise, way):
    bench = Bench()
    plan = busy_plan(7, 4000)
    wire = Wire(bench, delay=MS // 4)
    rng = random.Random(f"{noise.__name__} {way}")
    spoilt = 0

    def spoil(data: bytes) -> bytes:
        nonlocal spoilt
        to_board = len(wire.sent) > 0 and wire.sent[-1][1] is data
        if rng.random() > 0.05 or way == ("to the host" if to_board else "to the board"):
            return data
        spoilt += 1
        return noise(data, rng)

    wire.spoil = spoil
    base = start(bench, plan)
    wire.run(base + plan.clocks[0][-1] + HZ)
    assert bench.device.fault == ""
    assert spoilt >= 10
    assert_executed(bench, plan, base)
    if way != "to the host" and noise is not double:
        assert bench.link.retransmitted_bytes > 0


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from(NOISES), st.floats(0.0, 0.08))
def test_job_arrives_complete_with_any_noise(seed, noise, share):
    bench = Bench()
    plan = busy_plan(seed, 40)
    wire = Wire(bench, delay=MS // 2)
    rng = random.Random(seed)
    wire.spoil = lambda data: noise(data, rng) if rng.random() < share else data
    base = start(bench, plan)
    wire.run(base + max(plan.clocks[0][-1], plan.clocks[1][-1]) + HZ)
    # So much noise may make a command late; then the board says so and nothing wrong is executed.
    if bench.device.fault:
        assert bench.device.fault in ("Timer too close", "Stepper too far in past")
    else:
        assert_executed(bench, plan, base)


def test_messages_leave_within_their_horizon():
    bench = Bench()
    plan = busy_plan(1, 300)
    base = start(bench, plan)
    wire = Wire(bench)
    wire.run(base + plan.clocks[0][-1] + HZ)
    done = {0: 0, 1: 0}
    commands = 0
    early, late = 0, -HZ
    for at, data in wire.sent:
        for line in decode(data, bench.connection.dictionary):
            if not line.startswith("queue_step"):
                continue
            values = dict(w.split("=") for w in line.split()[1:])
            target, count = int(values["oid"]), int(values["count"])
            before = plan.clocks[target][done[target] - 1] if done[target] else None
            first = plan.clocks[target][done[target]]
            due = max(before if before is not None else 0, first - 20 * MS)
            early = max(early, base + due - at)
            late = max(late, at - (base + due))
            done[target] += count
            commands += 1
    assert commands == 300
    assert 149 * MS < early <= 150 * MS
    assert late <= -125 * MS


def test_frames_are_filled():
    bench = Bench()
    plan = busy_plan(2, 400)
    base = start(bench, plan)
    bytes_before, frames_before = bench.link.wire_bytes, bench.link.frames
    bench.connection.run(base + plan.clocks[0][-1])
    frames = bench.link.frames - frames_before
    assert (bench.link.wire_bytes - bytes_before) / frames > 50


def test_move_slots_of_a_small_board_are_never_exceeded():
    bench = Bench(description(move_count=24))
    plan = Planner()
    pending = [(0, 0), (0, 1)]
    for _ in range(600):
        target = min(pending)[1]
        plan.steps(target, True, 8_000, 10)
        pending[target] = (plan.clocks[target][-1], target)
    base = start(bench, plan)
    bench.run(4.0)
    assert_executed(bench, plan, base)
    assert 10 <= bench.device.peak_slots <= 24


def test_clock_estimate_follows_a_fast_board():
    bench = Bench()
    plan = Planner()
    plan.steps(0, True, 20 * HZ, 1)
    plan.steps(0, True, 50_000, 1000)
    wire = Wire(bench, delay=MS // 3, rate=1 + 200e-6)
    d = bench.connection.dictionary
    bench.link = bench.connection.link = _core.Link(HZ)
    bench.link.set_dictionary(d.commands, d.reports, d.number("RECEIVE_WINDOW"))
    add_parts(bench.connection, bench.connection.move_count)
    bench.link.follow_clock(wire.now)
    wire.run(wire.now + HZ // 10)
    base = start(bench, plan)
    wire.run(base + 30 * HZ)
    assert bench.link.clock_rate == pytest.approx(1 + 200e-6, abs=2e-6)
    estimate = bench.link.clock_at(wire.now)
    assert abs(estimate - wire.board_time(wire.now)) < MS // 20
    assert abs(bench.link.host_at(estimate) - wire.now) <= 2
    assert_executed(bench, plan, base)


class Warming(Wire):
    """Of a board whose clock runs faster and faster, by `rate` in each tick of host time."""

    def board_time(self, host: int) -> int:
        passed = host - self.start
        return host + int(self.rate / 2 * passed**2)

    def host_time(self, board: int) -> int:
        passed = board - self.start
        return board if board > 2**62 else board - int(self.rate / 2 * passed**2) + 1


class Stopped(Wire):
    """Of a board whose clock stands still for 10 ms after half a minute."""

    @property
    def _lost(self) -> int:
        return 10 * MS if self.now > self.start + 30 * HZ else 0

    def board_time(self, host: int) -> int:
        return host - self._lost

    def host_time(self, board: int) -> int:
        return board if board > 2**62 else board + self._lost


class Asleep(Wire):
    """Of a board whose host sleeps after half a minute, and its clock with it, for `rate` s."""

    @property
    def _slept(self) -> int:
        return int(self.rate * HZ) if self.now > self.start + 30 * HZ else 0

    def board_time(self, host: int) -> int:
        return host + self._slept

    def host_time(self, board: int) -> int:
        return board if board > 2**62 else board - self._slept


@pytest.mark.parametrize("slept_s", [10, 130, 150, 260, 280, 5000])
def test_board_clock_does_not_run_back_after_host_sleep(slept_s):
    """By as much as 32 bits tell."""
    bench = Bench()
    wire = Asleep(bench, MS // 3, slept_s)
    d = bench.connection.dictionary
    bench.link = _core.Link(HZ)
    bench.link.set_dictionary(d.commands, d.reports, d.number("RECEIVE_WINDOW"))
    bench.link.follow_clock(wire.now)
    wire.run(wire.now + 30 * HZ)
    before = bench.link.clock_at(wire.now)
    wire.run(wire.now + 3 * HZ)
    assert bench.link.clock_at(wire.now) > before
    off = (bench.link.clock_at(wire.now) - wire.board_time(wire.now) + 2**31) % 2**32 - 2**31
    assert abs(off * 1e6 / HZ) < 20


@pytest.mark.parametrize(
    ("wire_of", "rate", "seconds"),
    [(Warming, 33e-9 / HZ, 300), (Stopped, 1.0, 33)],  # 10 ppm in five minutes
)
def test_old_clock_samples_are_forgotten(wire_of, rate, seconds):
    bench = Bench()
    wire = wire_of(bench, MS // 3, rate)
    d = bench.connection.dictionary
    bench.link = _core.Link(HZ)
    bench.link.set_dictionary(d.commands, d.reports, d.number("RECEIVE_WINDOW"))
    bench.link.follow_clock(wire.now)
    wire.run(wire.now + seconds * HZ)
    off_us = (bench.link.clock_at(wire.now) - wire.board_time(wire.now)) * 1e6 / HZ
    assert abs(off_us) < 20


@pytest.mark.parametrize(("known", "least_us", "most_us"), [(True, 0, 3), (False, 60, 100)])
def test_an_answer_on_a_slow_line_is_longer_than_the_question(known, least_us, most_us):
    bench = Bench()
    wire = Wire(bench, byte=640)  # 250 000 baud at 16 MHz
    d = bench.connection.dictionary
    bench.link = _core.Link(HZ)
    bench.link.set_byte_ticks(640 if known else 0)
    bench.link.set_dictionary(d.commands, d.reports, d.number("RECEIVE_WINDOW"))
    bench.link.follow_clock(wire.now)
    wire.run(wire.now + 10 * HZ)
    off_us = (bench.link.clock_at(wire.now) - wire.board_time(wire.now)) * 1e6 / HZ
    # Unless the length of both is reckoned with, half of the difference is taken for time.
    assert least_us <= abs(off_us) <= most_us


def test_silent_board_is_reported_and_asked_less_often():
    bench = Bench()
    wire = Wire(bench)
    wire.spoil = lambda data: b""
    wire.run(wire.now + 20 * HZ)
    assert bench.link.lost
    copies = [at for at, data in wire.sent if data[:1] == b"\x7e"]
    gaps = [b - a for a, b in pairwise(copies)]
    assert gaps[:4] == [25 * MS] * 4
    assert all(b == 2 * a for a, b in pairwise(gaps[3:11]))
    assert max(gaps) == 5 * HZ


def spoil_last(data: bytes) -> bytes:
    return data[:-2] + bytes([data[-2] ^ 1]) + data[-1:]


@pytest.mark.parametrize("byte", [0, 640, 1389], ids=["USB", "250000 baud", "115200 baud"])
@pytest.mark.parametrize("loss", [lambda data: b"", spoil_last], ids=["lost", "spoilt"])
@pytest.mark.parametrize("times", [1, 2, 3])
def test_frame_lost_several_times_arrives_in_time(times, loss, byte):
    bench = Bench()
    bench.link.set_byte_ticks(byte)
    wire = Wire(bench, delay=MS // 4, byte=byte)
    plan = busy_plan(5, 120)
    base = start(bench, plan)
    left = times

    def spoil(data: bytes) -> bytes:
        nonlocal left
        if left == 0 or wire.now < base - 200 * MS:
            return data
        if "queue_step" not in "".join(decode(data, bench.connection.dictionary)):
            return data
        left -= 1
        return loss(data)

    wire.spoil_orders = spoil
    wire.run(base + max(plan.clocks[0][-1], plan.clocks[1][-1]) + HZ)
    assert left == 0
    assert bench.device.fault == ""
    assert_executed(bench, plan, base)


def test_frames_that_wait_for_slow_line_are_not_repeated():
    bench = Bench()
    bench.link.set_byte_ticks(16_000)  # 1 ms a byte: a full frame takes 64 ms
    wire = Wire(bench, byte=16_000)
    before = bench.link.retransmitted_bytes
    for _ in range(700):
        bench.link.send("clear_shutdown", [])
    wire.run(wire.now + 5 * HZ)
    assert bench.link.retransmitted_bytes == before
    assert wire.line_free[True] - wire.start > HZ // 2


def test_longer_round_trip_is_measured():
    bench = Bench()
    wire = Wire(bench, delay=MS // 4)
    wire.run(wire.now + 3 * HZ)
    before = bench.link.retransmitted_bytes
    wire.delay = 40 * MS
    wire.run(wire.now + 10 * HZ)
    repeated = bench.link.retransmitted_bytes
    assert 0 < repeated - before < 200
    wire.run(wire.now + 20 * HZ)
    assert bench.link.retransmitted_bytes == repeated
    assert not bench.link.lost


def test_lost_answers_do_not_lengthen_the_round_trip():
    """The board refuses copies, for it had the first ones: of several at once, all at once."""
    bench, rng = Bench(), random.Random(1)
    wire = Wire(bench, delay=MS // 4)
    wire.spoil_answers = lambda data: data if rng.random() < 0.2 else b""
    for _ in range(300):
        for _ in range(40):  # several frames
            bench.link.send("clear_shutdown", [])
        wire.run(wire.now + 50 * MS)
    wire.spoil_answers, wire.spoil_orders = (lambda data: data), (lambda data: b"")
    begin = wire.now
    wire.run(begin + 2 * HZ)
    copies = [at for at, data in wire.sent if data[:1] == b"\x7e" and at > begin]
    assert max(b - a for a, b in pairwise(copies[:4])) <= 30 * MS


@pytest.mark.parametrize("lost", ("orders", "answers"))
@pytest.mark.parametrize("share", (0.0, 0.5, 0.9, 1.0))
def test_emergency_stop_replaces_unacknowledged_frames(lost, share):
    """Whether the board has had that or not: it had all that came, and some answers were lost."""
    bench, rng = Bench(), random.Random(1)
    wire = Wire(bench, delay=MS // 4)
    setattr(wire, f"spoil_{lost}", lambda data: data if rng.random() > share else b"")
    for _ in range(1000):
        bench.link.send("get_config", [])
    wire.run(wire.now + 3 * MS)
    bench.link.send("emergency_stop", [])
    setattr(wire, f"spoil_{lost}", lambda data: data)
    frames = len(wire.sent)
    wire.run(wire.now + 2 * MS)
    assert bench.device.fault
    assert len(wire.sent[frames][1]) <= 13 * 6 + 1
    wire.run(wire.now + 200 * MS)
    assert bench.link.shut_down


@pytest.mark.parametrize("seed", range(20))
def test_emergency_stop_passes_a_noisy_link_at_once(seed):
    """Where whole frames hardly ever come through: one byte in six is spoilt, either way."""
    bench, rng = Bench(), random.Random(seed)
    wire = Wire(bench, delay=MS // 4)
    wire.spoil = lambda data: bytes(
        rng.randrange(256) if rng.random() < 1 / 6 else byte for byte in data
    )
    for _ in range(1000):
        bench.link.send("get_config", [])
    wire.run(wire.now + 300 * MS)
    begin = wire.now
    bench.link.send("emergency_stop", [])
    while not bench.device.fault:
        wire.run(wire.now + 1 * MS)
    assert wire.now - begin < 1000 * MS


def test_emergency_stop_is_first_after_lost_link():
    """It counts from elsewhere; what it may be told by then is not known to be the stop."""
    bench = Bench()
    wire = Wire(bench, delay=MS // 4)
    for _ in range(100):
        bench.link.send("get_config", [])
    wire.run(wire.now + 2 * MS)
    bench.link.reconnect()
    bench.link.send("get_config", [])
    wire.spoil_answers = lambda data: b""
    wire.run(wire.now + 50 * MS)
    bench.link.send("emergency_stop", [])
    wire.spoil_answers = lambda data: data
    wire.run(wire.now + 2 * MS)
    assert bench.device.fault
    wire.run(wire.now + 220 * MS)  # between two questions for the clock
    assert bench.link.acknowledged


def test_messages_not_yet_sent_can_be_revoked():
    bench = Bench()
    plan = Planner()
    plan.steps(0, True, HZ // 2, 1)
    plan.steps(0, True, 16_000, 500)
    plan.steps(0, True, HZ, 1)
    plan.steps(0, True, 16_000, 500)
    base = start(bench, plan)
    bench.connection.run(base + HZ)
    assert len(plan.queue) == 4
    plan.queue.clear()
    bench.run(3.0)
    assert bench.simulated.net_steps("x") == 501


def test_pin_commands_keep_order_when_kickstart_ends_late():
    bench = Bench()
    (fan, *_) = bench.board.output_targets
    bench.link.set_kick(fan, 3 * HZ // 10, HZ // 100, HZ)
    plan = Planner()
    plan.pin(fan, HZ // 5, 50_000)
    plan.pin(fan, 56 * HZ // 100, 0)
    bench.simulated.trace_output("fan")
    base = bench.connection.start_job(plan.queue)
    wire = Wire(bench)
    wire.run(base + HZ // 4)
    wire.now = base + 52 * HZ // 100  # nobody looks after the link: the kick should be over
    wire.run(base + HZ)
    late = base + 57 * HZ // 100
    begin = (base + HZ // 5, HZ // 100)
    assert bench.simulated.take_changes("fan") == [begin, (late, 50_000), (late, 0)]
    assert not bench.link.shut_down


@pytest.mark.parametrize("seed", range(1, 13))
def test_clock_error_is_small_after_the_first_answer(seed):
    device = SimulatedBoard(description(), PLANT, 0).device
    far = _core.Distant(device, 0, 20e-6, 3 * MS // 10, MS // 10, seed)
    link = _core.Link(float(HZ))
    link.set_dictionary(_core.board_commands(), _core.board_reports(), 0)
    pump = _core.Pump(link, far)
    link.follow_clock(0)
    wrong = [
        (link.clock_at(pump.now) - far.clock_at(pump.now)) / HZ
        for _ in range(300)
        if pump.run(pump.now + 10 * MS) == _core.Stop.TIME and link.synchronous
    ]
    assert len(wrong) > 290
    assert max(abs(seconds) for seconds in wrong) < 150e-6


def test_clock_is_estimated_if_every_query_is_repeated():
    """On a computer that became busy: all that either side has sent is looked at every 0.1 s only.
    The copies come with the first, and their refusals with the answer: no trip can be measured."""
    device = SimulatedBoard(description(), PLANT, 0).device
    link = _core.Link(float(HZ))
    link.set_dictionary(_core.board_commands(), _core.board_reports(), 0)
    down = b""
    wrong: list[int] = []
    for now in range(0, 3 * HZ, 5 * MS):
        if now < HZ:
            link.send("get_config", [])
        if now == HZ:
            link.follow_clock(now)
        if now < HZ or now % (100 * MS) == 0:
            device.feed(down, now)
            down = b""
            link.feed(device.poll(now), now)
            if link.synchronous:
                wrong.append(abs(link.clock_at(now) - now))
        down += link.poll(now)[0]
    assert link.retransmitted_bytes > 100  # copies of all of them
    assert len(wrong) > 15
    assert max(wrong) <= 100 * MS


def hash_of(messages: list[tuple[int, int, int, int]], chunk: int) -> int:
    """Stream hash of (target, interval, count, add) commands, given `chunk` at a time."""
    bench = Bench()
    queue = _core.MessageQueue()
    bench.connection.start_job(queue)
    clock = 0
    for i, (target, interval, count, add) in enumerate(messages):
        queue.push(_core.MessageKind.QUEUE_STEP, target, clock, clock + 1, interval, count, add)
        if i % chunk == chunk - 1:
            bench.link.poll(bench.connection.now + HZ)
    bench.link.poll(bench.connection.now + 2 * HZ)
    assert bench.link.messages == len(messages)
    return bench.link.stream_hash


def test_stream_hash_depends_on_content_and_order_only():
    messages = [(0, 1000, 10, 0), (1, 1000, 10, 0), (0, 70_000, 3, -5)]
    value = hash_of(messages, 3)
    assert value == hash_of(messages, 1) == 3854692376553383795
    others = [
        [messages[1], messages[0], messages[2]],
        [(0, 1001, 10, 0), *messages[1:]],
        [(0, 1000, 11, 0), *messages[1:]],
        [*messages[:2], (0, 70_000, 3, 5)],
        messages[:2],
    ]
    assert len({value, *(hash_of(m, 2) for m in others)}) == 6


def test_record_keeps_the_newest_frames_of_both_directions():
    link = _core.Link(1e6)
    link.keep_record(128, 8)
    link.send("identify", [0, 40])
    link.poll(0)
    first = link.recorded(0)
    assert [(host, clock, up) for host, clock, up, _ in first] == [(0, 0, False)]
    assert first[0][3] == _core.make_frame(bytes([1, 0, 40]), 1)
    for i in range(1, 30):
        link.feed(bytes([i]) * i, i)
    kept = link.recorded(0)
    assert [(host, data) for host, _, _, data in kept] == [
        (i, bytes([i]) * i)
        for i in range(26, 30)  # 26 + 27 + 28 + 29 bytes, one more is too many
    ]
    assert link.recorded(28) == kept[2:]
    link.feed(bytes(129), 30)  # longer than all that may be kept
    assert link.recorded(0) == kept
