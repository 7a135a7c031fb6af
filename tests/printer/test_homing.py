"""Axes find their switches on the simulated mechanics, or say why they did not."""

import pytest
from tests.support.scenario import Host, Scenario

from passo import config
from passo.config.load import shipped_text
from passo.errors import ConfigError, InputError
from passo.job.batch.simulated_print import Print

CARTESIAN = {"x": 0.0, "y": 0.0, "z": 0.0, "e": 0.0}


@pytest.mark.parametrize(
    ("machine", "home", "step"),
    [
        ("i3", CARTESIAN, 1 / 80),
        ("big-fish-i3", CARTESIAN | {"z1": 0.0}, 1 / 80),
        ("corexy", {"a": 0.0, "b": 0.0, "z": 0.0, "z1": 0.0, "e": 0.0}, 1 / 40),
        ("delta", {"a": 318.0, "b": 318.0, "c": 318.0, "e": 0.0}, 1 / 87),
        ("rotary-delta", {"a": -30.0, "b": -30.0, "c": -30.0, "e": 0.0}, 1 / 218),
        ("scara", {"a": -60.0, "b": 60.0, "z": 0.0, "e": 0.0}, 1 / 103),
    ],
)
def test_all_axes_end_at_their_switches(machine, home, step):
    with Scenario(machine) as s:
        assert all(abs(v - home[k]) > 0.4 for k, v in s.positions().items() if k[0] in "xyzac")
        assert s.host.ok("G28", 60)[-1] == "ok"
        for stepper, at in s.positions().items():
            assert at == pytest.approx(home[stepper], abs=1.01 * step)
        assert s.printer.rig.job.locked_axes == []


def reported(s):
    """X, Y, Z and further axes as M114 reports them."""
    words = s.host.ok("M114")[0].split(" E:")[0].split()
    return {word[0]: float(word[2:]) for word in words}


@pytest.mark.parametrize("machine", config.shipped_machines())
@pytest.mark.parametrize("relative", [False, True])
def test_after_homing_a_move_may_return_to_home(machine, relative):
    with Scenario(machine) as s:
        axes = {n.upper(): a for n, a in s.machine.axes.items() if not a.extruder}
        s.host.ok("G28", 60)
        home, at_home = reported(s), s.positions()
        middle = {n: round((a.min_mm + a.max_mm) / 2, 1) for n, a in axes.items()}
        middle["Z"] = min(middle["Z"], 20.0)
        ways = [{n: middle[n] - home[n] for n in axes}, {n: home[n] - middle[n] for n in axes}]
        ends = ways if relative else [middle, home]
        if relative:
            s.host.ok("G91")
        for end in ends:
            words = " ".join(f"{n}{mm:.3f}" for n, mm in end.items())
            told = s.host.ok(f"G1 {words} F3000", 60)
            assert [line for line in told if line != "echo:busy: processing"] == ["ok"]
        s.host.ok("M400", 120)
        assert reported(s) == home
        for stepper, at in s.positions().items():
            scale = s.machine.steppers[stepper].steps_per_unit
            assert at == pytest.approx(at_home[stepper], abs=1.01 / scale)


@pytest.mark.parametrize(
    ("change", "offset", "home", "good", "bad"),
    [
        (('0.0\npin = "^X_MIN', '-2.2\npin = "^X_MIN'), "", "X-2.2", "X0", "X-1 X-2.22 X-3"),
        (('0.0\npin = "^X_MIN', '-2.2\npin = "^X_MIN'), "M206 X0.5", "X-1.7", "X0", "X-2.2"),
        (('0.0\npin = "^Z_MIN', '-1\npin = "^Z_MIN'), "", "Z-1", "Z5", "Z-0.99 Z-1.01"),
    ],
)
def test_a_home_beyond_the_limit_is_the_one_place_there(change, offset, home, good, bad):
    assert change[0] in shipped_text("i3")
    with Scenario(config.load_text(shipped_text("i3").replace(*change))) as s:
        s.host.ok(offset or "M400")
        s.host.ok("G28", 60)
        for _ in range(2):
            assert s.host.ok(f"G1 {good} F3000") == ["ok"]
            assert s.host.ok(f"G1 {home}") == ["ok"]
            assert s.host.ok(f"G1 {good}") == ["ok"]
            for word in bad.split():
                assert "is beyond the limit of 0.000 mm" in s.host.ok(f"G1 {word}")[0]


