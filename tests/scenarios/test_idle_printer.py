"""What a printer does while nobody prints: motors, idle times, timers, mains, retries."""

import re

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.load import shipped_text


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("G92 X0 Y0 Z0")
        yield scenario


def test_m85_turns_everything_off_after_standing_idle(s):
    s.host.ok("G1 X1 F6000")
    s.host.ok("M140 S40 F")
    s.host.ok("M85 S60")
    assert s.host.ok("M85") == ["M85 S60", "ok"]
    s.passes(50)
    assert s.printer.rig.connection.heaters["bed"].target == 40
    s.passes(20)
    assert s.board.output_value("bed") == 0
    assert s.board.output_value("x-enable") == 1


def test_m81_switches_off_after_moves(s):
    s.host.ok("M140 S40 F")
    s.host.ok("G1 X20 F600")
    s.host.ok("M81", 10)
    s.passes(0.5)
    assert s.positions()["x"] == 40.0
    assert s.board.output_value("bed") == 0
    assert s.board.output_value("x-enable") == 1
    assert s.host.ok("M80") == ["ok"]


def test_the_timer_counts_only_while_it_runs(s):
    s.host.ok("M75")
    s.passes(65)
    s.host.ok("M76")
    s.passes(100)
    assert re.match(r"echo:Print time 0h 1m [45]s", s.host.ok("M31")[0])
    s.host.ok("M75")
    s.passes(3600)
    assert re.match(r"echo:Print time 1h 1m [45]s", s.host.ok("M77")[0])
    assert s.host.ok("M31")[0] == "echo:Print time 0h 0m 0s"


def test_progress_of_a_slicer(s):
    s.host.ok("M73 P40 R12")
    assert s.host.ok("M73")[0] == "echo:Progress: 40%, 12 min left"


def test_a_host_reports_when_its_print_begins_and_ends(s):
    s.passes(50)
    assert s.host.ok("M530 S1 L20") == ["echo:Start Printing", "ok"]
    assert s.host.ok("M531 G1 part") == ["ok"]
    s.passes(120)
    s.host.ok("M532 X33 L5")
    assert s.host.ok("M73")[0] == "echo:Progress: 33%"
    assert s.host.ok("M530 S0") == ["echo:Stop Printing", "ok"]
    s.passes(60)
    assert s.host.ok("M31")[0] == "echo:Print time 0h 2m 0s"
    assert s.host.ok("M73")[0] == "echo:Progress: nothing is printed"


def test_m410_brakes_on_the_path_and_m400_ends(s):
    s.host.ok("G1 X100 F3000")
    s.passes(1)
    s.host.send("M400")
    other = Host(s)
    other.send("M410")
    s.host.expect("^ok", 1)
    assert s.until(lambda: s.printer.rig.queue.standing, 1)
    at = s.positions()["x"]
    assert 20 < at < 120
    told = float(re.match(r"X:([\d.]+)", s.host.ok("M114")[0])[1])
    assert told == pytest.approx(at - 20, abs=0.02)


def test_a_switch_reads_the_same_open_or_closed_wire():
    text = shipped_text("i3").replace('pin = "^X_MIN"', 'pin = "^!X_MIN"')
    with Scenario(config.load_text(text)) as s:
        assert "x_min: open" in s.host.ok("M119")
        s.host.ok("G28 X", 60)
        assert s.positions()["x"] == pytest.approx(0, abs=0.02)
        assert "x_min: TRIGGERED" in s.host.ok("M119")


def test_home_offsets_move_the_home_position(s):
    s.host.ok("M206 X5")
    s.host.ok("G28 X", 60)
    assert s.host.ok("M114")[0].startswith("X:5.000 ")
    s.host.ok("G1 X15 F6000")
    s.host.ok("M400")
    assert s.positions()["x"] == pytest.approx(10, abs=0.02)


def test_idle_motors_go_off_before_heaters(s):
    for line in ("G1 X1 Y1 F6000", "M400"):
        s.host.ok(line)
    s.passes(590)
    assert [s.board.output_value(f"{motor}-enable") for motor in "xy"] == [0, 0]
    s.passes(15)
    assert [s.board.output_value(f"{motor}-enable") for motor in "xy"] == [1, 1]
    for line in ("M140 S40", "G92 X0 Y0", "G1 X2 Y2 F6000", "M400"):
        s.host.ok(line)
    s.passes(1790)
    assert s.printer.rig.connection.heaters["bed"].target == 40
    assert [s.board.output_value(f"{motor}-enable") for motor in "xy"] == [0, 0]
    s.passes(15)
    assert s.printer.rig.connection.heaters["bed"].target == 0
    assert [s.board.output_value(f"{motor}-enable") for motor in "xy"] == [1, 1]


def test_only_the_named_motors_go_off(s):
    s.host.ok("G1 X1 Y1 F6000")
    s.host.ok("M18 X")
    s.passes(0.2)
    assert s.board.output_value("x-enable") == 1
    assert s.board.output_value("y-enable") == 0
    s.host.ok("M17 Y")
    assert s.board.output_value("x-enable") == 1
    s.host.ok("M17 X")
    s.passes(0.1)
    assert s.board.output_value("x-enable") == 0
    s.host.ok("M18")
    s.host.ok("M18 Q")  # no motor of that name
    s.host.ok("G92 X0 Y0")
    s.host.ok("G1 X1 F6000")
    s.host.ok("M400")
    assert s.board.output_value("x-enable") == 0  # a move turns it on


def test_m937_and_m940_are_answered(s):
    assert s.host.ok("M937") == ["echo:M937 does nothing here. This machine has no probe.", "ok"]
    assert "computer" in s.host.ok("M940")[0]


def test_motors_with_shared_enable_pin_go_off_together():
    text = shipped_text("i3").replace('socket = "E0"', 'socket = "E0"\nenable_pin = "!D38"')
    machine = config.load_text(text)
    with Scenario(machine) as s:
        assert [o.name for o in s.board.board.outputs if "enable" in o.name] == [
            *("x-enable", "y-enable", "z-enable"),
        ]
        s.host.ok("M17")
        s.passes(0.1)
        assert s.board.output_value("x-enable") == 0
        s.host.ok("M18 X")
        s.passes(0.1)
        assert s.board.output_value("x-enable") == 0
        s.host.ok("M18 E")
        s.passes(0.1)
        assert s.board.output_value("x-enable") == 1
        s.host.ok("M17 E")
        s.passes(0.1)
        assert s.board.output_value("x-enable") == 0
