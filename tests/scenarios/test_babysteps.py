"""Babysteps: what is still to come shifts, in mid-move, and the program does not notice."""

import re

import pytest
from tests.support.scenario import Scenario


@pytest.fixture(params=["i3", "delta"])
def s(request):
    with Scenario(request.param) as scenario:
        scenario.host.ok("G28", 60)
        scenario.host.ok("G1 X-40 Y0 Z50 F6000" if request.param == "delta" else "G1 X50 Y50 Z50")
        scenario.host.ok("M400", 60)
        yield scenario


def height(s):
    """Of the nozzle, by the mechanics."""
    at = s.positions()
    if "z" in at:
        return at["z"]
    return s.machine.geometry.forward((at["a"], at["b"], at["c"]))[2]


def logical_z(s):
    return float(re.search(r"Z:([-\d.]+)", s.host.ok("M114")[0])[1])


def test_a_long_move_takes_a_babystep_while_it_runs(s):
    s.host.ok("G91")
    s.host.ok("G1 X60 F600")
    s.passes(2)
    s.host.ok("M290 Z-0.2")
    s.passes(1.5)
    assert height(s) == pytest.approx(49.8, abs=0.02)
    assert not s.printer.rig.queue.standing
    s.host.ok("M400")
    assert logical_z(s) == 50
    s.host.ok("G1 Z1 F600")
    s.host.ok("M400")
    assert height(s) == pytest.approx(50.8, abs=0.02)


def test_babystep_at_standstill_moves_the_axis(s):
    s.host.ok("M290 Z0.3")
    s.passes(1)
    assert height(s) == pytest.approx(50.3, abs=0.02)
    assert logical_z(s) == 50
    s.host.ok("M290 S-0.3")
    s.passes(1)
    assert height(s) == pytest.approx(50.0, abs=0.02)


def test_babystep_out_of_range_is_refused(s):
    s.host.ok("G1 Z0.1 F600")
    s.host.ok("G1 Z5")
    assert "beyond the limit" in s.host.ok("M290 Z-0.2")[0]
    s.host.ok("M400", 60)
    assert height(s) == pytest.approx(5.0, abs=0.02)


def test_babystep_of_unhomed_axis_is_refused():
    with Scenario("i3") as s:
        before = s.positions()
        assert "axis Z is not homed" in s.host.ok("M290 Z0.2")[0]
        s.passes(1)
        assert s.positions() == before


def test_m290_in_a_program_acts_in_order(tmp_path):
    (tmp_path / "a.g").write_text("G28\nG1 X50 Y50 Z5 F6000\nM290 Z0.2\nG1 X60\nG1 Z6\n")
    with Scenario("i3", card=str(tmp_path)) as s:
        s.host.ok("M32 a.g")
        s.host.expect("Done printing", 120)
        assert s.positions()["z"] == 6.2
