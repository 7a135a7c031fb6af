"""A halt while a link is lost: the board keeps warm for a minute, unless it hears of the halt
before, and nobody is told an old temperature meanwhile."""

import json
import re

import pytest
from tests.job.test_lost_boards import scenario
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.support.scenario import Scenario

from passo.config.pin_names import MAIN
from passo.errors import MachineError

ORDER = "Command request"
WARNING = (
    "Error:the emergency stop has not reached {}, which may heat for up to a minute."
    " Cut the printer's power, or restore the connection."
)
ARRIVED = "echo:Emergency stop confirmed by all boards; heaters are off"
UNKNOWN = "T:-273.15 /0.00 B:-273.15 /0.00 @:0 B@:0"


def heat(s):
    s.host.ok("M104 S60")
    s.host.ok("M109 S60", 300)
    s.passes(20)
    assert s.board.output_value("hotend") > 0


def measured_c(s):
    """The temperatures of hotend and bed that M105 reports."""
    told = re.match(r"ok T:(\S+) /0.00 B:(\S+) /0.00 @:0 B@:0", s.host.ok("M105")[-1])
    assert told
    return float(told[1]), float(told[2])


@pytest.fixture
def hot():
    with Scenario(FIRMWARE) as s:
        s.host.ok("G92 X0 Y0 Z0")
        heat(s)
        yield s


def unplug(s):
    s.printer.rig.connection.main.port.unplug()


def plug(s, seconds=1.0):
    """The cable is back, and the board has lived on since; so much time passes."""
    queue = s.printer.rig.queue
    clock = queue.base + queue.now
    s.printer.rig.connection.main.port.plug(clock)
    s.board.device.poll(clock)
    s.passes(seconds)


def live_on(s, seconds):
    """So much time passes, at the unplugged board too."""
    s.passes(seconds)
    s.board.device.poll(s.printer.rig.queue.base + s.printer.rig.queue.now)


@pytest.mark.parametrize("lost_s", [0.05, 2.0, 20.0])
@pytest.mark.parametrize("stopped_s", [0.05, 1.0, 30.0])
def test_the_board_is_stopped_as_soon_as_its_cable_is_back(hot, lost_s, stopped_s):
    s = hot
    s.host.send("G1 X100 F600")
    s.passes(1)
    unplug(s)
    s.passes(lost_s)
    s.host.ok("M112")
    s.passes(stopped_s)
    assert s.board.device.fault == ""
    plug(s)
    assert s.board.device.fault == ORDER
    assert s.board.output_value("hotend") == 0
    assert s.printer.state.halted == "emergency stop by M112"
    s.host.ok("M999")
    s.host.ok("M109 S40", 60)
    assert s.board.temperature("hotend") == pytest.approx(40, abs=20)


def test_a_halt_for_another_reason_is_sent_to_the_board_too(hot):
    s = hot
    unplug(s)
    s.passes(5)
    s.printer.stops.halt(MachineError.of("machine.no-power"))
    s.host.expect("Printer halted: the power supply is off, and a motor was to move", 5)
    plug(s)
    assert s.board.device.fault == ORDER


def test_console_gets_advice_once_and_end_once(hot):
    s = hot
    unplug(s)
    s.passes(2)
    s.host.ok("M112")
    live_on(s, 40)
    assert s.board.output_value("hotend") > 0  # so it is worth a word
    assert s.host.heard.count(WARNING.format("the board")) == 1
    assert ARRIVED not in s.host.heard
    plug(s, 20)
    assert s.host.heard.count(WARNING.format("the board")) == 1
    assert s.host.heard.count(ARRIVED) == 1


def test_a_halt_of_a_connected_board_gives_no_warning(hot):
    s = hot
    s.host.ok("M112")
    s.passes(5)
    assert s.board.device.fault == ORDER
    assert WARNING.format("the board") not in s.host.heard
    assert ARRIVED not in s.host.heard


def test_no_client_gets_an_old_temperature(hot):
    s = hot
    unplug(s)
    s.passes(1)
    assert s.host.ok("M105")[-1].startswith("ok T:-273.15 /60.00 B:-273.15 /0.00 @:")
    s.host.ok("M112")
    for _ in range(9):
        s.passes(10)
        assert s.host.ok("M105") == [f"ok {UNKNOWN}"]
    temps = json.loads(s.host.ok("M408")[0])["temps"]
    assert (temps["heads"]["current"], temps["bed"]["current"]) == ([-273.1], -273.1)
    plug(s)
    assert measured_c(s)[0] == pytest.approx(s.board.temperature("hotend"), abs=1)
    s.host.ok("M999")
    assert measured_c(s)[0] == pytest.approx(s.board.temperature("hotend"), abs=0.5)


def test_m999_reports_temperatures_as_soon_as_known(hot):
    s = hot
    break_link(s, 1.0)
    s.host.expect("The board is back", 10)
    s.passes(0.5)
    told = re.match(r"ok T:(\S+) /60.00", s.host.ok("M105")[-1])
    assert told and float(told[1]) == pytest.approx(s.board.temperature("hotend"), abs=2)


def test_m999_works_after_an_unreachable_board_returns(hot):
    s = hot
    unplug(s)
    s.passes(2)
    s.host.ok("M112")
    s.passes(2)
    assert "cannot be reached" in s.host.ok("M999")[0]
    s.passes(2)
    assert s.board.device.fault == ""
    plug(s)
    assert s.board.device.fault == ORDER
    assert s.printer.state.halted
    s.host.ok("M999")
    assert not s.printer.state.halted
    assert s.board.device.fault == ""


