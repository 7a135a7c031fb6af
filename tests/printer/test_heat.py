"""Temperatures on a console: set-points, waits, faults and what they stop."""

import re

import pytest
from tests.support.scenario import Scenario

from passo import config
from passo.config.load import shipped_text


@pytest.fixture
def s():
    with Scenario("i3") as scenario:
        yield scenario


def heater(s, name="hotend"):
    return s.printer.rig.connection.heaters[name]


def test_a_wait_ends_when_the_temperature_is_there(s):
    assert s.host.ok("M109 S200", 300)[-1] == "ok"
    assert heater(s).celsius == pytest.approx(200, abs=1.1)
    s.passes(60)
    assert heater(s).celsius == pytest.approx(200, abs=0.5)


def test_m108_ends_a_wait_and_keeps_the_target(s):
    s.host.send("M109 S200")
    s.passes(5)
    s.host.send("M108")
    s.host.expect("^ok", 1)
    assert heater(s).target == 200
    assert heater(s).celsius < 100


def test_target_acts_after_the_moves_before_it(s):
    s.host.ok("G92 X0 Y0 Z0")
    s.host.send("G1 X50 F600", "M104 S150")
    s.passes(3)
    assert heater(s).target == 0
    s.host.ok("M104 S100 F")
    assert heater(s).target == 100
    s.passes(4)
    assert heater(s).target == 150


def test_without_a_temperature_the_heater_goes_off(s):
    s.host.ok("M104 S150")
    s.passes(1)
    s.host.ok("M104")
    s.passes(1)
    assert heater(s).target == 0


@pytest.mark.parametrize("value", ["999", "4", "286"])
def test_an_unsafe_target_switches_off_with_an_error(s, value):
    s.host.ok("M104 S150")
    s.passes(1)
    answer = s.host.ok(f"M104 S{value}")
    assert answer[0].startswith(
        f"echo:heater hotend was switched off: {value} C is outside of its safe range, 5 to 285 C."
    )
    s.passes(1)
    assert heater(s).target == 0


def test_heaters_are_named_by_their_number(s):
    assert "there is no hotend with number 3" in s.host.ok("M104 T3 S100")[0]
    assert s.host.ok("M141 S40") == ["ok"]  # no chamber, none named
    assert "there is no chamber with number 0; the machine has 0" in s.host.ok("M141 P0 S40")[0]


def test_m141_sets_the_chamber_and_m191_waits_for_it():
    text = config.shipped_text("i3").replace('kind = "bed"', 'kind = "chamber"', 1)
    with Scenario(config.load_text(text)) as s:
        s.host.ok("M141 S40")
        s.passes(1)
        assert heater(s, "bed").target == 40
        s.host.ok("M191", 300)
        assert heater(s, "bed").celsius == pytest.approx(40, abs=1.1)
        assert re.search(r" C:(39|40|41)\.\d+ /40.00", s.host.ok("M105")[0])
        s.host.ok("M191 R35", 900)
        assert heater(s, "bed").celsius == pytest.approx(35, abs=1.1)
        s.host.ok("M141 S0")
        s.passes(1)
        assert heater(s, "bed").target == 0


def test_m190_r_waits_for_cooling_too(s):
    s.host.ok("M190 S60", 300)
    start = s.loop.time()
    s.host.ok("M190 S50", 5)  # hotter already
    s.host.ok("M190 R50", 900)
    assert s.loop.time() - start > 10
    assert heater(s, "bed").celsius == pytest.approx(50, abs=1.1)


def test_cooling_wait_ends_when_it_cools_no_further(s):
    """In a room of 25 C."""
    start = s.loop.time()
    s.host.ok("M190 R20", 70)
    assert s.loop.time() - start == pytest.approx(60, abs=2)
    assert s.host.heard.count("echo:bed stopped cooling at 25.0 C; continuing") == 1
    s.host.ok("M104 S20")
    start = s.loop.time()
    s.host.ok("M116", 70)  # for both at once
    assert s.loop.time() - start == pytest.approx(60, abs=2)
    s.host.ok("M104 S0")
    s.host.ok("M190 S60", 300)
    start = s.loop.time()
    s.host.ok("M190 R24", 2000)  # it does so for a while
    assert s.loop.time() - start > 300
    assert heater(s, "bed").celsius < 36
    s.host.ok("M190 R60", 300)  # one that is too cold warms up
    assert heater(s, "bed").celsius == pytest.approx(60, abs=1.1)


@pytest.mark.parametrize("line", ["M190 F S40", "M191 S40 F", "M109 F S40"])
def test_waits_take_the_f_of_settings(line):
    text = config.shipped_text("i3").replace('kind = "bed"', 'kind = "chamber"', 1)
    with Scenario(config.load_text(text) if "M191" in line else "i3") as s:
        name = "hotend" if "M109" in line else "bed"
        assert s.host.ok(line, 300)[-1].startswith("ok")
        assert heater(s, name).celsius == pytest.approx(40, abs=1.1)


def test_m116_waits_for_all_that_it_names(s):
    s.host.ok("M104 S60")
    s.host.ok("M140 S40")
    s.host.ok("M116 T0 B0", 300)
    assert heater(s).celsius == pytest.approx(60, abs=1.1)
    assert heater(s, "bed").celsius == pytest.approx(40, abs=1.1)
    assert "there is no bed with number 1" in s.host.ok("M116 B1")[0]


