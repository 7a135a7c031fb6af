"""A board that begins anew all of a sudden: its supply has failed for a moment, or its watchdog has
struck."""

import pytest
from tests.job import test_place_lost
from tests.job.test_lost_link import FIRMWARE
from tests.support.disturbed_prints import reset
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.config.pin_names import MAIN

printing = test_place_lost.printing


def test_a_print_resumes_from_the_journal(printing):
    s = printing
    reset(s)
    s.host.expect("^Error:the board restarted .reset or power failure.; position lost", 1)
    s.host.expect("The printer is ready again", 1)
    assert not any("The machine waits" in line for line in s.host.heard)
    s.passes(1)
    assert s.board.device.fault == ""  # nothing was sent to a board without a configuration
    test_place_lost.goes_on(s)


@pytest.mark.parametrize("doing", ["M104 S60", "M109 S200", "G28", "G1 X10 Y10 F300"])
def test_board_reset_in_any_activity_keeps_targets(doing):
    with Scenario(FIRMWARE) as s:
        s.host.ok("G28", 60)
        s.host.send(doing)
        s.passes(1.2)
        target = s.printer.rig.connection.heaters["hotend"].target
        reset(s)
        s.host.expect("the board restarted", 1)
        s.host.expect("The printer is ready again", 1)
        s.passes(2)
        assert s.printer.rig.connection.heaters["hotend"].target == target
        assert (s.board.output_value("hotend") > 0) == (target > 0)
        assert "axis X is not homed" in s.host.ok("G1 X50")[0]
        s.host.ok("G28", 60)
        s.host.ok("G1 X50 F6000")
        s.host.ok("M400", 20)
        assert s.positions()["x"] == 50
        assert s.board.device.fault == ""


@pytest.mark.parametrize("board", [MAIN, "tool"])
def test_reset_of_one_of_two_boards_stops_both(board):
    with Scenario(two_boards(firmware="passo")) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M104 S60")
        s.host.send("G1 X100 Z20 F600")
        s.passes(2)
        reset(s, board)
        name = "board tool" if board else "the board"
        s.host.expect(f"^Error:{name} restarted", 2)
        s.host.expect("The printer is ready again", 2)
        s.passes(2)
        assert s.printer.rig.connection.heaters["hotend"].target == 60
        s.host.ok("G28", 60)
        s.host.ok("G1 X50 F6000")
        s.host.ok("M400", 20)
        assert s.positions()["x"] == 50


@pytest.mark.parametrize(("seconds", "warm"), [(50, False), (70, True)])
def test_second_reset_within_a_minute_halts_cold(seconds, warm):
    """What it keeps warm may be what its supply fails at."""
    with Scenario(FIRMWARE) as s:
        s.host.ok("M104 S60")
        s.passes(5)
        reset(s)
        s.host.expect("The printer is ready again", 1)
        s.passes(seconds - 1)
        reset(s)
        s.passes(2)
        assert (s.printer.state.halted == "") == warm
        assert (s.printer.rig.connection.heaters["hotend"].target > 0) == warm
        assert (s.board.output_value("hotend") > 0) == warm
        if not warm:
            s.host.expect("^Error:Printer halted: the board restarted", 1)
            s.host.send("M999")
            s.host.expect("The printer is ready again", 5)
