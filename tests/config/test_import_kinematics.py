"""A printer.cfg of a polar machine, of a winch, and of a machine without axes: imported, homed and
moved on simulated boards, where the motors are compared with the plain inverse."""

from __future__ import annotations

from math import degrees
from pathlib import Path

import pytest
from tests.oracles import kinematics
from tests.support.import_remarks import remarks
from tests.support.scenario import Scenario

from passo import config
from passo.config.exporting.settings import Sections
from passo.config.importing.draft import Draft
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle
from passo.config.machine import MachineConfig
from passo.config.simulated_boards import on_simulated_boards
from passo.errors import ConfigError
from passo.printer.klipper.objects import objects

MOTOR = """[{name}]
step_pin: {pins}1
dir_pin: {pins}2
enable_pin: {pins}3
microsteps: 16
"""
PRINTER = """[mcu]
serial: /dev/serial/by-id/usb-Klipper_stm32f446xx_12-if00
[printer]
kinematics: {kind}
max_velocity: 200
max_accel: 3000
"""
POLAR = f"""{MOTOR.format(name="stepper_bed", pins="PA")}gear_ratio: 80:17
{MOTOR.format(name="stepper_arm", pins="PB")}rotation_distance: 40
endstop_pin: ^PB4
position_endstop: 150
position_max: 150
homing_speed: 50
{MOTOR.format(name="stepper_z", pins="PC")}rotation_distance: 8
endstop_pin: ^PC4
position_endstop: 0.5
position_max: 200
{PRINTER.format(kind="polar")}max_z_velocity: 25
max_z_accel: 30
max_angular_velocity: 5
"""
ANCHORS = ((0, -2000, -100), (2000, 1000, -100), (-2000, 1000, -100), (0, 0, 3000), (9, 2000, 700))
WINCH = PRINTER.format(kind="winch") + "".join(
    f"{MOTOR.format(name=f'stepper_{letter}', pins=f'P{letter.upper()}')}rotation_distance: 40\n"
    f"anchor_x: {x}\nanchor_y: {y}\nanchor_z: {z}\n"
    for letter, (x, y, z) in zip("abcde", ANCHORS, strict=True)
)
NONE = f"""{PRINTER.format(kind="none")}{MOTOR.format(name="extruder", pins="PA")}
rotation_distance: 32
nozzle_diameter: 0.4
filament_diameter: 1.75
heater_pin: PB4
sensor_type: ATC Semitec 104GT-2
sensor_pin: PC5
control: pid
pid_Kp: 22.2
pid_Ki: 1.08
pid_Kd: 114
min_temp: 0
max_temp: 250
[output_pin light]
pin: PB1
"""


def load(folder: Path, text: str) -> tuple[Draft, MachineConfig]:
    path = folder / "printer.cfg"
    path.write_text(text)
    draft = imported(path)
    settle(draft)
    machine = config.load_text(draft.text(""), "x.toml")
    return draft, on_simulated_boards(machine)


def test_polar_bed_has_its_gears_and_klippers_angular_speed(tmp_path: Path) -> None:
    draft, machine = load(tmp_path, POLAR)
    bed, arm = machine.steppers["a"], machine.steppers["b"]
    assert bed.steps_per_unit == pytest.approx(200 * 16 * 80 / 17 / 360)
    assert bed.speed_deg_s == pytest.approx(degrees(5), rel=1e-5)
    assert (arm.min_mm, arm.max_mm) == (0.0, 150.0)
    assert set(machine.homing) == {"b", "z"}
    assert (machine.axes["x"].min_mm, machine.axes["y"].max_mm) == (-150.0, 150.0)
    assert machine.home_point == pytest.approx((150.0, 0.0, 0.5))
    changed = next(text for text in remarks(draft, "changed") if "stepper_bed" in text)
    assert "17188.7 degrees/s²" in changed
    assert [*remarks(draft, "decide"), *remarks(draft, "dropped")] == []