def test_cold_filament_does_not_move(s):
    s.host.ok("G92 X0 Y0 Z0")
    assert "cold extrusion prevented" in s.host.ok("G1 X5 E1 F600")[0]
    assert "cold extrusion prevented" in s.host.ok("G10")[0]
    s.passes(2)
    assert (s.positions()["x"], s.positions()["e"]) == (20.0, 0.0)
    assert s.host.ok("M302")[0] == "echo:Cold extrudes are disabled (min temp 170C)"
    s.host.ok("M302 S0")
    assert s.host.ok("M302")[0] == "echo:Cold extrudes are enabled (min temp 0C)"
    assert s.host.ok("G1 E1 F600") == ["ok"]
    s.host.ok("M302 S100")
    s.host.ok("M109 S110", 200)
    assert s.host.ok("G1 E3 F600") == ["ok"]
    s.host.ok("M400")
    assert s.positions()["e"] == pytest.approx(3, abs=0.011)


def test_presets_stay_below_the_limits(s):
    s.host.ok("M145 S1 H999 B90 F300")
    assert s.host.ok("M145")[1] == "M145 S1 H270 B90 F255"
    assert "S is 5: expected 0 to 2" in s.host.ok("M145 S5")[0]


def test_material_preset_heats_hotend_and_bed(s):
    s.host.ok("M145 S2 H205 B55")
    heaters = s.printer.rig.connection.heaters
    s.host.ok("M104 I2")
    s.host.ok("M140 S40 I2")
    s.passes(1)
    assert (heaters["hotend"].target, heaters["bed"].target) == (205, 55)
    s.host.send("M190 I0")
    s.passes(1)
    assert heaters["bed"].target == 60
    s.host.ok("M108")
    assert "I is 3: expected 0 to 2" in s.host.ok("M104 I3")[0]
    s.passes(1)
    assert heaters["hotend"].target == 205
    s.host.ok("M104")
    s.passes(1)
    assert heaters["hotend"].target == 0


def with_policy(policy):
    text = shipped_text("i3").replace(
        "[heaters.hotend]\n", f'[heaters.hotend]\non_fault = "{policy}"\n'
    )
    return config.load_text(text)


def test_a_broken_sensor_halts_the_machine(s):
    s.host.ok("M104 S200")
    s.passes(10)
    s.board.force_sensor("hotend", 1.0)
    start = s.loop.time()
    s.host.expect("Error:Printer halted: .*hotend", 2)
    assert s.loop.time() - start < 1
    assert s.board.output_value("hotend") == 0
    assert "Printer stopped" in s.host.ok("G1 X1")[0]
    s.board.force_sensor("hotend", None)
    s.host.send("M999")
    s.host.expect("ready again", 5)
    s.passes(10)
    assert s.board.output_value("hotend") == 0
    assert s.host.ok("M109 S60", 200)[-1] == "ok"


def test_failed_heater_keeps_target_until_rearmed():
    with Scenario(with_policy("heater")) as s:
        s.host.send("M109 S200")
        s.passes(10)
        s.board.force_sensor("hotend", 0.0)
        s.host.expect("hotend", 2)
        s.host.expect("^ok", 1)  # the wait has ended
        assert s.board.output_value("hotend") == 0
        s.board.force_sensor("hotend", None)
        s.passes(5)
        assert s.board.output_value("hotend") == 0
        assert heater(s).target == 200
        assert s.host.ok("M922")[0] == "echo:Heater hotend is armed again, target 200 C"
        s.passes(2)
        assert s.board.output_value("hotend") > 0
        assert s.host.ok("M922") == ["ok"]


def test_a_job_is_paused_by_its_heater(tmp_path):
    (tmp_path / "a.g").write_text("G28\n" + "G1 X100 F3000\nG1 X10\n" * 50)
    with Scenario(with_policy("job"), card=str(tmp_path)) as s:
        s.host.ok("M104 S200")
        s.host.ok("M32 a.g")
        s.passes(20)
        s.board.force_sensor("hotend", 1.0)
        s.host.expect("echo:.*hotend", 2)
        s.passes(5)
        at = s.positions()
        s.passes(5)
        assert s.positions() == at
        assert at["z"] == 10.0  # parked
        s.board.force_sensor("hotend", None)
        s.host.ok("M922")
        s.host.ok("M24")
        s.host.expect("Done printing", 300)


def test_tools_take_turns_at_work_and_on_standby():
    with Scenario("dual-extruder") as s:
        first, second = (
            s.printer.rig.connection.heaters[n]
            for n, h in s.machine.heaters.items()
            if h.kind == "hotend"
        )
        s.host.ok("G10 P0 S200 R150")
        s.host.ok("G10 P1 S210 R160")
        s.passes(1)
        assert (first.target, second.target) == (200, 160)
        s.host.ok("T1")
        s.passes(1)
        assert (first.target, second.target) == (150, 210)
        s.host.ok("T0")
        s.passes(1)
        assert (first.target, second.target) == (200, 160)


def test_tools_that_share_a_hotend_heat_it():
    with Scenario("multi-material") as s:
        s.host.ok("M104 T3 S200")
        s.passes(1)
        assert heater(s).target == 200
        assert "there is no hotend with number 7" in s.host.ok("M104 T7 S200")[0]


def test_an_unsafe_temperature_of_a_tool_is_refused_too(s):
    s.host.ok("M104 S150")
    s.passes(1)
    assert "outside of its safe range" in s.host.ok("G10 P0 S999")[0]
    assert heater(s).target == 0


def test_a_broken_sensor_halts_with_one_advice():
    with Scenario("i3") as s:
        s.host.ok("M104 S200")
        s.passes(2)
        s.board.force_sensor("hotend", 0.999)
        told = s.host.expect("^Error:Printer halted", 5)
        assert told == (
            "Error:Printer halted: heater hotend was switched off: its sensor reads -20.0 C; below"
            " 5.0 C means a broken cable. Check the sensor's plug and wires, then send M999"
        )
