"""M4: the laser's power follows the speed, so that each millimetre gets the same energy."""

from __future__ import annotations

import itertools
import random

import pytest
from tests.support.scenario import Scenario

FULL_S = 1000.0


class Beam:
    """What the laser of a scenario does from now on."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._full = scenario.printer.rig.connection.full_scale("laser")
        self._hz = scenario.machine.board.clock_hz
        scenario.board.trace_output("laser")

    def changes(self) -> list[tuple[float, float]]:
        """Seconds and shares of full power, as the board has set them."""
        changes = self._scenario.board.take_changes("laser")
        return [(clock / self._hz, value / self._full) for clock, value in changes]


def energy_s(changes: list[tuple[float, float]]) -> float:
    """Seconds of full power that all of them make; the last must be off."""
    assert changes[-1][1] == 0.0
    pairs = itertools.pairwise(changes)
    return sum((after[0] - at) * share for (at, share), after in pairs)


@pytest.fixture
def s():
    with Scenario("laser") as scenario:
        scenario.host.ok("G92 X0 Y0 Z0")
        yield scenario


def finish(s: Scenario) -> None:
    s.host.send("M400", "M118 done")
    s.host.expect("done", 60)
    s.passes(0.2)


def test_each_millimetre_gets_the_same_energy(s):
    """40 mm at 6000 mm/min and S500: 0.4 s of half power, ramps and corners included."""
    beam = Beam(s)
    s.host.send("M4 S500", "G1 X10 F6000", "G1 Y10", "G1 X0", "G1 Y0")
    finish(s)
    changes = beam.changes()
    assert energy_s(changes) == pytest.approx(0.4 * 0.5, rel=0.005)
    assert max(share for _, share in changes) == pytest.approx(0.5, abs=0.005)
    assert changes[-1][0] - changes[0][0] > 0.43  # it had to slow down at the corners


def test_laser_is_off_at_rest_on_travel_and_after_m5(s):
    beam = Beam(s)
    s.host.send("M4 S1000", "G4 P500", "G1 X10 F3000", "G0 X20", "G4 P500", "M5", "G1 X30")
    finish(s)
    changes = beam.changes()
    assert energy_s(changes) == pytest.approx(10 / 50, rel=0.01)
    lit = [at for at, share in changes if share > 0]
    assert changes[-1][0] - lit[0] < 0.3


def test_half_the_speed_is_half_the_power_and_the_same_energy(s):
    beam = Beam(s)
    s.host.ok("M220 S50")
    s.host.send("M4 S800", "G1 X20 F3000")
    finish(s)
    changes = beam.changes()
    assert max(share for _, share in changes) == pytest.approx(0.4, abs=0.005)
    assert energy_s(changes) == pytest.approx(20 / 50 * 0.8, rel=0.005)


def test_at_twice_the_speed_it_has_no_more_than_full_power(s):
    beam = Beam(s)
    s.host.ok("M220 S200")
    s.host.send("M4 S800", "G1 X20 F3000")
    finish(s)
    assert max(share for _, share in beam.changes()) == 1.0


def test_m3_after_m4_stays_as_set(s):
    beam = Beam(s)
    s.host.send("M4 S1000", "G1 X10 F3000", "M3 S250", "G1 X20", "G1 X30")
    finish(s)
    changes = beam.changes()
    assert changes[-1][1] == pytest.approx(0.25, abs=0.005)
    s.host.send("M5")
    finish(s)
    assert s.board.output_value("laser") == 0


@pytest.mark.parametrize("seed", range(6))
def test_disturbed_print_has_the_same_laser_energy(s, seed):
    """Other feed rates from the very place where the board is, at random moments."""
    chance = random.Random(seed)
    beam = Beam(s)
    s.host.send("M4 S600")
    for i in range(12):
        s.host.send(f"G1 X{10 * (i % 2)} Y{i} F3000")
        if i % 4 == 3:
            s.host.send("M3 S0", "G1 X40", "G1 X0", "M4 S600")
    for _ in range(5):
        s.passes(chance.uniform(0.05, 0.8))
        s.host.send(f"M220 S{chance.choice((50, 80, 100, 130))}")
    s.host.send("M5")
    finish(s)
    changes = beam.changes()
    assert changes[-1][1] == 0.0
    lengths = 0.0
    x = y = 0.0
    for i in range(12):
        to = (10.0 * (i % 2), float(i))
        lengths += ((to[0] - x) ** 2 + (to[1] - y) ** 2) ** 0.5
        x, y = (0.0, to[1]) if i % 4 == 3 else to
    assert energy_s(changes) == pytest.approx(lengths / 50 * 0.6, rel=0.01)


@pytest.mark.parametrize("seed", range(3))
def test_disturbances_leave_m3_unchanged(s, seed):
    chance = random.Random(seed)
    s.host.send("M4 S600", "G1 X5 F3000", "M3 S200")
    s.host.send(*(f"G1 X{10 * (i % 2)} Y{i} F3000" for i in range(12)), "M5")
    s.passes(0.6)
    beam = Beam(s)
    for _ in range(4):
        s.passes(chance.uniform(0.05, 0.5))
        s.host.send(f"M220 S{chance.choice((50, 80, 100, 130))}")
    finish(s)
    assert [share for _, share in beam.changes()] == [0.0]


@pytest.mark.parametrize("stop", ["M410", "M25"])
def test_stop_turns_the_laser_off(tmp_path, stop):
    """M3 is for a head that moves: one that was stopped would burn a hole."""
    (tmp_path / "a.gco").write_text("G92 X0 Y0 Z0\nM3 S400\nG1 X200 F3000\nM3 S800\nG1 X0\nM5\n")
    with Scenario("laser", card=str(tmp_path)) as s:
        s.host.ok("M23 a.gco")
        s.host.ok("M24")
        s.passes(2.0)
        lit = s.board.output_value("laser") / s.printer.rig.connection.full_scale("laser")
        assert lit == pytest.approx(0.4, abs=0.005)
        s.host.send(stop)
        s.passes(3.0)
        assert s.printer.rig.queue.standing
        assert s.board.output_value("laser") == 0
        if stop == "M25":
            beam = Beam(s)
            s.host.send("M24")
            s.passes(12.0)
            shares = [share for _, share in beam.changes()]
            assert shares == pytest.approx([0.4, 0.8, 0.0], abs=0.005)


def test_a_print_that_is_cancelled_leaves_no_power_for_jogging(tmp_path):
    (tmp_path / "a.gco").write_text("G92 X0 Y0 Z0\nM4 S400\nG1 X200 F3000\nG1 X0\nM5\n")
    with Scenario("laser", card=str(tmp_path)) as s:
        s.host.ok("M23 a.gco")
        s.host.ok("M24")
        s.passes(2.0)
        s.host.ok("M524")
        s.passes(1.0)
        beam = Beam(s)
        s.host.send("G91", "G1 X5 F3000")
        finish(s)
        assert beam.changes() == []


def test_a_laser_needs_its_host(s):
    """It is told its power again and again; when nobody does so, the board switches it off."""
    s.host.ok("M3 S500")
    s.host.ok("G4 S30")
    s.passes(20.0)
    assert s.printer.state.halted == ""
    lit = s.board.output_value("laser") / s.printer.rig.connection.full_scale("laser")
    assert lit == pytest.approx(0.5, abs=0.005)
    device = s.board.device
    device.poll(device.now + 4 * s.machine.board.clock_hz)  # and no word of the host
    assert device.fault == "Missed scheduling of next hard pwm event"
    assert s.board.output_value("laser") == 0