def test_polar_machine_homes_and_keeps_the_turns_of_its_bed(tmp_path: Path) -> None:
    _, machine = load(tmp_path, POLAR)
    step_deg = 360 / (200 * 16 * 80 / 17)
    with Scenario(machine) as s:
        assert "not homed" in s.host.ok("G1 X10")[0]
        s.host.ok("G28", 120)
        home = s.positions()
        assert home["b"] == pytest.approx(150, abs=0.02)
        assert home["z"] == pytest.approx(0.5, abs=0.01)
        turned = home["a"]
        s.host.ok("G1 Z5 F1200")
        places = [(50, 40), (-60, 30), (-60, -30), (40, -60), (70, 20), (-40, 60), (-40, -60)]
        for turns in (0, 1):
            for x, y in places:
                assert s.host.ok(f"G1 X{x} Y{y} F9000", 60) == ["ok"]
            s.host.ok("M400", 60)
            angle, reach, z = kinematics.inverse(machine.geometry, (-40, -60, 5))
            at = s.positions()
            assert at["a"] - turned == pytest.approx(angle + 720 * (turns + 1), abs=step_deg)
            assert at["b"] == pytest.approx(reach, abs=0.03)
            assert at["z"] == pytest.approx(z, abs=0.01)
            s.host.ok("G1 X0 Y-70 F9000", 60)
        shown = objects(s.machine, Sections(s.machine), s.printer.status.read(), {})
        assert shown["toolhead"]()["homed_axes"] == "xyz"
        assert set(shown["stepper_enable"]()["steppers"]) == {
            "stepper_bed",
            "stepper_arm",
            "stepper_z",
        }
        assert "beyond its limit" in s.host.ok("G1 X140 Y140 F9000")[0]
        s.host.ok("G28 X", 120)
        assert s.host.ok("M114")[0].startswith("X:150.000 Y:0.000 Z:5.000")


def test_polar_line_through_the_middle_is_led_round_it(tmp_path: Path) -> None:
    extruder = NONE[NONE.index("[extruder]") : NONE.index("[output_pin")]
    extruder = extruder.replace("PA", "PD").replace("PB", "PE")
    _, machine = load(tmp_path, f"{POLAR}{extruder}")
    with Scenario(machine) as s:
        s.host.ok("G28", 120)
        s.host.ok("M302 P1")
        s.host.ok("M83")
        for feed in (9000, 60):
            s.host.ok("G1 X-8 Y4 Z5 F9000", 60)
            s.host.ok("M400", 60)
            before, start_s = s.positions(), s.printer.status.read().time_s
            assert s.host.ok(f"G1 X8 Y-4 E2 F{feed}", 120) == ["ok"]
            s.host.ok("M400", 120)
            after, took_s = s.positions(), s.printer.status.read().time_s - start_s
            assert abs(after["a"] - before["a"]) == pytest.approx(180, abs=0.03)
            assert after["b"] == pytest.approx(before["b"], abs=0.02)
            assert after["e"] - before["e"] == pytest.approx(2.0, abs=0.02)
            assert took_s > 3.1416 / 5  # half a turn at 5 rad/s
            s.host.ok("G1 X-8 Y-20 F9000", 60)
        for line in ("G1 X0 Y0", "G1 X0.01 Y-0.01 E1"):
            assert "mm from the middle of the bed" in s.host.ok(line)[0]
        s.host.ok("G1 X-10 Y0 F9000", 60)
        assert "mm from the middle of the bed" in s.host.ok("G2 X-10 Y0 I5 J0")[0]


def test_polar_bed_with_an_endstop_homes_its_angle(tmp_path: Path) -> None:
    draft, _ = load(tmp_path, POLAR)
    draft.put(("homing", "a", "direction"), "min", None)
    for key, value in (("position", -170.0), ("fast", 30.0), ("slow", 5.0), ("retract", 5.0)):
        draft.put(("homing", "a", key), value, None)
    draft.put(("homing", "a", "pin"), "^PA4", None)
    machine = on_simulated_boards(config.load_text(draft.text(""), "x.toml"))
    with Scenario(machine) as s:
        s.host.ok("G28", 120)
        assert s.positions()["a"] == pytest.approx(-170.0, abs=0.1)
        x, y, _ = kinematics.forward(machine.geometry, (-170.0, 150.0, 0.0))
        assert s.host.ok("M114")[0].startswith(f"X:{x:.3f} Y:{y:.3f} Z:0.500")