def test_a_print_may_return_to_a_home_beyond_the_limit(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nG91\nG1 Z-50 F3000\nG1 X5\nG1 X-5\nG1 Z50\n")
    printed = Print(config.load("delta")).run(path)
    assert printed.final_position_mm["z"] == pytest.approx(180.018117131, abs=1e-9)
    path.write_text("G28\nG91\nG1 Z-50 F3000\nG1 Z50.1\n")
    with pytest.raises(InputError, match=r"Z 180\.118 mm is beyond the limit of 180\.000 mm"):
        Print(config.load("delta")).run(path)


def test_a_carriage_may_return_to_a_home_beyond_its_limit():
    text = shipped_text("delta").replace("position = 318.0", "position = 318.5")
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G28", 60)
        assert reported(s)["Z"] == 180.518
        assert s.host.ok("G91") == ["ok"]
        assert s.host.ok("G1 Z-50 F3000") == ["ok"]
        assert s.host.ok("G1 Z50") == ["ok"]
        s.host.ok("M400", 60)
        assert s.positions()["a"] == pytest.approx(318.5, abs=0.02)
        assert "is beyond the limit" in s.host.ok("G1 Z0.1")[0]
        assert "beyond its limit of 318.000 mm" in s.host.ok("G1 X20")[0]


def text_of(machine):
    if machine != "homes upwards":
        return shipped_text(machine)
    head, found, homing = shipped_text("i3").partition("[homing.z]")
    homing = homing.replace('direction = "min"', 'direction = "max"', 1)
    return head + found + homing.replace("position = 0.0", "position = 250.0", 1)


@pytest.mark.parametrize(
    "name", ["i3", "mk3s", "corexy", "delta", "rotary-delta", "scara", "homes upwards"]
)
@pytest.mark.parametrize(
    "program", ["G28\n", "G28 X\n", "G28 Z\n", "G28\nG91\nG1 E1\nG90\nG1 Z50 F3000\n"]
)
def test_a_print_begins_where_the_switches_are(tmp_path, name, program):
    """A simulated print, which only sets positions, ends where a served one does."""
    machine = config.load_text(text_of(name))
    path = tmp_path / "a.g"
    path.write_text(program)
    printed = Print(machine).run(path).final_position_mm
    with Scenario(machine, card=str(tmp_path)) as s:
        s.host.send("M302 P1", "M32 a.g")
        s.host.expect("Done printing file", 120)
        served = s.printer.rig.job.machine_position[:3]
    assert [printed[axis] for axis in "xyz"] == pytest.approx(served, abs=1e-6)


def test_a_program_may_go_down_from_a_switch_above(tmp_path):
    path = tmp_path / "a.g"
    path.write_text("G28\nG91\nG1 Z-5 F600\n")
    result = Print(config.load_text(text_of("homes upwards"))).run(path)
    assert result.final_position_mm["z"] == 245
    assert result.final_steps == result.net_steps_expected


def test_axes_home_at_the_same_time():
    with Scenario("i3") as s:
        start = s.loop.time()
        s.host.ok("G28", 60)
        # Z is the slowest: 20 mm at 5 mm/s, 3 mm back, 3 mm at 1 mm/s.
        assert s.loop.time() - start < 4.0 + 0.6 + 3.0 + 2.0


def test_one_axis_alone_leaves_the_others_where_they_are():
    with Scenario("i3") as s:
        assert s.host.ok("G28 X", 60)[-1] == "ok"
        at = s.positions()
        assert at["x"] == pytest.approx(0, abs=1 / 80)
        assert (at["y"], at["z"]) == (20.0, 20.0)
        assert "axis Y is not homed" in s.host.ok("G1 Y5")[0]
        assert s.host.ok("G1 X5 F6000") == ["ok"]


def test_the_position_counts_from_home():
    with Scenario("corexy") as s:
        s.host.ok("G28", 60)
        s.host.ok("G1 X30 Y12 F6000")
        s.host.ok("M400")
        at = s.positions()
        assert at["a"] == pytest.approx(42.0, abs=0.05)
        assert at["b"] == pytest.approx(18.0, abs=0.05)
        s.host.ok("G28 X", 60)
        assert "X:0.000 Y:12.000" in s.host.ok("M114")[0]


def test_unhomed_axes_refuse_to_move_until_homed():
    with Scenario("i3") as s:
        answer, _ = s.host.ok("G1 X10 E5 F3000")
        assert answer == ("echo:axis X is not homed. Home it (G28), or set its position (G92).")
        s.passes(1)
        assert s.positions()["x"] == 20.0
        s.host.ok("G92 X100")
        s.host.ok("G1 X110 F3000")
        s.host.ok("M400")
        assert s.positions()["x"] == 30.0
        assert "X:110.000" in s.host.ok("M114")[0]
        assert "E:0.0000" in s.host.ok("M114")[0]  # what was refused did not count


def test_unhomed_moves_may_be_allowed():
    text = 'unhomed_moves = "allow"\n' + shipped_text("i3")
    with Scenario(config.load_text(text)) as s:
        s.host.ok("G1 X10 F3000")
        s.host.ok("M400")
        assert s.positions()["x"] == 30.0


def test_an_endstop_that_never_triggers_is_named():
    with Scenario("i3") as s:
        s.host.ok("G28", 60)
        s.board.force_switch("y", False)
        answer = s.host.ok("G28", 120)[-2]
        assert answer.startswith(
            "echo:axis Y was not homed: switch y at ^Y_MIN was not triggered within 264 mm towards"
        )
        assert "axis Y is not homed" in s.host.ok("G1 Y10")[0]
        assert "axis X is not homed" in s.host.ok("G1 X10")[0]  # they went together


def test_an_endstop_that_stays_triggered_is_named():
    with Scenario("i3") as s:
        s.board.force_switch("z", True)
        answer = s.host.ok("G28 Z", 120)[-2]
        assert "switch z at ^Z_MIN is still triggered 3 mm away from 0 mm" in answer
        assert "axis Z is not homed" in s.host.ok("G1 Z10")[0]


def test_m119_shows_the_switches():
    with Scenario("big-fish-i3") as s:
        assert s.host.ok("M119") == [
            "Reporting endstop status",
            "x_min: open",
            "y_min: open",
            "z_min: open",
            "z1_min: open",
            "ok",
        ]
        s.board.force_switch("z1", True)
        assert "z1_min: TRIGGERED" in s.host.ok("M119")


def test_homing_ends_when_the_machine_is_stopped():
    with Scenario("i3") as s:
        s.host.send("G28")
        s.passes(0.5)
        s.host.send("M410")
        s.host.expect("it was stopped", 5)
        at = s.positions()
        s.passes(2)
        assert s.positions() == at
        assert "is not homed" in s.host.ok("G1 X1")[0]


def test_emergency_stop_while_homing_unhomes_all_axes():
    with Scenario("i3") as s:
        s.host.ok("G28 Y", 60)
        s.host.send("G28 X")
        s.passes(0.5)
        s.host.send("M112")
        s.host.expect("Printer halted", 5)
        s.host.send("M999")
        s.host.expect("ready again", 10)
        assert "axis Y is not homed" in s.host.ok("G1 Y1")[0]
        s.host.ok("G28", 60)
        assert s.host.ok("G1 X1 F6000") == ["ok"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('pin = "^X_MIN"', ""), "homing.x.pin is missing: expected either pin, or stepper_pins"),
        (("[homing.x]", "[homing.q]"), "homing.q is not a known key. Known here: x, y, z"),
        (('pin = "^X_MIN"', 'pin = "^Y_MIN"'), "homing.y.pin"),
        (("[homing.x]\n", "[homing.x]\nfast = 0\n"), "homing.x.fast is 0: expected a number"),
        (
            ('pin = "^X_MIN"', 'stepper_pins = { y9 = "X_MIN" }'),
            "homing.x.stepper_pins.y9 is 'y9': expected the name of a motor of this axis",
        ),
    ],
)
def test_a_wrong_section_is_explained(change, message):
    text = shipped_text("i3").replace(*change)
    with pytest.raises(ConfigError) as error:
        config.load_text(text, "i3.toml")
    assert message in str(error.value)


