"""The link to a board breaks in mid-print, again and again: the print ends where it would have."""

import random

import pytest
from tests.support.disturbed_prints import spiral, steps, undisturbed
from tests.support.scenario import Scenario

from passo import config
from passo.errors import MachineError

I3 = config.load("i3")
FIRMWARE = I3.model_copy(update={"board": I3.board.model_copy(update={"firmware": "passo"})})
_LASER = config.load("laser")
LASER = _LASER.model_copy(update={"board": _LASER.board.model_copy(update={"firmware": "passo"})})


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("card"), FIRMWARE)


def break_link(s, seconds):
    """The cable is out for so long."""
    port, queue = s.printer.rig.connection.main.port, s.printer.rig.queue
    port.unplug()
    s.passes(seconds)
    port.plug(queue.base + queue.now)
    s.board.device.poll(queue.base + queue.now)


def test_print_with_link_losses_ends_at_same_steps(whole):
    """One example; test_disturbances.py makes many."""
    card, wanted = whole
    generator = random.Random(1)
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M120")  # switches are queried during the print, too
        s.host.ok("M32 a.g")
        s.passes(14)  # it is at home by then
        breaks = 0
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            if "Done printing file" in s.host.heard:
                break
            break_link(s, generator.choice((0.02, 0.3, 2.0, 40.0)))
            s.host.expect("The board is back", 10)
            breaks += 1
            assert not s.printer.state.halted
        assert breaks > 3
        assert s.board.device.fault == ""
        assert steps(s) == wanted


def stall(s, seconds):
    """The host stands still for so long, and the link is open."""
    s.printer.rig.connection.main.wire.sleep(
        s.printer.rig.connection.now + int(seconds * I3.board.clock_hz)
    )
    s.passes(seconds)


def test_late_host_resumes_where_board_stopped(whole):
    card, wanted = whole
    generator = random.Random(0)
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(14)
        stops = 0
        while "Done printing file" not in s.host.heard:
            s.passes(generator.expovariate(0.5))
            stall(s, generator.choice((0.05, 0.25, 0.6, 3.0)))
            assert not s.printer.state.halted
            stops = sum("braked to a stop" in line for line in s.host.heard)
        assert stops > 3
        assert s.board.device.fault == ""
        assert steps(s) == wanted


@pytest.mark.parametrize("seconds", [100, 140, 300])
def test_the_boards_clock_is_known_after_a_long_time(seconds):
    """2^31 ticks are 134 s."""
    with Scenario(FIRMWARE) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X50 F1200")
        s.passes(1)
        break_link(s, seconds)
        s.host.send("M400", "M118 done")
        s.host.expect("done", 10)
        assert s.board.net_steps("x") == 4000


def test_motors_are_on_when_the_print_continues():
    """The word that turns them on was on its way when the cable came out."""
    with Scenario(FIRMWARE) as s:
        s.host.ok("G92 X0 Y0 Z0")
        s.printer.rig.connection.main.port.unplug()
        s.passes(0.2)
        s.host.send("G1 X10 F3000", "M118 done")
        s.passes(2)
        off = s.board.output_value("x-enable")
        break_link(s, 0.1)
        s.host.send("M400")
        s.host.expect("done", 10)
        s.passes(1)
        assert s.board.output_value("x-enable") != off
        assert s.board.net_steps("x") == 800


@pytest.mark.parametrize("moment", [0.3 + 0.06 * i for i in range(8)])
def test_homed_motor_moves_during_braking_tail(moment):
    """Its clock must be told anew by the tail itself."""
    with Scenario(FIRMWARE) as s:
        s.host.ok("G28", 60)
        s.host.send("G1 X20 F3000", "G1 X40 Y3 F3000")
        s.passes(moment)
        break_link(s, 1.0)
        s.host.send("M400", "M118 done")
        s.host.expect("done", 10)
        assert not s.printer.state.halted
        before = s.printer.rig.positions.now()[0]
        assert (before["X"], before["Y"]) == pytest.approx((40, 3), abs=0.01)


@pytest.mark.parametrize("code", ["M3", "M4"])
@pytest.mark.parametrize("lost", [stall, break_link])
def test_laser_is_off_until_the_machine_moves(code, lost):
    with Scenario(LASER) as s:
        s.host.ok("G92 X0 Y0")
        s.host.ok(f"{code} S800")
        s.host.send("G1 X100 F600 S800", "M400", "M5", "M118 done")
        s.passes(3)
        assert s.board.output_value("laser") > 0
        lost(s, 0.4)
        stood, seen = s.board.net_steps("x"), []
        while s.board.net_steps("x") == stood:
            seen.append(s.board.output_value("laser"))
            s.passes(0.01)
        # It is on from the start of the move on, and the first step comes a little later.
        assert len(seen) > 10 and set(seen[:-3]) == {0}
        s.passes(0.5)
        assert s.board.output_value("laser") > 0
        s.host.expect("done", 20)
        s.passes(1)
        assert s.board.output_value("laser") == 0


