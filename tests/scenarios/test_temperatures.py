"""Heaters and fans as hosts and slicers use them."""

import re

import pytest
from tests.support.scenario import Host, Scenario

from passo import config


@pytest.fixture
def two():
    with Scenario("dual-extruder") as scenario:
        yield scenario


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


def target(s, name="hotend"):
    return s.printer.rig.connection.heaters[name].target


def test_m105_reports_every_heater_in_one_line(two):
    number = r"-?\d+\.\d\d"
    heater = rf":{number} /{number}"
    line = rf"ok T{heater} T0{heater} T1{heater} B{heater} @:\d+ @0:\d+ @1:\d+ B@:\d+"
    assert re.fullmatch(line, *two.host.ok("M105"))
    two.host.ok("M104 T1 S60 F")
    (told,) = two.host.ok("M105")
    assert "T0:25.04 /0.00" in told
    assert "T1:25.04 /60.00" in told
    two.host.ok("T1")
    assert re.match(rf"ok T:{number} /60.00 T0", two.host.ok("M105")[0])  # T: the active tool


def test_m105_x_adds_the_raw_readings(two):
    (told,) = two.host.ok("M105 X")
    plain, readings = two.host.ok("M105")[0], told.split()[-3:]
    assert told.split(" T0A:")[0] == plain
    raw = {word: float(value) for word, value in (r.split(":") for r in readings)}
    assert list(raw) == ["T0A", "T1A", "BA"]
    assert raw["T0A"] == raw["T1A"]
    heater = two.printer.rig.connection.heaters["hotend"]
    assert 0.9 < heater.fraction < 1  # a thermistor of 100 kOhm above 4.7 kOhm at 25 degrees
    assert raw["T0A"] == round(heater.fraction, 4)
    two.host.ok("M109 T1 S100", 200)
    hot = dict(r.split(":") for r in two.host.ok("M105 X0")[0].split()[-3:])
    assert float(hot["T1A"]) < 0.8 < float(hot["T0A"])


def test_m109_p_names_a_heater_like_t(two):
    two.host.ok("M104 P1 S50 F")
    assert target(two, "hotend1") == 50
    two.host.ok("M104 T0 P1 S40 F")  # T first
    assert (target(two), target(two, "hotend1")) == (40, 50)


def test_m116_waits_for_all_heaters_of_one_line(two):
    two.host.ok("M104 T0 S40 F")
    two.host.ok("M104 T1 S90 F")
    two.host.ok("M116 T0 T1", 300)
    assert two.printer.rig.connection.heaters["hotend1"].celsius == pytest.approx(90, abs=1.1)
    two.host.ok("M140 S35 F")
    two.host.ok("M116", 300)
    assert two.printer.rig.connection.heaters["bed"].celsius == pytest.approx(35, abs=1.1)
    for wrong in ("M116 T-1", "M116 B0 C0", "M116 T0 T2"):
        assert "there is no" in two.host.ok(wrong)[0]


def test_each_tool_keeps_its_own_temperature(two):
    two.host.ok("M104 S50 F")
    two.host.ok("T1")
    two.host.ok("M104 S70 F")
    assert (target(two), target(two, "hotend1")) == (50, 70)


def test_another_console_may_query_and_set_while_one_waits(s):
    s.host.send("M109 S200")
    s.passes(3)
    other = Host(s)
    assert "/200.00" in other.ok("M105")[0]
    other.send("M140 S40")  # in its turn
    s.passes(5)
    assert target(s, "bed") == 0
    s.host.expect("^ok", 300)
    s.passes(1)
    assert target(s, "bed") == 40


@pytest.mark.parametrize("waits", ["M109 S200", "M0", "G28", "M303 H0 S200", "G4 S60\nM400"])
def test_m104_f_acts_while_another_console_moves(s, waits):
    s.host.send("M104 S200", *waits.split("\n"))
    s.passes(1.5)
    assert s.printer.motion_lock.locked
    other = Host(s)
    before = s.printer.rig.connection.now
    assert other.ok("M140 S40 F") == ["ok"]
    assert other.ok("m104 F S0") == ["ok"]
    assert "switched off: 2000 C" in other.ok("M140 S2000 F")[0]
    assert "expected 0" in other.ok("M106 P7 F")[0]
    assert other.ok("M106 F S128.0") == ["ok"]
    assert s.printer.rig.connection.now == before
    assert (target(s), target(s, "bed")) == (0, 0)
    s.passes(0.5)
    assert s.board.output_value("part") > 0
    if s.printer.motion_lock.locked:  # else the wait was for this heater
        other.send("M104 S50 F5")
        other.send("M104 S60 (Fan)", "M104 S70 F G4 P1")  # in their turn, too
        s.passes(0.2)
        assert target(s) == 0
    s.host.send("M108", "M118 done")
    s.host.expect("^done$", 60)
    if waits == "G28":
        assert s.positions()["x"] == pytest.approx(0, abs=0.01)


@pytest.mark.parametrize("celsius", [0, 150])
def test_a_target_that_is_set_in_a_tune_ends_the_tune_and_holds(s, celsius):
    other = Host(s)
    s.host.send("M303 E0 S200 C3")
    s.passes(20)
    assert target(s) == 200
    other.ok(f"M104 S{celsius} F")
    s.host.expect("^ok", 1)
    s.passes(1)
    assert target(s) == celsius


def test_wait_reports_that_it_heats(s):
    s.host.send("M190 S45")
    s.host.expect("^echo:busy: heating$", 3)
    s.host.expect("^ok$", 300)
    assert s.printer.rig.connection.heaters["bed"].celsius == pytest.approx(45, abs=1.1)