def test_a_delta_homes_all_its_carriages():
    text = shipped_text("delta").replace("[homing.b]", "[homing.z]")
    with pytest.raises(ConfigError) as error:
        config.load_text(text, "delta.toml")
    assert "homing.b is missing" in str(error.value)


DUAL_SCARA = """
[geometry]
kind = "dual_scara"
"""


def dual_scara(home=10.0):
    """Two arms of 60 and 70 mm, 100 mm apart, homed where they spread outwards."""
    changes = {
        "min_mm = 0.0\nmax_mm = 200.0": "min_mm = -60.0\nmax_mm = 60.0",
        "[axes.y]\nmin_mm = 0.0\nmax_mm = 200.0": "[axes.y]\nmin_mm = 60.0\nmax_mm = 110.0",
        "min_deg = -60.0\nmax_deg = 120.0": "min_deg = -90.0\nmax_deg = 60.0",
        "min_deg = 60.0\nmax_deg = 250.0": "min_deg = -60.0\nmax_deg = 90.0",
        "position = -60.0": f"position = {-home}",
        'direction = "min"\nposition = 60.0': f'direction = "max"\nposition = {home}',
    }
    head, rest = shipped_text("scara").split("[geometry]")
    rest = "[axes.x]" + rest.split("[axes.x]", 1)[1]
    for old, new in changes.items():
        assert old in rest
        rest = rest.replace(old, new, 1)
    return config.load_text(head + DUAL_SCARA + rest)


