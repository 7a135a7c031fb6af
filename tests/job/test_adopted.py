"""A host is killed and its board lives on: what the next host believes of where the machine is."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.job.test_journal import journal_of
from tests.support.scenario import Scenario
from tests.support.two_boards import one_board

from passo.board.ports import InProcess
from passo.printer.setup import connections as wiring

MACHINE = one_board("passo")
PRINT = "M302 P1\nG28\nG1 X40 Y40 Z1 F6000\n" + "".join(
    f"G1 X{60 if i % 2 else 40} Y{40 + i / 4} F3000\n" for i in range(32)
)


@pytest.fixture
def places(tmp_path):
    card = tmp_path / "card"
    card.mkdir()
    (card / "a.g").write_text(PRINT)
    return {"card": str(card), "state": str(tmp_path / "state")}


def printing(places) -> Scenario:
    """A print that has come to Y 42."""
    s = Scenario(MACHINE, **places)
    s.host.ok("M32 a.g")
    assert s.until(lambda: s.positions()["y"] > 42 and s.positions()["z"] > 0.9, 60)
    return s


def killed(s: Scenario):
    """The board, when it has braked, and its clock."""
    port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
    port.unplug()
    s.passes(2)
    clock = queue.base + queue.now
    s.board.device.poll(clock)
    board = s.board
    s.__exit__()
    assert board.device.fault == ""
    return board, clock


@contextmanager
def next_host(monkeypatch, left, places):
    board, clock = left

    def connect(machine):
        ports = [InProcess(board.device, clock)]
        return wiring._connected(wiring.board_descriptions(machine), ports, adopt=True), board

    with monkeypatch.context() as patch:
        patch.setattr("passo.printer.printer.connect", connect)
        with Scenario(MACHINE, **places) as s:
            assert s.printer.rig.connection.adopted
            yield s


END = {"x": 60.0, "y": 47.75, "z": 1.0, "e": 5.0052}  # E: to fill the nozzle
OFFER = "from where the board has stopped"


def printed_on(s) -> dict[str, float]:
    """Where the print that the journal offers has ended."""
    s.host.send("M1000")
    s.host.expect("Printing a.g from line", 120)
    s.host.expect("Done printing", 120)
    assert s.printer.state.halted == ""
    return s.positions()


def push(board) -> None:
    """Somebody moves the carriage by hand."""
    board.place("x", board.position("x") + 3)


def test_held_motors_are_where_the_board_reports(monkeypatch, places):
    left = killed(printing(places))
    push(left[0])  # whoever can do that against the motor is not noticed
    with next_host(monkeypatch, left, places) as s:
        assert OFFER in s.printer.state.greeting()
        assert printed_on(s) == END | {"x": 63.0}


@pytest.mark.parametrize("code", ["M84", "M18 X", "M84 E"])
def test_motors_that_were_off_since_are_homed(monkeypatch, places, code):
    with next_host(monkeypatch, killed(printing(places)), places) as s:
        s.host.ok(code)
        s.host.ok("M400")
        if code != "M84 E":
            push(s.board)
        assert (OFFER in s.printer.state.greeting()) == (code == "M84 E")
        assert printed_on(s) == pytest.approx(END, abs=0.02)


def test_motors_that_were_off_under_the_host_before_are_homed(monkeypatch, places):
    s = printing(places)
    for line in ("M25", "M400", "M84", "M400"):
        s.host.ok(line, 20)
    s.passes(0.1)
    left = killed(s)
    assert journal_of(Path(places["state"]))[1].origins == {}
    push(left[0])
    with next_host(monkeypatch, left, places) as s:
        assert OFFER not in s.printer.state.greeting()
        retracted = {"e": END["e"] - 2.0}  # where it was parked
        assert printed_on(s) == pytest.approx(END | retracted, abs=0.02)


def test_motors_are_trusted_after_all_axes_homed(monkeypatch, places):
    s = printing(places)
    for line in ("M25", "M400", "M84", "M400", "G28 X"):
        s.host.ok(line, 60)
    s.passes(0.1)
    assert journal_of(Path(places["state"]))[1].origins == {}
    s.host.ok("G28 Y Z", 60)
    s.passes(0.1)
    assert journal_of(Path(places["state"]))[1].origins == s.printer.rig.positions.origins()
    with next_host(monkeypatch, killed(s), places) as s:
        assert OFFER in s.printer.state.greeting()


def test_step_origin_is_recorded_when_axis_is_homed(places):
    state = Path(places["state"])
    with Scenario(MACHINE, **places) as s:
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.printer.motion.homer.active, 10)
        assert s.until(lambda: not s.printer.motion.homer.active, 60)
        s.passes(0.05)
        assert journal_of(state)[1].origins == s.printer.rig.positions.origins() != {}


def test_step_origin_is_recorded_while_print_is_paused(places):
    state = Path(places["state"])
    with printing(places) as s:
        s.host.ok("M25")
        s.host.ok("M400", 20)
        before = journal_of(state)[1].origins
        push(s.board)
        s.host.ok("G28 X", 60)
        s.passes(0.05)
        after = journal_of(state)[1].origins
        assert after["x"] - before["x"] == pytest.approx(3 * 80, abs=2)
        assert after == before | {"x": after["x"]}


def interrupted(places, begin) -> tuple[Scenario, float]:
    """A print of these first lines that has come to the eighth move, and where the nozzle is by the
    program less where it is, in X."""
    text = f"M302 P1\n{begin}\n" + PRINT.partition("Z1 F6000\n")[2]
    (Path(places["card"]) / "a.g").write_text(text)
    s = Scenario(MACHINE, **places)
    s.host.ok("M32 a.g")
    job, queue = s.printer.rig.job, s.printer.rig.queue
    eighth = text[: text.index("Y41.75")].count("\n")
    assert s.until(lambda: job.history.line_at(queue.now) >= eighth, 60)
    return s, job.history.position_at(queue.now)[0] - s.positions()["x"]


SET = ["G92 X40 Y40 Z1", "G28\nG1 X10 Y10 F6000\nM84\nG92 X40 Y40 Z1"]


def test_position_that_g92_has_set_is_that_of_the_resumed_print(monkeypatch, places):
    s, offset = interrupted(places, SET[0])
    with next_host(monkeypatch, killed(s), places) as s:
        assert printed_on(s)["x"] == pytest.approx(60 - offset, abs=0.02)


@pytest.mark.parametrize("begin", SET)
def test_position_that_g92_has_set_is_lost_in_a_power_cut(places, begin):
    s, _ = interrupted(places, begin)
    s.__exit__()
    with Scenario(MACHINE, **places) as s:
        before = s.positions()
        s.host.send("M1000")
        s.host.expect("a.g: set the position of X, Y by G92, without homing", 20)
        assert s.positions() == before