@pytest.mark.parametrize("machine", [FIRMWARE, "i3"])
@pytest.mark.parametrize("stop", ["M112", "fault"])
def test_a_stopped_board_goes_on_measuring(machine, stop):
    with Scenario(machine) as s:
        s.host.ok("G92 X0 Y0 Z0")
        heat(s)
        if stop == "M112":
            s.host.ok("M112")
        else:
            s.printer.stops.halt(MachineError.of("machine.no-power"))
        s.host.expect("Printer halted")
        for _ in range(3):
            s.passes(60)
            heater = s.printer.status.read().heaters["hotend"]
            assert heater.celsius == pytest.approx(s.board.temperature("hotend"), abs=0.5)
            assert (heater.age_s, heater.target_c, heater.power) == (0.0, 0.0, 0.0)
            assert measured_c(s)[0] == pytest.approx(heater.celsius, abs=0.5)
            assert s.board.output_value("hotend") == 0
        assert heater.celsius < 40  # it has cooled


def test_a_halted_printer_shows_that_a_heater_is_stuck():
    with Scenario("i3") as s:
        s.host.ok("G92 X0 Y0 Z0")
        heat(s)
        s.host.ok("M112")
        s.board.force_heater("hotend", 0.5)
        s.passes(60)
        heater = s.printer.status.read().heaters["hotend"]
        assert heater.celsius == pytest.approx(s.board.temperature("hotend"), abs=3)
        assert heater.celsius > 80
        assert heater.fault == "stuck-on"


@pytest.mark.parametrize("stopped", [False, True])
def test_the_last_reading_of_a_silent_board_has_its_age(hot, stopped):
    s = hot
    before = s.printer.status.read().heaters["hotend"]
    unplug(s)
    s.passes(2)
    if stopped:
        s.host.ok("M112")
    for age_s in (30, 60):
        s.passes(30 - 2 * (age_s == 30))
        heater = s.printer.status.read().heaters["hotend"]
        assert (before.age_s, heater.celsius) == (0.0, pytest.approx(before.celsius, abs=0.5))
        assert heater.age_s == pytest.approx(age_s, abs=2)
        assert heater.current_c is None


@pytest.fixture
def two(monkeypatch, tmp_path):
    """The bed is on the main board, and the hotend on the other."""
    hot = {'"D10"': '"tool:D10"', '"T0"': '"tool:T0"', '"D9"': '"tool:D9"'}
    with scenario(monkeypatch, tmp_path, "fast", **hot) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.ok("M190 S40", 300)
        heat(s)
        s.host.send("G1 X100 Z20 F600")
        s.passes(2)
        yield s


def fault(s, board):
    return s.board.boards[board].device.fault


@pytest.mark.parametrize(
    ("lost", "other", "named"), [("tool", MAIN, "board tool"), (MAIN, "tool", "the main board")]
)
def test_each_of_two_boards_stops_when_it_gets_the_command(two, lost, other, named):
    s = two
    s.board.cut_cable(lost)
    s.passes(2)
    s.host.ok("M112")
    s.host.expect("Printer halted", 5)
    s.passes(1)
    assert fault(s, other) == ORDER
    s.passes(20)
    assert fault(s, lost) == ""
    assert s.board.output_value("hotend" if lost == "tool" else "bed") > 0
    assert s.host.heard.count(WARNING.format(named)) == 1
    hotend_c, bed_c = measured_c(s)
    measured, silent = (bed_c, hotend_c) if lost == "tool" else (hotend_c, bed_c)
    assert measured == pytest.approx(
        s.board.temperature("bed" if lost == "tool" else "hotend"), abs=1
    )
    assert silent == -273.15  # though its port can be opened
    s.board.cut_cable(lost, False)
    s.passes(2)
    assert fault(s, lost) == ORDER
    assert s.host.heard.count(ARRIVED) == 1
    s.host.ok("M999", 30)
    assert not s.printer.state.halted


def test_of_two_boards_only_the_silent_one_has_no_temperature(two):
    s = two
    s.board.cut_cable("tool")
    s.passes(5.0)
    told = re.match(r"ok T:-273.15 /60.00 B:(\S+) /40.00", s.host.ok("M105")[-1])
    assert told and float(told[1]) == pytest.approx(s.board.temperature("bed"), abs=1)


@pytest.mark.parametrize("lost_s", [0.3, 10.0])
def test_heaters_stay_on_while_axes_home(hot, lost_s):
    s = hot
    s.host.send("G28")
    s.passes(1)
    unplug(s)
    live_on(s, lost_s)
    assert s.board.output_value("hotend") > 0
    told = s.host.expect("The machine waits")
    assert told == (
        "echo:The machine waits: the connection to the board has ended. Axes were homing: their"
        " positions are lost. The board keeps warm for a minute: plug it in again, or give up"
        " with M112"
    )
    plug(s, 5)
    assert not s.printer.state.halted
    s.host.expect("the board does not report where it stopped")


def test_after_homing_the_board_keeps_warm_again(hot):
    s = hot
    s.host.ok("G28", 60)
    unplug(s)
    live_on(s, 10)
    s.host.expect("The board stops by itself and keeps warm for a minute")
    assert s.board.output_value("hotend") > 0


def test_halt_during_homing_gives_the_usual_warning(hot):
    s = hot
    s.host.send("G28")
    s.passes(1)
    unplug(s)
    s.passes(0.5)
    s.host.ok("M112")
    live_on(s, 10)
    assert s.board.output_value("hotend") > 0
    assert s.host.heard.count(WARNING.format("the board")) == 1
    live_on(s, 60)
    assert s.board.output_value("hotend") == 0
    assert s.board.device.fault == ""