def test_limits_of_a_bed_without_end_are_refused(tmp_path: Path) -> None:
    draft, _ = load(tmp_path, POLAR)
    draft.put(("steppers", "a", "max_deg"), 360.0, None)
    with pytest.raises(ConfigError, match="it turns without end"):
        config.load_text(draft.text(""), "x.toml")


def test_winch_takes_g28_as_its_place_and_pulls_every_cable(tmp_path: Path) -> None:
    draft, machine = load(tmp_path, WINCH)
    assert machine.geometry.actuators == ("a", "b", "c", "d", "u")
    assert [*remarks(draft, "decide"), *remarks(draft, "dropped")] == []
    (changed,) = remarks(draft, "changed")
    assert "stepper_e" in changed and "the motor is u" in changed
    with Scenario(machine) as s:
        assert s.host.ok("G28") == ["ok"]
        start = [s.positions()[name] for name in machine.geometry.actuators]
        assert start == pytest.approx(kinematics.inverse(machine.geometry, (0, 0, 0)), abs=0.02)
        for place in ((300, -200, 50), (-500, 400, 900), (0, 0, 0)):
            x, y, z = place
            assert s.host.ok(f"G1 X{x} Y{y} Z{z} F12000", 60) == ["ok"]
            s.host.ok("M400", 60)
            cables = [s.positions()[name] for name in machine.geometry.actuators]
            wanted = kinematics.inverse(machine.geometry, place)
            assert cables == pytest.approx(wanted, abs=0.02)
        s.host.ok("G1 X10 F6000", 60)
        s.host.ok("G28", 60)
        assert s.host.ok("M114")[0].startswith("X:0.000 Y:0.000 Z:0.000")
        assert "beyond the limit" in s.host.ok("G1 X2500 F6000")[0]
        assert (
            "none turns alone" in s.host.ok("FORCE_MOVE STEPPER=stepper_e DISTANCE=1 VELOCITY=5")[0]
        )
        shown = objects(s.machine, Sections(s.machine), s.printer.status.read(), {})
        assert [*shown["stepper_enable"]()["steppers"]] == [f"stepper_{x}" for x in "abcde"]


def test_endstop_of_a_winch_is_refused(tmp_path: Path) -> None:
    draft, _ = load(tmp_path, WINCH)
    draft.put(("homing", "x", "pin"), "^PA4", None)
    with pytest.raises(ConfigError, match=r"homing\.x is not a known key"):
        config.load_text(draft.text(""), "x.toml")


def test_machine_without_axes_moves_filament_only(tmp_path: Path) -> None:
    draft, machine = load(tmp_path, NONE)
    assert (machine.geometry.kind, list(machine.steppers)) == ("none", ["e"])
    assert [*remarks(draft, "decide"), *remarks(draft, "dropped")] == []
    with Scenario(machine) as s:
        assert s.host.ok("G28") == ["ok"]
        s.host.ok("M302 P1")
        assert s.host.ok("G1 E5 F300", 60) == ["ok"]
        s.host.ok("M400", 60)
        assert s.positions() == {"e": pytest.approx(5.0, abs=0.01)}
        for line in ("G1 X1 F300", "G1 Y1 E9", "G2 X1 I1", "G92 Z0"):
            told = f"{line.split()[0]} has no parameter {line.split()[1][0]}: the axes of this"
            assert f"{told} machine are E" in s.host.ok(line)[0]
        assert "levels the bed, and this machine has no probe" in s.host.ok("G29")[0]
        status = s.printer.status.read()
        assert (status.axes, set(status.position_mm)) == ({}, {"e"})
        shown = objects(s.machine, Sections(s.machine), status, {})
        assert shown["toolhead"]()["homed_axes"] == ""
        assert shown["toolhead"]()["position"].e == 5.0


def test_axes_of_a_machine_without_them_are_refused(tmp_path: Path) -> None:
    draft, _ = load(tmp_path, NONE)
    draft.put(("axes", "x", "max_mm"), 100.0, None)
    with pytest.raises(ConfigError, match="has no X, Y and Z"):
        config.load_text(draft.text(""), "x.toml")
