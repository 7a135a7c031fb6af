"""Machines whose motors are not their axes, from a console."""

import re

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text


@pytest.fixture
def delta():
    with Scenario("delta") as scenario:
        scenario.host.ok("G28", 60)
        scenario.host.ok("G1 X0 Y0 Z100 F6000")
        scenario.host.ok("M400")
        yield scenario


def axes(s):
    line = s.host.ok("M114")[0].split(" E:")[0]
    return tuple(float(v) for v in re.findall(r":(-?[\d.]+)", line))


def test_a_delta_moves_to_the_position_of_its_formula(delta):
    # Z 100 at the centre: each carriage is sqrt(160² - 81²) = 137.982 mm higher.
    at = delta.positions()
    assert [at[k] for k in "abc"] == pytest.approx([237.982] * 3, abs=0.02)
    assert axes(delta) == (0, 0, 100)


def test_unreachable_delta_target_is_refused(delta):
    before = delta.positions()
    assert "beyond the limit" in delta.host.ok("G1 X80 Y0")[0]
    assert "cannot be reached" in delta.host.ok("G1 X70 Y70")[0]
    delta.passes(1)
    assert axes(delta) == (0, 0, 100)
    assert delta.positions() == before
    assert delta.host.ok("G1 X10 F6000") == ["ok"]
    delta.host.ok("M400")
    assert axes(delta) == (10, 0, 100)


def test_g92_moves_the_zero_of_a_delta_and_not_its_carriages(delta):
    before = delta.positions()
    delta.host.ok("G92 X10 Z50")
    assert axes(delta) == (10, 0, 50)
    delta.host.ok("G1 X10 Y0 Z50 F6000")
    delta.host.ok("M400")
    assert delta.positions() == before


def test_g28_z_of_a_delta_homes_its_carriages(delta):
    delta.host.ok("G28 Z", 60)
    at = delta.positions()
    assert [at[k] for k in "abc"] == pytest.approx([318] * 3, abs=0.02)


def test_a_core_moves_both_belts_for_one_axis():
    with Scenario("corexy") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X40 F6000")
        s.host.ok("M400")
        assert [s.positions()[k] for k in "ab"] == pytest.approx([40, 40], abs=0.03)
        s.host.ok("G1 Y10")
        s.host.ok("M400")
        assert [s.positions()[k] for k in "ab"] == pytest.approx([50, 30], abs=0.03)


def test_two_z_motors_make_the_same_steps():
    with Scenario("big-fish-i3") as s:
        s.host.ok("G28", 60)
        before = [s.board.net_steps(k) for k in ("z", "z1")]
        s.host.ok("G1 Z10 F300")
        s.host.ok("M400", 20)
        made = [abs(s.board.net_steps(k) - b) for k, b in zip(("z", "z1"), before, strict=True)]
        assert made[0] == made[1] > 0
        assert s.positions()["z"] == pytest.approx(s.positions()["z1"], abs=0.01)


def test_an_axis_that_is_not_homed_by_default():
    text = shipped_text("i3").replace("[homing.z]\n", "[homing.z]\nby_default = false\n")
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G28", 60)
        assert s.positions() == {"x": 0.0, "y": 0.0, "z": 20.0, "e": 0.0}
        assert "axis Z is not homed" in s.host.ok("G1 Z1")[0]
        s.host.ok("G28 Z", 60)
        assert s.positions()["z"] == pytest.approx(0, abs=0.01)
