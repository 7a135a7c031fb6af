"""Switches that are hit while the machine moves."""

import re
from array import array

import pytest
from tests.support.scenario import Scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G28", 60)
        scenario.host.ok("G1 X50 Y50 Z5 F6000")
        scenario.host.ok("M400")
        yield scenario


def test_a_trigger_is_reported_with_its_position_if_watched(s):
    s.host.ok("M120")
    s.passes(0.2)
    s.host.ok("G1 X150 F1200")
    s.passes(2)
    s.board.force_switch("y", True)
    line = s.host.expect("^echo:endstops hit: Y at X:", 1)
    where = float(re.search(r"X:([\d.]+)", line)[1])
    assert where == pytest.approx(s.positions()["x"], abs=3)
    s.host.ok("M400", 10)
    assert s.positions()["x"] == 150  # only told


def test_unwatched_switches_count_only_for_homing(s):
    s.host.ok("G1 X150 F1200")
    s.board.force_switch("y", True)
    s.host.silent(3, "endstops hit")
    s.host.ok("M120")
    s.host.ok("M121")
    s.board.force_switch("y", None)
    s.passes(3)
    s.board.force_switch("y", True)
    s.host.silent(3, "endstops hit")


def test_triggered_endstop_stops_the_machine_if_enabled(s):
    s.host.ok("M540 S1")
    assert s.host.ok("M540")[0] == "M540 S1"
    s.host.ok("M104 S150")
    s.host.ok("M140 S60")
    s.passes(0.2)
    s.host.ok("G1 X150 F1200")
    s.passes(2)
    s.board.force_switch("z", True)
    s.host.expect("endstops hit: Z", 1)
    s.passes(1)
    assert "echo:Heaters are off: an endstop was triggered during a move (M540)" in s.host.heard
    assert "// action:pause" in s.host.heard
    assert [h.target for h in s.printer.rig.connection.heaters.values()] == [0, 0]
    at = s.positions()["x"]
    assert 85 < at < 105
    s.passes(2)
    assert s.positions()["x"] == at
    s.board.force_switch("z", None)
    s.host.ok("G1 X60 F6000")
    s.host.ok("M400")
    assert s.positions()["x"] == pytest.approx(60, abs=0.02)
    assert s.host.ok("G28", 60)[-1] == "ok"


PRINT = "G28\nG1 X20 Y20 Z5 F6000\n" + "G1 X100 F3000\nG1 X20\n" * 50


@pytest.mark.parametrize("switch", ["x", "y", "z"])
def test_triggered_endstop_ends_a_print(tmp_path, switch):
    """Behind homing all switches are pressed; they are watched once they have been let go."""
    (tmp_path / "a.g").write_text(PRINT)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M540 S1")
        s.host.ok("M32 a.g")
        s.passes(20)
        assert s.printer.rig.job.history.line_at(s.printer.rig.queue.now) > 3
        s.host.silent(1, "endstops hit")
        s.board.force_switch(switch, True)
        s.host.expect(f"Print of a.g stopped: endstop {switch} was triggered", 3)
        s.passes(2)
        at = s.positions()
        s.passes(2)
        assert s.positions() == at
        assert "Not SD printing" in s.host.ok("M27")[0]


def test_each_print_reports_endstop_that_stays_triggered(tmp_path):
    (tmp_path / "a.g").write_text(PRINT)
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M120")
        s.host.ok("M32 a.g")
        s.passes(20)
        for switch in "yxz":  # each stays pressed from then on
            s.board.force_switch(switch, True)
            s.host.expect(f"endstops hit: {switch.upper()} at", 1)
        s.board.force_switch("y", None)
        s.passes(0.5)
        s.board.force_switch("y", True)
        s.host.expect("endstops hit: Y at", 1)
        s.host.expect("Done printing file", 400)
        assert s.board.device.fault == ""


@pytest.mark.parametrize("after_s", [0.9, 1.7303, 2.4181, 3.1])
def test_the_place_is_that_of_the_moment_when_the_switch_closed(s, after_s):
    s.host.ok("M120")
    s.passes(0.2)
    s.board.trace_steps("x", 0, 1 << 62)
    start = s.printer.rig.connection.now
    before = s.positions()["x"]
    s.host.ok("G1 X80 F600")  # 10 mm/s: the board looks every 0.01 mm
    s.passes(after_s)
    closed = s.printer.rig.connection.now
    s.board.force_switch("y", True)
    line = s.host.expect("^echo:endstops hit: Y at X:", 1)
    where = float(re.search(r"X:([\d.]+)", line)[1])
    assert s.positions()["x"] > where  # the host has learnt of it later
    s.host.ok("M400")
    _, directions = s.board.take_steps("x", start, closed)
    made = sum(array("b", directions))
    assert made > 0
    assert where == pytest.approx(before + made / 80, abs=1 / 80)
