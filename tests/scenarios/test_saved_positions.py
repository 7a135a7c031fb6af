"""Places that are saved, set and found again: G60, G61, G28 O, G92 of motors, M206."""

import re

import pytest
from tests.support.scenario import Scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        scenario.host.ok("M302 P1")
        scenario.host.ok("G92 X20 Y20 Z20 E0")
        yield scenario


def position(s):
    line = s.host.ok("M114")[0]
    return tuple(float(v) for v in re.findall(r"[XYZE]:(-?[\d.]+)", line.split("Count")[0]))


def test_a_saved_place_is_found_again(s):
    s.host.ok("G1 X50 Y60 Z5 E1 F6000")
    assert s.host.ok("G60 S1")[0] == "Saved position S1<-X:50.00 Y:60.00 Z:5.00 E:1.00"
    s.host.ok("G1 X10 Y10 Z10 E3")
    s.host.ok("G92 X0 Y0")  # the place is the machine's, not the program's
    s.host.ok("G61 S1 X Y5")
    s.host.ok("M400", 60)
    at = s.positions()
    assert (at["x"], at["y"], at["z"]) == (50, 65, 10)
    s.host.ok("G91")
    s.host.ok("G61 S1")
    s.host.ok("M400", 60)
    at = s.positions()
    assert (at["x"], at["y"], at["z"]) == (50, 60, 5)
    assert at["e"] == pytest.approx(3, abs=0.01)
    s.host.ok("G61 S1 E0.5 F300")
    s.host.ok("M400", 60)
    assert s.positions()["e"] == pytest.approx(1.5, abs=0.01)
    assert position(s) == (40, 50, 5, 1.5)


def test_invalid_place_is_refused(s):
    before = s.positions()
    for line, why in (
        ("G61", "no position was saved as S0. Save one with G60 first."),
        ("G60 S2", "S is 2: expected 0 to 1"),
        ("G61 S7", "S is 7: expected 0 to 1"),
    ):
        assert why in s.host.ok(line)[0], line
    s.host.ok("G60")
    assert "beyond the limit" in s.host.ok("G61 X-30")[0]
    s.passes(1)
    assert s.positions() == before


def test_g28_o_homes_axes_that_are_not_homed():
    with Scenario("i3") as s:
        s.host.ok("G28 X", 60)
        s.host.ok("G1 X30 F6000")
        assert s.host.ok("G28 O", 60)[-1] == "ok"
        at = s.positions()
        assert (at["x"], at["y"], at["z"]) == pytest.approx((30, 0, 0), abs=0.02)
        s.host.ok("G1 Y40 Z5")
        start = s.loop.time()
        s.host.ok("G28 O X Y", 60)
        assert s.loop.time() - start < 1.0
        assert s.positions()["y"] == pytest.approx(40, abs=0.02)
        s.host.ok("M18 Y")
        s.host.ok("G28 XYO", 60)
        assert (s.positions()["x"], s.positions()["y"]) == pytest.approx((30, 0), abs=0.02)


def test_g92_sets_motors_of_a_delta():
    with Scenario("delta") as s:
        assert "is not homed" in s.host.ok("G92 A200")[0]
        assert s.host.ok("G92 A200 B200 C200") == ["ok"]
        assert position(s) == (0, 0, pytest.approx(62.0181, abs=1e-3), 0)
        before = s.positions()
        s.host.ok("G1 Z63.0181 F6000")
        s.host.ok("M400")
        assert [s.positions()[k] - before[k] for k in "abc"] == pytest.approx([1] * 3, abs=0.02)
        assert s.host.ok("G92 B202") == ["ok"]
        x, y, z, _ = position(s)
        a, b, c = s.machine.geometry.inverse((x, y, z))
        assert (a, b, c) == pytest.approx((201, 202, 201), abs=1e-3)
        assert "no point belongs to the motor positions" in s.host.ok("G92 A900")[0]
        assert position(s) == (x, y, z, 0)