def test_arms_that_do_not_meet_at_home_are_refused():
    with pytest.raises(ConfigError) as error:
        dual_scara(50.0)
    assert "homing.a.position is -50" in str(error.value)
    assert "no point belongs to the motor positions" in str(error.value)


def test_the_arms_of_two_shoulders_find_their_switches():
    with Scenario(dual_scara()) as s:
        assert s.host.ok("G28", 60)[-1] == "ok"
        at = s.positions()
        assert at["a"] == pytest.approx(-10, abs=0.02)
        assert at["b"] == pytest.approx(10, abs=0.02)
        x, y, _ = s.machine.geometry.forward((-10.0, 10.0, 0.0))
        assert f"X:{x + 0.0:.3f} Y:{y:.3f} Z:0.000" in s.host.ok("M114")[0]
        s.host.ok("G1 X10 Y80 F3000")
        s.host.ok("M400", 60)
        a, b, _ = s.machine.geometry.inverse((10.0, 80.0, 0.0))
        at = s.positions()
        assert (at["a"], at["b"]) == pytest.approx((a, b), abs=0.02)


def test_x_and_y_of_a_scara_are_homed_together_and_z_by_itself():
    with Scenario("scara") as s:
        assert s.host.ok("G28 X", 60)[-1] == "ok"
        at = s.positions()
        assert (at["a"], at["b"], at["z"]) == pytest.approx((-60, 60, 20), abs=0.02)
        assert "axis Z is not homed" in s.host.ok("G1 Z5")[0]
        assert "X:250.000 Y:-56.000" in s.host.ok("M114")[0]
        assert s.host.ok("G28 Z", 60)[-1] == "ok"
        assert s.positions()["z"] == pytest.approx(0, abs=0.01)
        assert s.host.ok("G1 X150 Y50 Z5 F6000") == ["ok"]
        s.host.ok("M400", 60)
        a, b, _ = s.machine.geometry.inverse((150.0, 50.0, 5.0))
        at = s.positions()
        assert (at["a"], at["b"]) == pytest.approx((a, b), abs=0.02)


