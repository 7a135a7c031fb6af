"""APrinter's words of a laser: energy of a move, energy of each millimetre from now on."""

from __future__ import annotations

import pytest
from tests.printer.test_laser import Beam, energy_s, finish
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text

FULL_W = 5.0
WORDS = f'[laser]\nenergy_letter = "L"\ndensity_letter = "M"\npower_w = {FULL_W}\nmax_power_w = 4\n'


@pytest.fixture(params=["deviation", "cornering_distance"])
def s(request):
    text = shipped_text("laser").replace("[laser]\n", WORDS)
    machine = config.load_text(text.replace('"deviation"', f'"{request.param}"'))
    with Scenario(machine) as scenario:
        scenario.host.ok("G92 X0 Y0 Z0")
        yield scenario


def burned(s, *lines):
    """W·s that these lines give, and the greatest share of full power."""
    beam = Beam(s)
    s.host.send(*lines)
    finish(s)
    changes = beam.changes()
    if not changes:
        return 0.0, 0.0
    return FULL_W * energy_s(changes), max(share for _, share in changes)


def test_a_move_gets_its_energy(s):
    energy, most = burned(s, "G1 X30 Y40 F3000 L1", "G1 X0 Y0")
    assert energy == pytest.approx(1.0, rel=0.005)
    assert most == pytest.approx(1.0 / FULL_W, abs=0.005)  # 1 s at 50 mm/s


@pytest.mark.parametrize("percent", [50, 100, 300])
def test_a_density_holds_until_another_one(s, percent):
    """Whatever the speed; not on G0, and not on the move that has an energy of its own."""
    s.host.ok(f"M220 S{percent}")
    lines = [
        "G1 X20 F1500 M0.05",
        "G1 Y10",
        "G0 X0",
        "G1 X10 L0.1",
        "G3 X20 Y20 I0 J10",
        "G1 X0 M0",
    ]
    energy, most = burned(s, *lines, "G1 X0 M0", "G1 X20")
    arc = 10 * 3.141592653589793 / 2
    assert energy == pytest.approx(0.05 * (30 + arc) + 0.1, rel=0.005)
    assert most <= 0.8


def test_no_move_is_faster_than_it_gets_its_energy(s):
    """20 W·s with 4 W take 5 s, also at twice the speed."""
    s.host.ok("M220 S200")
    start = s.loop.time()
    energy, most = burned(s, "G1 X50 F6000 L20")
    assert s.loop.time() - start == pytest.approx(5.4, abs=0.3)
    assert energy == pytest.approx(20, rel=0.005)
    assert most == pytest.approx(0.8, abs=0.002)


@pytest.mark.parametrize(
    ("line", "seconds", "ws"), [("G4 P500 L1", 0.5, 1), ("G4 S1 L8", 2, 8), ("G4 L2", 0.5, 2)]
)
def test_a_dwell_fires_at_rest(s, line, seconds, ws):
    start = s.loop.time()
    energy, _ = burned(s, line)
    assert energy == pytest.approx(ws, rel=0.002)
    assert s.loop.time() - start == pytest.approx(seconds + 0.4, abs=0.25)


@pytest.mark.parametrize("line", ["X20 F1500 M0.1", "X20 M0.1 F1500", "G90 X20 F1500 M0.1"])
def test_a_density_counts_on_a_line_without_g1_too(s, line):
    energy, _ = burned(s, "G1 F1500", line)
    assert energy == pytest.approx(2.0, rel=0.005)


def test_a_dwell_of_too_much_energy_is_refused(s):
    answer, _ = s.host.ok("G4 P1 L900000000")
    assert answer.startswith("echo:L is 9e+08: expected 0 to ")


@pytest.mark.parametrize("end", ["M5", "M410"])
def test_laser_off_resets_power_per_mm(s, end):
    s.host.send("G1 X40 F600 M0.1")
    s.passes(1)
    s.host.send(end)
    finish(s)
    assert burned(s, "G1 Y20 F3000") == (0.0, 0.0)


def test_laser_is_off_in_a_pause_and_energy_stays(s):
    beam = Beam(s)
    s.host.send("G1 X40 F600 M0.1")
    s.passes(1)

    async def act(action):
        action()

    s.run(act(s.printer.rig.queue.hold))
    s.passes(2)
    assert s.board.output_value("laser") == 0
    s.run(act(s.printer.rig.queue.before_moves))
    s.run(act(s.printer.rig.job.stops.release))
    s.run(act(s.printer.rig.queue.after_moves))
    finish(s)
    assert FULL_W * energy_s(beam.changes()) == pytest.approx(4.0, rel=0.01)
