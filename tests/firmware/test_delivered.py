"""What the host believes that a board has of the job: what the board has said, never the mere
acknowledgement of a commit behind which the machine stands; and what it waits for among several."""

from __future__ import annotations

import pytest
from tests.board.test_link import Wire
from tests.oracles import wire as oracle
from tests.support.link_bench import HZ, MS, Bench, Kind, Planner

from passo import _core

SERIAL = 7
STEPS = 40
DELAY = MS // 2


class Print:
    """One move and its commit, on the way to the firmware: of a board alone, or of one of several.
    `commits` are further ones in its midst, behind so many of its steps."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        timeline: _core.Timeline | None = None,
        commits: tuple[int, ...] = (),
    ) -> None:
        monkeypatch.setattr(Kind, "firmware", "passo")
        self.bench = Bench()
        connection = self.bench.connection
        if timeline is not None:
            connection.join(timeline, main=True, tolerance_s=0.0)
        connection.use_commits(0.2)
        connection.command("survive_arm")
        self.bench.link.begin_commits(True)
        self.plan = Planner()
        self.plan.steps(0, True, HZ // 2, 1, lead=200)
        serial, done = SERIAL - len(commits), 1
        for steps in commits:
            self.plan.steps(0, True, 10_000, steps - done)
            at = self.plan.clocks[0][-1]
            self.plan.queue.push(_core.MessageKind.COMMIT, 0, at, at, interval=serial)
            serial, done = serial + 1, steps
        self.plan.steps(0, True, 10_000, STEPS - done)
        self.end = self.plan.clocks[0][-1]
        self.plan.queue.push(
            _core.MessageKind.COMMIT, 0, self.end, self.end, interval=SERIAL, dir=True
        )
        self.base = connection.start_job(self.plan.queue)
        self.wire = Wire(self.bench, DELAY)
        self.reports = _core.Formats(connection.dictionary.reports)
        self.commands = _core.Formats(connection.dictionary.commands)
        self.delivered: list[int] = []  # when it was

    def run(self, seconds: float) -> None:
        until = self.wire.now + int(seconds * HZ)
        while self.wire.now <= until:
            self.wire.run(self.wire.now + MS)
            if self.bench.link.delivered:
                self.delivered.append(self.wire.now)

    def without_states(self, answers: bytes) -> bytes:
        """Answers of the board, but for those that tell of its commits."""
        kept = b""
        while answers:
            frame, answers = answers[: answers[0]], answers[answers[0] :]
            payload = frame[2:-3]
            names = [name for name, _ in self.reports.decode(payload)] if payload else []
            kept += b"" if "survive_state" in names else frame
        return kept

    def without_commits(self, orders: bytes) -> bytes:
        """Frames of the host; where one has a commit the board gets an empty one of its number."""
        told = b""
        while orders:
            if orders[:1] == b"\x7e":
                told, orders = told + orders[:1], orders[1:]
                continue
            frame, orders = orders[: orders[0]], orders[orders[0] :]
            names = [name for name, _ in self.commands.decode(frame[2:-3])]
            told += oracle.frame(b"", frame[1]) if "survive_commit" in names else frame
        return told

    def steps(self) -> int:
        return self.bench.connection.net_steps("x")


def test_a_commit_that_the_board_has_taken_is_delivered(monkeypatch):
    p = Print(monkeypatch)
    p.run(1.5)
    assert p.delivered[0] < p.base + p.end
    assert not p.bench.link.self_stopped
    assert p.steps() == STEPS


def test_job_is_not_delivered_before_board_reports_it(monkeypatch):
    p = Print(monkeypatch)
    p.wire.spoil_answers = p.without_states
    p.run(1.5)
    assert p.delivered == []
    p.wire.spoil_answers = lambda data: data
    heard = p.wire.now
    p.run(0.1)
    assert p.delivered[0] <= heard + 3 * MS  # it is asked again as soon as it has left it open
    assert not p.bench.link.self_stopped
    assert p.steps() == STEPS


def test_refused_commit_is_not_delivered_if_refusal_is_lost(monkeypatch):
    p = Print(monkeypatch)
    p.run(0.2)
    p.wire.spoil_orders = lambda data: b""  # so that it comes too late
    p.run(0.8)
    p.wire.spoil_orders, p.wire.spoil_answers = lambda data: data, p.without_states
    p.run(1.0)
    assert p.delivered == [] and not p.bench.link.self_stopped
    p.wire.spoil_answers = lambda data: data
    p.run(0.01)
    assert p.delivered == [] and p.bench.link.self_stopped
    assert p.steps() == 0


def test_commit_acknowledged_as_other_bytes_is_not_delivered(monkeypatch):
    p = Print(monkeypatch)
    p.wire.spoil_orders = p.without_commits
    p.run(1.5)
    assert p.delivered == [] and p.bench.link.self_stopped
    assert p.steps() == 0


def run_all(boards: list[Print], seconds: float) -> None:
    until = boards[0].wire.now + int(seconds * HZ)
    while (last := min(boards, key=lambda p: p.wire.now)).wire.now < until:
        last.run(0)


def sent(p: Print) -> list[tuple[int, list[str]]]:
    """The frames that have left so far: when, and the commands in each."""
    found = []
    for at, data in p.wire.sent:
        for frame in _core.FrameScanner().feed(data):
            assert frame is not None
            found.append((at, [name for name, _ in p.commands.decode(frame[1])]))
    return found


def words(p: Print) -> list[int]:
    return [at for at, names in sent(p) if "survive_commit" in names]


def test_commit_waits_until_all_boards_have_its_commands(monkeypatch):
    timeline = _core.Timeline()
    a, b = (Print(monkeypatch, timeline) for _ in range(2))
    held = bytearray()
    a.wire.spoil_answers = lambda data: held.extend(data) or b""
    run_all([a, b], 0.65)  # it could have left by then
    assert words(a) == words(b) == []
    a.wire.spoil_answers = lambda data: data
    a.bench.link.feed(bytes(held), a.wire.now)
    run_all([a, b], 1.0)
    for p in (a, b):
        assert len(words(p)) == 1
        assert p.delivered and p.steps() == STEPS


def test_commit_waits_if_all_its_commands_leave_late(monkeypatch):
    p = Print(monkeypatch, _core.Timeline())
    p.wire.now += int(0.6 * HZ)
    p.run(1.0)
    moved = max(at for at, names in sent(p) if "queue_step" in names)
    assert words(p)[0] >= moved + 2 * DELAY  # acknowledged by then
    assert p.delivered and p.steps() == STEPS


def test_commit_waits_until_previous_one_is_taken(monkeypatch):
    p = Print(monkeypatch, _core.Timeline(), commits=(30,))
    p.wire.spoil_answers = p.without_states
    p.run(0.65)  # both could have left by then, and the board would brake a while later
    assert len(words(p)) == 1
    p.wire.spoil_answers = lambda data: data
    p.run(1.0)
    assert len(words(p)) == 2
    assert p.delivered and p.steps() == STEPS
