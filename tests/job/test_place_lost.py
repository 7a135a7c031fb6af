"""The board is back, but where its motors stand cannot be proved: the printer keeps warm and says
so, and the print goes on once its axes are home."""

from contextlib import contextmanager

import pytest
from tests.job.test_lost_link import FIRMWARE, break_link
from tests.support.disturbed_prints import reset, spiral
from tests.support.scenario import Scenario

from passo.errors import MachineError


@pytest.fixture
def printing(tmp_path):
    card, state = tmp_path / "card", tmp_path / "state"
    card.mkdir()
    (card / "a.g").write_text("M104 S60\n" + spiral())
    with Scenario(FIRMWARE, card=str(card), state=str(state)) as s:
        s.host.ok("M302 P1")
        s.host.ok("M32 a.g")
        assert s.until(lambda: s.positions()["z"] > 0.6 and s.printer.rig.job.clock > 0, 200)
        s.passes(20)
        yield s


def goes_on(s):
    """It has said so, is warm, refuses to move, and goes on with the print from the journal."""
    assert s.printer.state.halted == ""
    assert "// action:pause" in s.host.heard
    assert s.printer.rig.connection.heaters["hotend"].target == 60.0
    assert any("was interrupted" in line for line in s.host.heard)
    refused = s.host.ok("G1 X50")
    assert "axis X is not homed" in refused[0]
    assert "from line" in s.host.ok("M1000", 600)[-2]
    s.host.expect("Done printing", 900)


@contextmanager
def turned_by_hand(s, monkeypatch):
    """As the board tells, X has made five steps that nobody has ordered."""
    positions = type(s.printer.rig.positions)
    real = positions.counts

    def counts(*given):
        return {name: count + 5 * (name == "x") for name, count in real(*given).items()}

    with monkeypatch.context() as patch:
        patch.setattr(positions, "counts", counts)
        yield patch


def test_a_motor_that_was_turned_by_hand(printing, monkeypatch):
    s = printing
    with turned_by_hand(s, monkeypatch):
        break_link(s, 2.0)
        s.host.expect("motor x stopped at", 10)
    s.host.expect("The printer is ready again", 10)
    s.passes(1)
    goes_on(s)


def test_a_board_that_was_reset_without_being_connected(printing):
    s = printing
    port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
    port.unplug()
    s.passes(1)
    reset(s)
    s.passes(1)
    port.plug(queue.base + queue.now)
    s.board.device.poll(queue.base + queue.now)
    s.host.expect("restarted", 10)
    s.host.expect("The printer is ready again", 10)
    s.passes(1)
    goes_on(s)


def test_a_board_that_has_shut_down_halts_the_printer_cold(printing):
    s = printing
    port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
    port.unplug()
    s.passes(0.5)
    s.board.force_sensor("hotend", 1.0)  # the cable of the sensor breaks as well
    s.passes(4)
    port.plug(queue.base + queue.now)
    s.board.device.poll(queue.base + queue.now)
    s.host.expect("Printer halted: the board shut down: ADC out of range", 10)
    assert s.printer.rig.connection.heaters["hotend"].target == 0.0
    assert "// action:pause" not in s.host.heard


def test_a_board_that_cannot_be_reached_again_is_switched_off(printing, monkeypatch):
    """What it keeps warm would wait for nobody."""
    s = printing

    def gone(_):
        raise MachineError.of("machine.program", value="no board")

    monkeypatch.setattr("passo.printer.printer.reconnected", gone)
    with turned_by_hand(s, monkeypatch):
        break_link(s, 2.0)
        s.host.expect("Then send M999 again", 10)
    s.passes(1)
    assert s.board.device.fault == "Command request"
    assert s.board.output_value("hotend") == 0
    monkeypatch.undo()
    s.host.send("M999")
    s.host.expect("ready again", 5)


def test_m112_during_pause_for_lost_position_halts(printing, monkeypatch):
    s = printing
    tell = s.printer.state.tell

    def panic(text):
        tell(text)
        if text == "// action:pause":
            s.printer.stops.emergency_stop()

    with turned_by_hand(s, monkeypatch) as patch:
        patch.setattr(s.printer.state, "tell", panic)
        break_link(s, 2.0)
        s.host.expect("Make the printer safe, then send M999", 10)
    s.passes(5)
    assert s.printer.state.halted
    assert s.printer.rig.connection.heaters["hotend"].target == 0.0
    s.host.send("M999")
    s.host.expect("ready again", 5)
    s.passes(1)
    assert s.printer.rig.connection.heaters["hotend"].target == 0.0
