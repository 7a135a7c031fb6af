"""A board that has outlived its host, with another host, whose link is lost before that has moved
anything."""

from __future__ import annotations

import pytest
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.support.scenario import Scenario

from passo.board.boards import Boards
from passo.board.connection import Connection
from passo.board.ports import InProcess
from passo.simulator import SimulatedMachine

HZ = FIRMWARE.board.clock_hz


def left_alone(moment: float) -> tuple[SimulatedMachine, int]:
    """A board whose host was killed while X moved, and stands now; and its clock."""
    with Scenario(FIRMWARE) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X50 F1200", "G1 Y30")
        s.passes(moment)
        board, clock = s.board, s.printer.rig.connection.now
    for _ in range(200):
        clock += HZ // 100
        board.device.poll(clock)
    return board, clock


@pytest.fixture
def other(monkeypatch):
    """The printer of another host, which has adopted the board."""
    board, clock = left_alone(1.7)
    stood = {name: board.net_steps(name) for name in ("x", "y")}
    assert 500 < stood["x"] < 3500

    def connect(machine):
        boards = Boards([Connection(board.board, InProcess(board.device, clock))])
        boards.connect(adopt=True)
        return boards, board

    monkeypatch.setattr("passo.printer.printer.connect", connect)
    with Scenario(FIRMWARE) as s:
        assert s.printer.rig.connection.adopted
        yield s, stood


def test_adopted_position_is_verified_before_first_move(other):
    s, stood = other
    break_link(s, 1.0)
    s.host.expect("The board is back", 10)
    assert not s.printer.state.halted
    assert {name: s.board.net_steps(name) for name in stood} == stood
    s.host.ok("G92 X10 Y10")
    s.host.send("G1 X20 Y15 F1200", "M400", "M118 done")
    s.host.expect("done", 10)
    assert s.board.net_steps("x") == stood["x"] + 800
    assert s.board.net_steps("y") == stood["y"] + 400


@pytest.mark.parametrize("moment", [0.02, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4])
def test_position_is_proved_with_first_commits_in_flight(other, moment):
    s, stood = other
    s.host.ok("G92 X10 Y10")
    s.host.send("G1 X20 Y15 F1200", "M400", "M118 done")
    s.passes(moment)
    for _ in range(2):
        break_link(s, 0.5)
        s.host.expect("The board is back", 10)
    s.host.expect("done", 10)
    assert s.board.net_steps("x") == stood["x"] + 800
    assert s.board.net_steps("y") == stood["y"] + 400