@pytest.mark.parametrize("delay", [0.06, 0.24, 1.0])
def test_link_lost_during_a_pause_resumes_at_same_steps(whole, delay):
    card, wanted = whole
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(20)
        s.host.ok("M25")
        s.passes(delay)
        break_link(s, 0.5)
        s.host.expect("The board is back", 10)
        s.host.ok("M220 S50")
        s.passes(1)
        s.host.ok("M24")
        s.passes(3)
        s.host.ok("M220 S100")
        s.host.expect("Done printing", 900)
        assert s.board.device.fault == ""
        assert steps(s) == wanted


def test_print_waiting_for_heat_can_be_changed_and_paused(whole):
    card, wanted = whole
    with Scenario(FIRMWARE, card=str(card)) as s:
        s.host.ok("M32 a.g")
        s.passes(20)
        s.host.ok("M104 S150")
        s.passes(3)
        break_link(s, 0.5)
        s.host.expect("The board is back", 10)
        assert s.printer.rig.job.stops.holds
        stood = steps(s)
        s.host.ok("M290 Z0.2")
        s.host.ok("M290 X-1.5")
        s.host.ok("M220 S200")
        s.passes(2)
        assert steps(s) == stood
        s.host.ok("M25")
        s.host.ok("M290 Z0.1")
        s.passes(60)
        assert steps(s) == stood
        s.host.ok("M24")
        s.host.expect("Done printing", 900)
        assert s.board.device.fault == ""
        shifted = {"x": wanted["x"] - 120, "z": wanted["z"] + 120}
        assert steps(s) == wanted | shifted


@pytest.mark.parametrize("delay", [0.05, 0.2, 1.0])
def test_laser_that_a_pause_switched_off_is_on_again(tmp_path, delay):
    (tmp_path / "a.g").write_text("G92 X0 Y0\nM3 S800\nG1 X100 F600\nM5\n")
    with Scenario(LASER, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(3)
        assert s.board.output_value("laser") > 0
        s.host.ok("M25")
        s.passes(delay)
        break_link(s, 0.5)
        s.host.expect("The board is back", 10)
        s.passes(1)
        assert s.board.output_value("laser") == 0
        s.host.ok("M24")
        s.passes(2)
        assert s.board.output_value("laser") > 0
        s.host.expect("Done printing", 30)
        assert s.board.output_value("laser") == 0


@pytest.mark.parametrize("policy", ["heater", "job"])
def test_a_heater_that_has_failed_may_stay_so(policy):
    """The board asks for nothing that its sensor cannot say, nor does it after the break."""
    text = config.shipped_text("i3").replace(
        "max_c = 120.0", f'max_c = 120.0\non_fault = "{policy}"'
    )
    with Scenario(config.load_text(f'{text}firmware = "passo"\n')) as s:
        s.host.ok("M140 S60")
        s.host.ok("G92 X0 Y0 Z0")
        s.host.send("G1 X50 F600")
        s.board.force_sensor("bed", 1.0)
        s.host.expect("heater bed was switched off", 5)
        s.host.ok("M108")
        break_link(s, 2.0)
        s.host.expect("The board is back", 10)
        s.passes(20)
        assert s.board.device.fault == "" and not s.printer.state.halted
        assert s.board.net_steps("x") == 4000


@pytest.mark.parametrize("changes", [("M204 P500", "M204 P3000"), ("M290 Z0.5", "M290 Z-0.5")])
@pytest.mark.parametrize("seconds", [0.0, 0.02, 0.05])
def test_limits_changed_just_before_link_loss(tmp_path, changes, seconds):
    """The board has the way to brake by what held before."""
    lines = ["M302 P1", "G92 X0 Y0 Z0 E0", "G1 X100 Y100 F6000"]
    lines += [f"G2 X100 Y100 I-{20 + i} J0 E{i} F9000" for i in range(12)]
    (tmp_path / "a.g").write_text("\n".join([*lines, "G1 X0 Y0 E0"]))
    with Scenario(FIRMWARE, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.passes(3)
        for i in range(8):
            s.host.ok(changes[i % 2])
            s.passes(seconds)
            break_link(s, 0.2)
            s.host.expect("The board is back, at the position where it stopped", 10)
            s.passes(0.8)
        s.host.expect("Done printing", 100)
        assert steps(s) == {"x": 0, "y": 0, "z": 0, "e": 0}


def test_a_board_with_an_older_firmware_is_refused(monkeypatch):
    monkeypatch.setattr("passo.board.firmware_identity._SURVIVE", 3)
    with pytest.raises(MachineError, match="firmware is older than this program"):
        Scenario(FIRMWARE)


@pytest.mark.parametrize("word", ["M104 S0", "M524"])
def test_wait_ends_when_its_heater_is_switched_off(tmp_path, word):
    (tmp_path / "a.g").write_text("M109 S60\n" + spiral())
    with Scenario(FIRMWARE, card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.until(lambda: s.board.steps("x") > 4000, 300)
        break_link(s, 70)  # heat is off for ten seconds
        s.host.expect("The board is back", 10)
        assert s.printer.rig.queue.interrupted
        s.host.send(word)
        s.until(lambda: not s.printer.rig.queue.interrupted, 10)
        assert not s.printer.rig.queue.interrupted
        s.host.send("M400", "M118 stands")
        s.host.expect("stands", 200)
