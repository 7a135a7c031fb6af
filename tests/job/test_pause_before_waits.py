"""A pause while a command of the file waits for the moves before it: it comes behind them still."""

from pathlib import Path

import pytest
from tests.support.scenario import Host, Scenario

HOME = ["G28", "G1 X10 Y100 Z20 F6000", "M400"]
MOVES = "G1 X60 F600\nG1 X100\n"


def printing(s: Scenario, program: str, seconds: float, *, homed: bool = True) -> None:
    """Starts a file, and pauses it after that time."""
    Path(s.card, "a.g").write_text(program)
    for line in HOME if homed else []:
        s.host.ok(line, 100)
    s.host.ok("M32 a.g")
    s.passes(seconds)
    s.host.ok("M25")


@pytest.fixture
def s(tmp_path):
    with Scenario(card=str(tmp_path)) as scenario:
        scenario.card = str(tmp_path)
        yield scenario


@pytest.mark.parametrize("seconds", [0.0, 0.1])
@pytest.mark.parametrize("homed", [False, True])
def test_homing_at_the_beginning_comes_after_the_pause(s, seconds, homed):
    printing(s, "G28\nG1 X20 Y30 F6000\nM118 end\n", seconds, homed=homed)
    s.passes(5)
    before = s.positions()
    s.passes(20)
    assert s.positions() == before  # nothing homes in the pause
    s.host.ok("M24")
    s.host.expect("Done printing", 200)
    assert s.positions()["x"] == pytest.approx(20, abs=0.02)
    assert s.positions()["y"] == pytest.approx(30, abs=0.02)
    assert s.host.ok("G1 X40 F6000")[-1] == "ok"
    s.host.ok("M400", 10)
    assert s.positions()["x"] == pytest.approx(40, abs=0.02)


@pytest.mark.parametrize("seconds", [3.0, 6.0, 7.5, 8.5])
def test_homing_at_the_end_comes_when_the_moves_are_done(s, seconds):
    printing(s, MOVES + "M104 S0\nG28 X\n", seconds)
    s.passes(20)
    x = s.positions()["x"]
    assert 10 < x < 100
    s.host.ok("M24")
    s.host.expect("Done printing", 200)
    assert s.positions()["x"] == pytest.approx(0, abs=0.02)


@pytest.mark.parametrize("seconds", [3.0, 8.0])
def test_motors_stay_on_in_the_pause(s, seconds):
    printing(s, MOVES + "M84\n", seconds)
    s.passes(20)
    assert s.printer.outputs.motors.on
    s.host.ok("M24")
    s.host.expect("Done printing", 200)
    assert s.positions()["x"] == pytest.approx(100, abs=0.02)


@pytest.mark.parametrize(
    ("stop", "says"),
    [
        ("M25", None),
        ("M524", None),
        ("M112", "Error:Printer halted: emergency stop by M112"),
        ("M410", "Print of a.g stopped: a.g:[0-9]+: the print was stopped by M410"),
    ],
)
def test_stops_in_file_come_after_moves_before_them(s, stop, says):
    for line in HOME:
        s.host.ok(line, 100)
    Path(s.card, "a.g").write_text(f"G1 X60 F1200\n{stop}\nG1 X10\n")
    s.host.ok("M32 a.g")
    if says:
        s.host.expect(says, 60)
    s.passes(15)
    assert s.positions()["x"] == pytest.approx(60, abs=0.02)
    if stop == "M25":
        s.host.ok("M24")
        s.host.expect("Done printing", 60)
        assert s.positions()["x"] == pytest.approx(10, abs=0.02)


@pytest.mark.parametrize(("line", "x"), [("M25", 60), ("M84 Y", 10)])
def test_m108_does_not_end_wait_before_pending_action(s, line, x):
    for command in HOME:
        s.host.ok(command, 100)
    Path(s.card, "a.g").write_text(f"G1 X60 F1200\n{line}\nG1 X10\n")
    s.host.ok("M32 a.g")
    s.passes(1)
    s.host.ok("M108")
    s.passes(15)
    assert s.positions()["x"] == pytest.approx(x, abs=0.02)
    assert (1 in s.printer.rig.job.locked_axes) == (line != "M25")
    s.host.send("M24")
    s.passes(15)
    assert "Done printing file" in s.host.heard
    assert s.positions()["x"] == pytest.approx(10, abs=0.02)


def test_m84_of_console_that_left_follows_its_moves(s):
    for command in HOME:
        s.host.ok(command, 100)
    other = Host(s)
    other.send("G1 X60 F1200", "M84")
    s.passes(1)
    other.session.close()
    s.passes(10)
    assert s.positions()["x"] == pytest.approx(60, abs=0.02)
    assert not s.printer.outputs.motors.on