def test_arms_turn_at_the_same_time():
    with Scenario("scara") as s:
        start = s.loop.time()
        s.host.ok("G28 X", 60)
        # 20 degrees at 40, 5 back, and 5 at 4 degrees per second, not twice that.
        assert s.loop.time() - start < 0.5 + 0.25 + 1.25 + 1.5


def test_arm_without_trigger_is_named_with_its_angle():
    with Scenario("scara") as s:
        s.board.force_switch("b", False)
        assert s.host.ok("G28", 120)[-2].startswith(
            "echo:arm B was not homed: switch b at ^Y_MIN was not triggered within 190 degrees"
            " towards 60 degrees."
        )
        for axis in "XYZ":
            assert f"axis {axis} is not homed" in s.host.ok(f"G1 {axis}10")[0]
        s.board.force_switch("b", None)
        assert s.host.ok("G28", 120)[-1] == "ok"
        s.board.force_switch("a", True)
        answer = s.host.ok("G28 Y", 120)[-2]
        assert "arm A was not homed: switch a at ^X_MIN is still triggered 5 degrees" in answer


BOTTOM = """
[homing.z]
direction = "min"
position = 0.0
pin = "^X_MIN"
by_default = false
retract = 2.0

[heaters.hotend]"""


def delta_with_a_switch_below():
    text = shipped_text("delta").replace("\n[heaters.hotend]", BOTTOM, 1)
    return config.load_text(text.replace("[board]", '[board]\npins = { X_MIN = "PA10" }'))


def test_z_of_a_delta_may_have_a_switch_of_its_own():
    with Scenario(delta_with_a_switch_below()) as s:
        s.host.ok("G28", 60)
        assert s.positions()["a"] == pytest.approx(318, abs=0.02)  # not by default
        s.host.ok("G1 Z20 F6000")
        s.host.ok("G92 Z25")
        assert s.host.ok("G28 Z", 120)[-1] == "ok"
        at = s.positions()
        middle = s.machine.geometry.inverse((0.0, 0.0, 0.0))
        assert [at[k] for k in "abc"] == pytest.approx(list(middle), abs=0.03)
        assert "X:0.000 Y:0.000 Z:0.000" in s.host.ok("M114")[0]
        s.host.ok("G1 X20 Z10 F6000")
        s.host.ok("M400", 20)
        at = s.positions()
        wanted = s.machine.geometry.inverse((20.0, 0.0, 10.0))
        assert [at[k] for k in "abc"] == pytest.approx(list(wanted), abs=0.03)


def test_delta_that_is_not_homed_homes_carriages_before_z():
    with Scenario(delta_with_a_switch_below()) as s:
        assert s.host.ok("G28 Z", 120)[-1] == "ok"
        middle = s.machine.geometry.inverse((0.0, 0.0, 0.0))
        assert [s.positions()[k] for k in "abc"] == pytest.approx(list(middle), abs=0.03)


@pytest.mark.parametrize("machine", ["i3", "delta", "rotary-delta", "scara"])
def test_console_commands_while_axes_home(machine):
    """Positions are the last ones of the program, motors count on, and nothing shifts."""
    with Scenario(machine) as s:
        s.host.ok("G28", 60)
        s.host.ok("G91")
        s.host.ok("G1 Z-10 F3000" if machine.endswith("delta") else "G1 Z10 F600")
        s.host.ok("M400", 10)
        before, other = s.host.ok("M114")[0], Host(s)
        s.host.send("G28")
        s.passes(0.2)
        counts = []
        while s.printer.motion.homer.active:
            assert "M290 has to wait until all axes are homed" in other.ok("M290 Z0.5")[0]
            plain, real = other.ok("M114")[0], other.ok("M114 R")[0]
            places = before.split(" Count")[0]
            assert (plain.split(" Count")[0], real.split(" Count")[0]) == (places, places)
            counts.append(real.split(" Count ")[1])
            s.passes(0.3)
        assert len(set(counts)) > 2
        s.host.expect("^ok", 60)
        after = s.positions()
        assert s.host.ok("M290 Z0") == ["ok"]
        assert s.host.ok("G28", 60)[-1] == "ok"
        assert s.positions() == pytest.approx(after, abs=0.05)


