"""What the host believes that a board alone has of the job: what the board has said, never the mere
acknowledgement of a commit behind which the machine stands."""

from __future__ import annotations

import pytest
from tests.board.bench import HZ, MS, Bench, Kind, Planner
from tests.board.test_link import Wire
from tests.oracles import wire as oracle

from passo import _core

SERIAL = 7
STEPS = 40
DELAY = MS // 2


class Print:
    """One move and its commit, on the way to the firmware."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(Kind, "firmware", "passo")
        self.bench = Bench()
        connection = self.bench.connection
        connection.use_commits(0.2)
        connection.command("survive_arm")
        self.bench.link.begin_commits(True)
        self.plan = Planner()
        self.plan.steps(0, True, HZ // 2, 1, lead=200)
        self.plan.steps(0, True, 10_000, STEPS - 1)
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
    assert not p.bench.link.alone
    assert p.steps() == STEPS


def test_it_is_not_before_the_board_has_said_so(monkeypatch):
    p = Print(monkeypatch)
    p.wire.spoil_answers = p.without_states
    p.run(1.5)
    assert p.delivered == []
    p.wire.spoil_answers = lambda data: data
    heard = p.wire.now
    p.run(0.1)
    assert p.delivered[0] <= heard + 3 * MS  # it is asked again as soon as it has left it open
    assert not p.bench.link.alone
    assert p.steps() == STEPS


def test_a_commit_that_was_refused_is_not_delivered_though_the_refusal_is_lost(monkeypatch):
    p = Print(monkeypatch)
    p.run(0.2)
    p.wire.spoil_orders = lambda data: b""  # so that it comes too late
    p.run(0.8)
    p.wire.spoil_orders, p.wire.spoil_answers = lambda data: data, p.without_states
    p.run(1.0)
    assert p.delivered == [] and not p.bench.link.alone
    p.wire.spoil_answers = lambda data: data
    p.run(0.01)
    assert p.delivered == [] and p.bench.link.alone
    assert p.steps() == 0


def test_a_commit_that_was_acknowledged_as_other_bytes_is_not_delivered(monkeypatch):
    p = Print(monkeypatch)
    p.wire.spoil_orders = p.without_commits
    p.run(1.5)
    assert p.delivered == [] and p.bench.link.alone
    assert p.steps() == 0