@pytest.mark.parametrize(("line", "share"), [("M106", 1.0), ("M106 S128", 0.5), ("M106 S999", 1.0)])
def test_m106_sets_the_fan_and_m107_stops_it(s, line, share):
    s.host.ok("M106 S255")
    s.passes(1)
    full = s.board.output_value("part")
    assert full > 0
    s.host.ok("M107")
    s.passes(1)
    assert s.board.output_value("part") == 0
    s.host.ok(line)
    s.passes(1)
    assert s.board.output_value("part") == pytest.approx(share * full, rel=0.01)


def test_a_fan_acts_in_its_place_among_the_moves(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("G1 X30 F600", "M106 S255")
    assert s.until(lambda: s.board.output_value("part") > 0, 10)
    assert s.positions()["x"] == pytest.approx(50, abs=0.15)


def test_m106_f_acts_during_planned_moves(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.ok("G1 X15 F600")
    s.host.ok("M106 S100")  # in its place: when X is at 15
    s.host.ok("G1 X18")
    s.passes(0.3)
    s.board.trace_output("part")
    asked = s.printer.rig.connection.now
    s.host.ok("M106 S255 F")
    s.passes(0.5)
    s.host.ok("M107F")
    s.host.ok("M400", 20)
    clocks, values = zip(*s.board.take_changes("part"), strict=True)
    assert [round(v / values[0] * 255) for v in values] == [255, 0, 100]
    hz = s.printer.rig.connection.board.clock_hz
    assert 0.15 < (clocks[0] - asked) / hz < 0.22  # behind the horizon, at the end of a PWM cycle
    assert (clocks[1] - clocks[0]) / hz == pytest.approx(0.5, abs=0.02)
    assert (clocks[2] - asked) / hz > 1.3
    assert s.positions()["x"] == 38


def test_a_fan_that_is_not_there_is_named(s):
    for line in ("M106 P5 S255", "M107 P5"):
        assert s.host.ok(line)[0].startswith("echo:P is 5: expected 0."), line
    with Scenario("cnc") as cnc:
        assert cnc.host.ok("M106 S255") == ["ok"]  # no fan at all, none named


def test_filament_is_guarded_by_the_hotend_of_its_tool(two):
    two.host.ok("G92 X0 Y0 Z0 E0")
    two.host.ok("M104 T0 S200 F")
    two.host.ok("M116 T0", 300)
    assert two.host.ok("G1 E1 F600") == ["ok"]
    two.host.ok("T1")
    assert "cold extrusion prevented" in two.host.ok("G1 E2 F600")[0]
    two.host.ok("M302 P1")
    assert two.host.ok("G1 E2 F600") == ["ok"]


def test_cold_filament_is_allowed_to_one_tool_alone(two):
    two.host.ok("G92 X0 Y0 Z0 E0")
    two.host.ok("M302 T1 P1")
    assert "cold extrusion prevented" in two.host.ok("G1 E1 F600")[0]
    for line, state in (
        ("M302", "disabled (min temp 170C), but enabled for hotend1"),
        ("M302 T0", "disabled (min temp 170C)"),
        ("M302 T1", "enabled (min temp 170C)"),
    ):
        assert two.host.ok(line)[0] == f"echo:Cold extrudes are {state}"
    stored = [line for line in two.host.ok("M503") if "M302" in line]
    assert stored == ["M302 S170 P0", "M302 T1 P1"]
    two.host.ok("T1")
    assert two.host.ok("G1 E2 F600") == ["ok"]
    two.host.ok("M302 P0")
    assert "cold extrusion prevented" in two.host.ok("G1 E3 F600")[0]
    assert two.host.ok("M302 T1 S0")[0].startswith("echo:S is 0: expected no S with T: ")
    assert "cold extrusion prevented" in two.host.ok("G1 E3 F600")[0]
    assert two.host.ok("M302 T5 P1")[0].startswith("echo:there is no hotend with number 5")
    assert "cold extrusion prevented" in two.host.ok("G1 E3 F600")[0]


@pytest.mark.parametrize("share", [0.0, 1.0, "erratic"])
def test_reading_of_a_broken_sensor_does_not_allow_extrusion(share):
    text = config.shipped_text("i3")
    text = text.replace("max_c = 285.0\n", 'max_c = 285.0\non_fault = "heater"\n', 1)
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G92 E0")
        before = s.positions()["e"]
        if share == "erratic":
            s.host.ok("M109 S230", 300)
            s.board.add_noise("hotend", 0.05)
        else:
            s.board.force_sensor("hotend", share)
        s.host.expect("heater hotend was switched off", 10)
        assert "cold extrusion prevented" in s.host.ok("G1 E10 F600")[0]
        assert s.positions()["e"] == before


def test_a_heater_that_is_off_is_not_waited_for(s):
    s.host.ok("M109 S0", 5)
    s.host.ok("M116 T0 B0", 5)
    s.host.ok("M190", 5)


def test_settings_below_zero_do_not_open_the_guards(s):
    assert "S is -4" in s.host.ok("M302 S-4")[0]
    assert s.host.ok("M302")[0] == "echo:Cold extrudes are disabled (min temp 170C)"
    s.host.ok("M145 S0 H-5 B-5 F-5")
    assert s.host.ok("M145")[0] == "M145 S0 H0 B0 F0"


def test_a_target_with_an_exponent_is_one_number():
    with Scenario("i3") as s:
        s.host.ok("M104 S2.1e2")
        s.passes(1)
        assert s.printer.rig.connection.heaters["hotend"].target == 210
        assert "more than one S" in s.host.ok("M104 S200 S220")[0]
        assert s.printer.rig.connection.heaters["hotend"].target == 210
