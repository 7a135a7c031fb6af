"""Commands that come late are told on the consoles, with line, cause and what to do."""

from __future__ import annotations

import re
from random import Random

import pytest
from tests.support.disturbed_prints import steps
from tests.support.scenario import Scenario

from passo import config
from passo._core import Link, Stop
from passo.simulator import SimulatedBoard

FIRST = 4
FILE = "M302 P1\nG28\nG92 E0\n" + "".join(
    f"G1 X{10 + i} Y{10 + i % 2} E{i / 10} F1200\n" for i in range(100)
)


class Wire:
    """The cable of a simulated board, in virtual time; every byte is lost while `cut`, and the
    program does not run from the next look on for `stall` ticks."""

    def __init__(self, link: Link, board: SimulatedBoard, now: int) -> None:
        self.hz = link.hz
        self.link, self.device, self.now = link, board.device, now
        self.cut = False
        self.stall = 0

    def board_clock(self, link: Link) -> int:
        return self.now

    def run(self, until: int, until_heaters: bool = False) -> Stop:
        while True:
            if self.stall:
                self.now, self.stall = self.now + self.stall, 0
                self.device.poll(self.now)
            down, due = self.link.poll(self.now)
            if down and not self.cut:
                self.device.feed(down, self.now)
            up = self.device.poll(self.now)
            if up and not self.cut:
                self.link.feed(up, self.now)
                continue
            if self.link.shut_down:
                return Stop.SHUTDOWN
            due = min(due, self.device.next_deadline)
            if due > until:
                self.now = max(self.now, until)
                self.device.poll(self.now)
                return Stop.TIME
            self.now = max(due, self.now)


@pytest.fixture(params=["virtual", "passo"])
def printing(request, tmp_path):
    """A printer in the midst of a file, and its cable."""
    (tmp_path / "card").mkdir()
    (tmp_path / "card" / "a.g").write_text(FILE)
    machine = config.load("i3")
    board = machine.board.model_copy(update={"firmware": request.param})
    machine = machine.model_copy(update={"board": board})
    places = {"card": str(tmp_path / "card"), "state": str(tmp_path / "state")}
    with Scenario(machine, **places) as s:
        connection = s.printer.rig.connection.main
        wire = Wire(connection.link, s.board, connection.now)
        connection.wire = wire
        s.host.ok("M32 a.g")
        assert s.until(
            lambda: s.printer.rig.job.history.line_at(s.printer.rig.queue.now) > FIRST + 20, 60
        )
        yield s, wire


def line_now(s: Scenario) -> int:
    return s.printer.rig.job.history.line_near(s.printer.rig.queue.now)


def test_retransmissions_are_named_for_late_commands(printing):
    s, wire = printing
    assert "(" not in s.host.ok("M122")[-2]
    for _ in range(10):  # until it hits frames that are urgent
        line = line_now(s)
        wire.cut = True
        s.passes(0.06)
        wire.cut = False
        s.passes(0.3)
        if s.printer.lateness.worst:
            break
    told = s.host.expect("commands reached the board", 2)
    pattern = (
        r"echo:a.g:(\d+): commands reached the board (\d+) ms before they were due \(needed: 60 ms"
        r" before\): bytes were lost and sent again for 0.\d\d s, (\d+) of them so far\. Use"
        r" a shorter cable away from the motors' wires, or 115200 baud\."
    )
    found = re.fullmatch(pattern, told)
    assert found, told
    assert line <= int(found[1]) <= line + 6
    assert int(found[2]) < 60
    summary = s.host.ok("M122")[-2]
    assert re.fullmatch(
        rf"Link: least slack {found[2]} ms; late frames: \d+ of \d+ \(\d+ sent again\);"
        rf" longest stall 0 ms; \d+ bytes, {found[3]} of them again",
        summary,
    )
    s.host.expect("Done printing", 60)
    assert s.host.ok("M78")[3] == told.replace("echo:", "echo:    ")


def test_a_stall_is_reported_at_most_every_ten_seconds(printing):
    s, wire = printing
    for _ in range(3):
        wire.stall = s.printer.rig.queue.hz // 10
        s.passes(1)
    told = [x for x in s.host.heard if "commands reached" in x]
    assert len(told) == 1
    assert re.search(r"the computer did not let Passo run for 0\.(0[7-9]|10) s\. End", told[0])


def test_a_board_that_braked_for_late_commands_continues(printing, tmp_path):
    s, wire = printing
    if s.machine.board.firmware != "passo":
        wire.cut = True
        s.passes(0.2)
        wire.cut = False
        s.host.expect("ms after they were due .* bytes were lost", 3)
        s.host.expect("Printer halted: the board shut down", 3)
        return
    generator = Random(3)
    for _ in range(4):
        wire.cut = True
        s.passes(generator.uniform(0.2, 0.3))
        wire.cut = False
        s.host.expect("the board ran out of commands and braked to a stop", 3)
        s.host.expect("The board is back", 3)
        s.passes(generator.uniform(0.1, 1.0))
    s.host.expect("Done printing", 60)
    assert s.board.device.fault == ""
    found = steps(s)
    with Scenario(s.machine, card=str(tmp_path / "card")) as undisturbed:
        undisturbed.host.ok("M32 a.g")
        undisturbed.host.expect("Done printing", 60)
        assert found == steps(undisturbed)