@pytest.mark.parametrize("machine", ["i3", "delta", "scara"])
@pytest.mark.parametrize("line", ["G28 B", "G28 X B"])
def test_homing_with_b_goes_back_to_where_it_was(machine, line):
    with Scenario(machine) as s:
        s.host.ok("G28", 60)
        x, y, z = (10, 20, 60) if machine == "delta" else (120, 90, 30)
        s.host.ok(f"G1 X{x} Y{y} Z{z} F3000")
        s.host.ok("M400", 60)
        before = s.positions()
        assert s.host.ok(line, 60)[-1] == "ok"
        assert s.positions() == pytest.approx(before, abs=0.06)
        assert f"X:{x}.000 Y:{y}.000 Z:{z}.000" in s.host.ok("M114")[0]
        s.host.ok("G91")
        s.host.ok("G1 X5 F3000")
        s.host.ok("M400")
        assert f"X:{x + 5}.000 Y:{y}.000 Z:{z}.000" in s.host.ok("M114")[0]


def test_homing_with_b_stays_where_nothing_was_known():
    with Scenario("i3") as s:
        assert s.host.ok("G28 B", 60)[-1] == "ok"
        assert s.positions() == {"x": 0.0, "y": 0.0, "z": 0.0, "e": 0.0}


@pytest.mark.parametrize("zone_mm", [0.2, 0.5])
def test_a_switch_that_bounces_is_found_at_its_edge(zone_mm):
    """Over the last bit of the way, both times, it opens and closes every 10 ms."""
    turns = 0
    with Scenario("i3") as s:

        def bounced() -> bool:
            nonlocal turns
            near = 0.0 < s.positions()["x"] < zone_mm
            turns += near
            s.board.force_switch("x", turns % 2 == 0 if near else None)
            return any(x.startswith("ok") for x in s.host.heard)

        s.host.send("G28 X")
        assert s.until(bounced, 60)
        assert turns >= 3
        assert [x for x in s.host.heard if not x.startswith(("echo:busy", "ok"))] == []
        assert 0 <= s.positions()["x"] <= zone_mm
        assert s.printer.rig.job.locked_axes == [1, 2]
        s.board.force_switch("x", None)
        assert s.host.ok("G1 X5 F6000") == ["ok"]
        s.host.ok("M400")
        assert 5.0 <= s.positions()["x"] <= 5.0 + zone_mm


@pytest.mark.parametrize("stop", ["M410", "M108"])
@pytest.mark.parametrize(("axis", "mm"), [("x", 20), ("z", 2.5)])
def test_an_axis_that_was_stopped_on_its_way_is_where_it_went(axis, mm, stop):
    with Scenario("i3") as s:
        s.host.ok("G92 X120 Y120 Z102")
        before = s.positions()[axis]
        s.host.send(f"G28 {axis}")
        s.passes(0.6)
        s.host.send(stop)
        s.passes(2)
        moved = s.positions()[axis] - before
        assert -mm < moved < -0.5 * mm
        told = dict(word.split(":") for word in s.host.ok("M114 R")[0].split()[:3])
        assert float(told[axis.upper()]) == pytest.approx(
            {"x": 120, "z": 102}[axis] + moved, abs=0.002
        )
        assert s.printer.rig.job.locked_axes == ["xyz".index(axis)]


def test_homed_delta_reaches_a_part_of_a_step_beyond():
    with Scenario("delta") as s:
        s.host.ok("G28", 60)
        # On this straight line a carriage rises by 4 µm first; its step is 11 µm.
        assert s.host.ok("G1 X40 Y0 Z160 F6000") == ["ok"]
        s.host.ok("M400")
        assert s.printer.rig.job.machine_position[:3] == pytest.approx([40, 0, 160])
        s.host.ok("G28", 60)
        assert "beyond its limit of 318.000 mm. " in s.host.ok("G1 X40 Y0 Z160.5 F6000")[0]
