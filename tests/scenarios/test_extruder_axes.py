"""APrinter's way without tools: each extruder is an axis with a letter of its own."""

import re

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError

EXTRUDERS = """
[steppers.u]
steps_per_mm = 95.5
socket = "E0"

[steppers.v]
steps_per_mm = 95.5
socket = "E1"

[axes.u]
extruder = true
heater = "hotend"
speed_mm_s = 50.0
accel_mm_s2 = 2000.0

[axes.v]
extruder = true
speed_mm_s = 50.0
accel_mm_s2 = 2000.0
"""


def text():
    """The i3 with U and V instead of its extruder."""
    shipped = shipped_text("i3")
    for part in ("steppers", "extruders"):
        shipped = re.sub(rf"\[{part}\.e\]\n(.+\n)+", "", shipped)
    return shipped + EXTRUDERS


@pytest.fixture
def s():
    with Scenario(config.load_text(text(), "t.toml")) as scenario:
        scenario.host.ok("M302 P1")
        scenario.host.ok("G92 X0 Y0 Z0 U0 V0")
        yield scenario


def pushed(s, *lines):
    """What U and V have made once these lines are done, mm."""
    for line in lines:
        assert not any("rror" in answer for answer in s.host.ok(line, 60))
    s.host.ok("M400", 60)
    at = s.positions()
    return at["u"], at["v"]


def test_filament_has_no_limits(s):
    assert pushed(s, "G1 U-40 V900 F6000") == pytest.approx((-40, 900), abs=0.02)


@pytest.mark.parametrize(
    ("modes", "u", "x"),
    [("G90 M82", 2, 5), ("G90 M83", 3, 5), ("G91 M82", 3, 15), ("G91 M83", 3, 15)],
)
def test_m82_and_m83_apply_to_extruder_axes_only(s, modes, u, x):
    made = pushed(s, "G1 X10 U1 V1 F6000", *modes.split(), "G1 X5 U2 V2")
    assert made == pytest.approx((u, u), abs=0.02)
    assert s.positions()["x"] == pytest.approx(20 + x, abs=0.02)


def test_g92_sets_the_programs_zero(s):
    assert pushed(s, "G1 U5 F600", "G92 U0", "G1 U1")[0] == pytest.approx(6, abs=0.02)
    assert "U:1.000 V:0.000" in s.host.ok("M114")[0]


def test_cold_filament_does_not_move(s):
    s.host.ok("M302 P0")
    for line in ("G1 U1 F600", "G1 X1 V1"):
        assert "cold extrusion prevented" in s.host.ok(line)[0]
    assert pushed(s, "G1 X1") == (0, 0)
    s.host.ok("M109 S200", 600)
    assert pushed(s, "G1 X2 U1 V1") == pytest.approx((1, 1), abs=0.02)


def test_homing_does_not_change_extruder_axes(s):
    made = pushed(s, "G1 U3 V4 F600", "G28")
    assert made == pytest.approx((3, 4), abs=0.02)
    assert "U:3.000 V:4.000" in s.host.ok("M114")[0]
    assert pushed(s, "G1 U4") == pytest.approx((4, 4), abs=0.02)


def test_the_first_tool_is_selected_without_tools(s):
    assert s.host.ok("T0") == ["ok"]
    assert "tool T1 does not exist" in s.host.ok("T1")[0]
    assert pushed(s, "T0", "G1 U1 F600")[0] == pytest.approx(1, abs=0.02)


def test_filament_alone_retracts_by_the_retract_acceleration(s):
    s.host.ok("M204 R100")
    start = s.loop.time()
    pushed(s, "G1 U10 F3000")  # 31.6 mm/s at most: 0.63 s
    assert s.loop.time() - start > 0.6


def test_settings_of_extruder_axes_are_reported(s):
    assert "U:" not in s.host.ok("M122")[0]
    assert s.host.ok("M206")[0] == "M206 X0 Y0 Z0"
    assert "U95.5 V95.5" in s.host.ok("M92")[0]
    assert s.host.ok("M221 S50") == ["ok"]  # there is no tool whose flow that would be


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('heater = "hotend"', 'heater = "hotent"', "hotend"),
        ("[axes.v]\nextruder = true", "[axes.v]\nextruder = true\nmax_mm = 5.0", "no limits"),
        ("[axes.v]\nextruder = true", "[axes.v]", "max_mm"),
        ("[axes.x]\n", "[axes.x]\nextruder = true\n", "a further axis"),
        ("[axes.x]\n", '[axes.x]\nheater = "bed"\n', "not an extruder"),
        ("[homing.x]\n", '[homing.v]\npin = "^X_MAX"\n[homing.x]\n', "no home"),
    ],
)
def test_a_machine_file_says_it_right(old, new, said):
    assert old in text()
    with pytest.raises(ConfigError, match=said):
        config.load_text(text().replace(old, new, 1), "t.toml")
