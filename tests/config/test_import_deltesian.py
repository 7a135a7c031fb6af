"""A printer.cfg of a deltesian: what Klipper gives at the nozzle, Passo has at the carriages."""

from __future__ import annotations

from math import cos, radians, sqrt
from pathlib import Path

import pytest
from tests.oracles import kinematics
from tests.support.import_remarks import remarks
from tests.support.scenario import Scenario

from passo import config
from passo.config.importing.draft import Draft
from passo.config.importing.formats import imported
from passo.config.importing.settling import settle
from passo.config.machine import MachineConfig
from passo.errors import ConfigError

MOTOR = """[{name}]
step_pin: {pins}1
dir_pin: {pins}2
enable_pin: {pins}3
microsteps: 16
rotation_distance: 40
endstop_pin: ^{pins}4
homing_speed: 50
"""
CFG = f"""{MOTOR.format(name="stepper_left", pins="PA")}position_endstop: 240
arm_length: 217
arm_x_length: 160
{MOTOR.format(name="stepper_right", pins="PB")}arm_length: 210
arm_x_length: 150
{MOTOR.format(name="stepper_y", pins="PC")}position_endstop: 0
position_max: 200
[mcu]
serial: /dev/serial/by-id/usb-Klipper_stm32f446xx_12-if00
[printer]
kinematics: deltesian
max_velocity: 200
max_accel: 3000
max_z_velocity: 100
min_angle: 10
"""


def load(folder: Path, text: str = CFG) -> tuple[Draft, MachineConfig]:
    path = folder / "printer.cfg"
    path.write_text(text)
    draft = imported(path)
    settle(draft)
    return draft, config.load_text(draft.text(""), "x.toml")


def test_carriages_home_above_the_nozzle_by_the_rise_of_their_rods(tmp_path: Path) -> None:
    draft, machine = load(tmp_path)
    left, right = 240 + sqrt(217**2 - 160**2), 240 + sqrt(210**2 - 150**2)
    ends = [machine.homing[name].position for name in ("a", "b")]
    assert ends == pytest.approx([left, right], abs=1e-5)
    assert machine.home_point == pytest.approx((0.0, 0.0, 240.0), abs=1e-4)
    assert (machine.axes_of_arms, machine.homing["y"].position) == (("x", "z"), 0.0)
    low, high = 150 - 210 * cos(radians(10)), 217 * cos(radians(10)) - 160
    x = machine.axes["x"]
    assert (x.min_mm, x.max_mm) == pytest.approx((low, high), abs=1e-3)
    assert [*remarks(draft, "decide"), *remarks(draft, "dropped")] == []


def test_homed_deltesian_moves_its_carriages_as_the_oracle(tmp_path: Path) -> None:
    _, machine = load(tmp_path)
    step_mm = 40 / 3200
    with Scenario(config.on_simulated_boards(machine)) as s:
        assert s.host.ok("G28", 120)[-1] == "ok"
        home = [s.positions()[name] for name in machine.geometry.actuators]
        wanted = kinematics.inverse(machine.geometry, machine.home_point)
        assert home == pytest.approx(wanted, abs=1.01 * step_mm)
        off = [at - mm for at, mm in zip(home, wanted, strict=True)]
        for x, y, z in ((40, 50, 5), (-50, 120, 80), (0, 0, 0.3)):
            assert s.host.ok(f"G1 X{x} Y{y} Z{z} F6000", 120) == ["ok"]
            s.host.ok("M400", 120)
            places = [s.positions()[name] for name in machine.geometry.actuators]
            ideal = kinematics.inverse(machine.geometry, (x, y, z))
            for place, mm, by in zip(places, ideal, off, strict=True):
                assert place == pytest.approx(mm + by, abs=step_mm)
        assert "is beyond the limit" in s.host.ok("G1 X70")[0]
        assert "beyond its limit" in s.host.ok("G1 X45 Z240 F3000")[0]


def test_arm_shorter_than_its_distance_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"arm_x_length .* less than arm_length 217"):
        load(tmp_path, CFG.replace("arm_x_length: 160", "arm_x_length: 230"))