def test_a_home_offset_beyond_the_axis_is_refused(s):
    axis = s.machine.axes["y"]
    longest = axis.max_mm - axis.min_mm
    assert f"at most the {longest:g} mm of the axis" in s.host.ok(f"M206 Y-{longest + 1}")[0]
    assert s.host.ok("M206 X1 Y-1000")[-1] == "ok"
    assert s.host.ok("M206")[0] == "M206 X0 Y0 Z0"
    assert s.host.ok("M206 Y-2") == ["ok"]
    assert s.host.ok("M206")[0] == "M206 X0 Y-2 Z0"


def test_g92_of_an_axis_that_was_not_homed_counts_with_the_tool():
    with Scenario("dual-extruder") as s:
        x, y, _ = s.printer.rig.job.tools.offsets[1]
        assert x != 0
        s.host.ok("T1")
        s.host.ok("G92 X50 Y20 Z5")
        assert position(s) == (50, 20, 5, 0)
        s.host.ok("G92 X40")  # now it moves the zero
        assert position(s)[0] == 40
        s.host.ok("T0")
        assert position(s) == (40, 20, 5, 0)  # the next move carries out the offset
        s.host.ok("G1 Y20 F6000")
        s.host.ok("M400", 20)
        assert position(s) == (40, 20, 5, 0)
        assert s.printer.rig.job.machine_position[:3] == [50, 20 + y, 5]


@pytest.mark.parametrize(
    ("machine", "home_mm", "limit"),
    [("delta", 318.0, 318.0), ("rotary-delta", -30.0, -30.0)],
)
def test_arms_beyond_limits_by_home_offset_may_only_return(machine, home_mm, limit):
    with Scenario(machine) as s:
        s.host.ok("M206 Z3")
        s.host.ok("G28", 60)
        home = position(s)[2]
        assert s.positions()["a"] == pytest.approx(home_mm, abs=0.01)
        refused = s.host.ok("G1 X20 F6000")[0]
        assert f"beyond its limit of {limit:.3f}" in refused
        s.host.ok("G1 Z40 F6000")
        s.host.ok("M400", 60)
        assert position(s)[2] == 40
        assert abs(s.positions()["a"] - home_mm) > 20
        s.host.ok("G1 X20")
        assert "beyond" in s.host.ok(f"G1 Z{home}")[0]  # it was there, but the limit holds again


@pytest.mark.parametrize("machine", ["delta", "rotary-delta", "scara"])
def test_no_command_puts_the_nozzle_where_no_motors_lead(machine):
    with Scenario(machine) as s:
        before = s.host.ok("M114")
        assert "within reach, but" in s.host.ok("G92 X500 Y500 Z0")[0]
        assert s.host.ok("M114") == before
        assert "is not homed" in s.host.ok("G1 Z5")[0]


def test_motors_are_not_set_to_positions_out_of_reach():
    with Scenario("delta") as s:
        geometry = s.machine.geometry
        wider = geometry.model_copy(update={"limit_radius": 100.0})
        a, b, c = wider.inverse((0, 80, 50))
        assert geometry.forward((a, b, c))[1] == pytest.approx(80)
        before = s.host.ok("M114 D")
        assert "80.000 mm from the middle (limit 75.100 mm)" in s.host.ok(f"G92 A{a} B{b} C{c}")[0]
        assert s.host.ok("M114 D") == before


def test_no_home_offset_puts_the_nozzle_where_no_motors_lead():
    with Scenario("delta") as s:
        assert "a home within reach, but it is 90" in s.host.ok("M206 X90")[0]
        assert s.host.ok("M206 X60") == ["ok"]
        assert "a home within reach, but it is 84" in s.host.ok("M206 Y60")[0]
        assert s.host.ok("M206")[0] == "M206 X60 Y0 Z0"


def test_no_command_puts_an_axis_far_beyond_itself():
    """The way back would be 2,500 km, all steps of which are reckoned at once."""
    with Scenario("i3") as s:
        assert "Z is 2.54e+06: expected -" in s.host.ok("G92 Z2540000")[0]
        assert "is not homed" in s.host.ok("G1 Z5")[0]
        length = s.machine.axes["x"].max_mm - s.machine.axes["x"].min_mm
        assert s.host.ok(f"G92 X{s.machine.axes['x'].max_mm + length}") == ["ok"]
    with Scenario("corexy") as s:
        s.host.ok("G92 Z5")
        assert "X is 500000: expected" in s.host.ok("G92 A1000000 B0")[0]
