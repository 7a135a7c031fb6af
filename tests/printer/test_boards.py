"""A printer with two boards: heat on either, and what becomes of one when the other fails."""

from functools import partial

import pytest
from tests.support.scenario import Scenario
from tests.support.two_boards import two_boards

from passo.printer.setup.connections import connect_simulated
from passo.simulator import Cable

LIGHTS = {"head": "tool:D11", "case": "D11"}
HOT = {'"D10"': '"tool:D10"', '"T0"': '"tool:T0"', '"D9"': '"tool:D9"'}


@pytest.fixture
def printer(monkeypatch):
    """The hotend, its fan, Z and the extruder on the second board."""
    cable = Cable(200e-6, 50e-6)
    monkeypatch.setattr("passo.printer.printer.connect", partial(connect_simulated, cable=cable))
    with Scenario(two_boards("drift_ppm = -100.0", "start_s = 9.0", **HOT)) as s:
        yield s


def test_a_hotend_on_another_board_keeps_its_temperature(printer):
    s = printer
    s.host.ok("M109 S200", 400)
    s.passes(60)
    assert s.board.temperature("hotend") == pytest.approx(200, abs=1)
    s.host.ok("M106 S255")
    s.passes(60)
    # The loop knows of the fan.
    assert s.printer.rig.connection.heaters["hotend"].fan == 1.0
    assert s.board.temperature("hotend") == pytest.approx(200, abs=2)
    s.host.ok("M140 S60")
    s.passes(300)
    assert s.board.temperature("bed") == pytest.approx(60, abs=1)


def moving(s):
    s.host.ok("M302 P1")
    s.host.ok("G28", 60)
    s.host.ok("M104 S200")
    s.host.ok("M140 S60")
    s.passes(5)
    s.host.ok("G1 X150 Y150 Z20 E40 F1200")
    s.passes(3)


def all_off(s):
    return all(s.board.output_value(name) == 0 for name in ("hotend", "bed"))


def halted_alike(s):
    """All motors stand within this time, and all heaters are off."""
    s.passes(0.05)
    stood = s.positions()
    s.passes(2)
    assert s.positions() == stood
    assert all_off(s)
    assert all(board.device.fault for board in s.board.boards.values())


@pytest.mark.parametrize("which", [0, 1])
def test_a_board_that_stops_stops_the_other(printer, which):
    s = printer
    moving(s)
    failed = s.printer.rig.connection.connections[which]
    failed.command("emergency_stop")
    halted_alike(s)
    where = r" \(board tool\)" if which else ""
    s.host.expect(rf"Error:Printer halted: the board shut down: Command request{where}\.", 1)
    assert s.printer.rig.connection.connections[which].link.stopped_with_others is False
    assert s.printer.rig.connection.connections[1 - which].link.stopped_with_others is True
    s.host.send("M999")
    s.host.expect("ready again", 20)
    assert s.host.ok("G28", 60)[-1] == "ok"
    s.host.ok("G1 X10 Z4 F3000", 60)
    s.host.ok("M400", 60)
    assert s.positions()["x"] == pytest.approx(10, abs=1 / 80)
    assert s.positions()["z"] == pytest.approx(4, abs=1 / 400)


def test_a_board_that_is_lost_stops_the_other(printer):
    s = printer
    moving(s)
    s.host.ok("G1 X0 Y0 Z0 F300")
    s.board.cut_cable("tool")
    s.host.expect("Error:Printer halted: the board does not answer get_clock .board tool", 8)
    s.passes(4)
    assert all_off(s)
    assert all(board.device.fault for board in s.board.boards.values())


def test_emergency_stop_reaches_all_boards(printer):
    s = printer
    moving(s)
    s.host.send("M112")
    halted_alike(s)


def test_a_heater_on_another_board_that_fails_halts_the_machine(printer):
    s = printer
    moving(s)
    s.board.force_sensor("hotend", 0.9999)
    s.host.expect("Error:Printer halted: .*hotend", 5)
    halted_alike(s)


def test_parts_of_two_boards_may_have_pins_of_one_name():
    lights = [f'[lights.{on}]\nkind = "neopixel"\npin = "{pin}"' for on, pin in LIGHTS.items()]
    with Scenario(two_boards(*lights)) as s:
        s.host.ok("SET_LED LED=head RED=1")
        s.passes(1)
        assert bytes(s.board.light("head")) == bytes([0, 255, 0])
        assert bytes(s.board.light("case")) == bytes(3)
