"""Klipper's printer.cfg becomes a machine file. The configurations here are our own."""

import math
import re
from pathlib import Path

import pytest
from tests.support.import_remarks import remarks
from tests.support.scenario import Scenario

from passo import config
from passo.cli.main import main
from passo.config.home_checks import check_skew
from passo.config.importing.draft import Draft
from passo.config.importing.formats import imported
from passo.config.trinamic.known_motors import known_motors
from passo.config.trinamic.motor import MotorConstants
from passo.errors import ConfigError
from passo.job.batch.simulated_print import Print

BASE = """\
# The board has an STM32F103.
[stepper_x]
step_pin: PC2
dir_pin: !PB9
enable_pin: !PC3
microsteps: 16
rotation_distance: 40
endstop_pin: ^PA5
position_endstop: 0
position_max: 235
homing_speed: 50
[stepper_y]
step_pin: PB8
dir_pin: PB7
enable_pin: !PC3
microsteps: 32
full_steps_per_rotation: 400
gear_ratio: 80:20, 2:1
rotation_distance: 40
endstop_pin: ^!EXP1_3
position_min: -5
position_endstop: 230
position_max: 230
second_homing_speed: 3
homing_retract_dist: 4
[stepper_z]
step_pin: PB6
dir_pin: PB5
enable_pin: !PC3
microsteps: 16
rotation_distance: 8
endstop_pin: PA7
position_endstop: 0.5
position_max: 250
step_pulse_duration: 0.000004
[stepper_z1]
step_pin: PD6
dir_pin: PD5
enable_pin: !PD3
microsteps: 16
rotation_distance: 8
endstop_pin: PD7
[extruder]
step_pin: PB4
dir_pin: PB3
enable_pin: !PC3
microsteps: 16
rotation_distance: 34.4
nozzle_diameter: 0.4
filament_diameter: 1.75
heater_pin: PA1
sensor_type: mine
sensor_pin: PC5
control: pid
pid_Kp: 21.5
pid_Ki: 1.06
pid_Kd: 109.0
min_temp: 0
max_temp: 250
max_power: 0.8
[thermistor mine]
temperature1: 25
resistance1: 100000
temperature2: 150
resistance2: 1641.9
temperature3: 250
resistance3: 226.15
[verify_heater extruder]
check_gain_time: 30
heating_gain: 1.5
hysteresis: 6
max_error: 100
[heater_bed]
heater_pin: PA2
sensor_type: NTC 100K MGB18-104F39050L32
sensor_pin: PC4
control: watermark
max_delta: 1.5
min_temp: 0
max_temp: 130 ; as the plate allows
[fan]
pin: PA0
kick_start_time: 0.3
off_below: 0.1
cycle_time: 0.02
[heater_fan Hotend Fan]
pin: PA8
heater: extruder
heater_temp: 45
[controller_fan board]
pin: PA9
idle_timeout: 20
stepper: stepper_x, stepper_z1
[board_pins]
aliases: EXP1_1=PB5, EXP1_3=PA6,
  EXP1_9=<GND>
[mcu]
serial: /dev/ttyACM0
[printer]
kinematics: cartesian
max_velocity: 300
max_accel: 3000
max_z_velocity: 5
max_z_accel: 100
square_corner_velocity: 8
"""


@pytest.fixture
def load(tmp_path: Path):
    """A function from a printer.cfg, which changes make of BASE, to its draft and its machine."""

    def convert(*changes: tuple[str, str], text: str = BASE, more: str = ""):
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "printer.cfg"
        path.write_text(text + more, encoding="utf-8")
        draft = imported(path)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


def test_axes_and_motors_have_the_values_of_the_file(load) -> None:
    _, machine = load()
    x, y, z = (machine.axes[name] for name in "xyz")
    assert (x.min_mm, x.max_mm, x.speed_mm_s, x.accel_mm_s2) == (0.0, 235.0, 300.0, 3000.0)
    assert (y.min_mm, y.max_mm) == (-5.0, 230.0)
    assert (z.speed_mm_s, z.accel_mm_s2) == (5.0, 100.0)
    motors = machine.steppers
    assert motors["x"].steps_per_unit == 80.0
    assert motors["y"].steps_per_unit == 400 * 32 * 8 / 40
    assert (motors["x"].step_pin, motors["x"].direction_pin, motors["x"].invert) == (
        "PC2",
        "PB9",
        True,
    )
    assert motors["z"].pulse_us == pytest.approx(4.0)
    assert motors["z1"].enable_pin == "!PD3"


def test_corners_have_the_speed_of_klipper(load) -> None:
    _, machine = load()
    limits = machine.limits
    assert (limits.junction, limits.square_corner_mm_s) == ("square_corner", 8)
    assert limits.minimum_cruise_ratio == 0.5


def test_max_accel_to_decel_is_a_cruise_ratio(load) -> None:
    older = "max_z_accel: 100", "max_z_accel: 100\nmax_accel_to_decel: 900"
    draft, machine = load(older)
    assert machine.limits.minimum_cruise_ratio == 0.7
    assert "minimum_cruise_ratio of 0.7" in "".join(remarks(draft, "changed"))
    both = older[0], f"{older[1]}\nminimum_cruise_ratio: 0.2"
    assert load(both)[1].limits.minimum_cruise_ratio == 0.2


def test_axis_without_a_switch_has_the_end_that_its_owner_moves_it_to(load) -> None:
    silent = "endstop_pin: ^!EXP1_3", "endstop_pin: tmc2209_stepper_y:virtual_endstop"
    once = "position_max: 235", "position_max: 235\nhoming_retract_dist: 0"
    draft, machine = load(silent, once)
    assert "y" not in machine.homing and machine.home_mm["y"] == 230
    assert "takes it to be at 230 mm" in "".join(remarks(draft, "decide"))
    assert machine.homing["x"].retract == 3
    assert "approaches its endstop twice" in "".join(remarks(draft, "changed"))
    unknown = "endstop_pin: PA7", "endstop_pin: probe:z_virtual_endstop"
    draft, machine = load(unknown, more="[beacon]\nserial: /dev/beacon\n")
    assert "z" not in machine.homing
    asked = "".join(remarks(draft, "decide"))
    assert "Passo does not have this probe" in asked
    assert "[beacon]: Passo does not read this probe" in asked


_EDDY = """[mcu EDDY]
serial: /dev/serial/by-id/usb-Klipper_rp2040_eddy
[probe_eddy_current btt eddy]
sensor_type: ldc1612
i2c_mcu: EDDY
i2c_bus: i2c0f
x_offset: -16
y_offset: 11.5
reg_drive_current: 16
samples: 2
"""
_STORED = """
#*# <---------------------- SAVE_CONFIG ---------------------->
#*# [probe_eddy_current btt eddy]
#*# z_offset = 2.5
#*# calibrate =
#*# 	0.050000:3285399.885,0.990000:3264149.144,
#*# 	2.890000:3232857.556
"""


def test_eddy_probe_comes_with_its_calibration(load) -> None:
    by_probe = "endstop_pin: PA7", "endstop_pin: probe:z_virtual_endstop"
    _, machine = load(by_probe, more=_EDDY + _STORED)
    probe = machine.probe
    assert probe.kind == "eddy" and probe.name == "btt_eddy" and probe.i2c_bus == "EDDY:i2c0f"
    assert probe.trigger_height_mm == 2.5 and probe.offset_mm == [-16, 11.5]
    assert probe.drive_current == 16 and probe.samples == 2
    assert [(p.mm, p.hz) for p in probe.calibration][::2] == [
        (0.05, 3285399.885),
        (2.89, 3232857.556),
    ]
    assert machine.homing["z"].probe and machine.boards["EDDY"].port == _EDDY.split()[3]


@pytest.mark.parametrize(
    ("section", "says"),
    [
        (
            "[probe_eddy_ng a]\nsensor_type: btt_eddy\ni2c_bus: i2c0f\n",
            "PROBE_EDDY_CURRENT_CALIBRATE",
        ),
        ("[probe_eddy_ng a]\nsensor_type: cartographer\n", "does not read the chip cartographer"),
        ("[probe_eddy_current a]\nsensor_type: ldc1612\n", "give [probe] its i2c_bus"),
    ],
)
def test_other_eddy_probes_say_what_is_left_to_do(load, section, says) -> None:
    draft, machine = load(more=section)
    told = "".join(remarks(draft, "decide") + remarks(draft, "changed"))
    assert says in told
    assert (machine.probe is None) == ("PROBE_EDDY" not in says)


STALL = """[tmc2209 stepper_x]
uart_pin: PC1
run_current: 0.8
diag_pin: ^PA5
driver_SGTHRS: 90
home_current: 0.5
"""


def test_virtual_endstop_of_a_driver_homes_by_its_stall(load) -> None:
    stall = "endstop_pin: ^PA5", "endstop_pin: tmc2209_stepper_x: virtual_endstop"
    draft, machine = load(stall, more=STALL)
    homing, driver = machine.homing["x"], machine.steppers["x"].tmc
    assert homing.stall is not None and driver is not None
    assert (homing.stall.threshold, homing.stall.current_a, homing.fast) == (90, 0.5, 50)
    assert (homing.position, homing.direction, driver.diag_pin) == (0, "min", "^PA5")
    assert not [r for r in draft.remarks if "stall" in r.text or "diag" in r.what]
    draft, machine = load(stall, more=STALL.replace("driver_SGTHRS: 90\n", ""))
    assert "STALL_CALIBRATE finds it" in "".join(remarks(draft, "decide"))
    for wrong, why in (
        ("diag_pin: ^PA5\n", "no pin that shows stalls"),
        ("2209", "not detect stalls"),
    ):
        lost = STALL.replace(wrong, "" if "diag" in wrong else "2208")
        endstop = stall[0], stall[1].replace("2209", "2209" if "diag" in wrong else "2208")
        draft, machine = load(endstop, more=lost.replace("driver_SGTHRS: 90\n", ""))
        assert "x" not in machine.homing and why in "".join(remarks(draft, "decide"))


def test_amplifier_of_a_sensor_has_the_voltage_of_its_converter(load) -> None:
    for name, kind in (("PT100 INA826", "pt100-amplifier"), ("AD595", "ad595")):
        for more, volt in (("\nadc_voltage: 3.3", 3.3), ("", 5.0)):
            _, machine = load(("sensor_type: mine", f"sensor_type: {name}{more}"))
            sensor = machine.heaters["hotend"].sensor
            assert (sensor.kind, sensor.full_scale_v) == (kind, volt)


def test_homing_has_side_speeds_and_a_switch_for_each_motor(load) -> None:
    _, machine = load()
    x, y, z = (machine.homing[name] for name in "xyz")
    assert (x.direction, x.position, x.pin, x.fast, x.slow, x.retract) == (
        "min",
        0,
        "^PA5",
        50,
        25,
        5,
    )
    assert (y.direction, y.position, y.pin, y.fast, y.slow, y.retract) == (
        "max",
        230,
        "!^PA6",
        5,
        3,
        4,
    )
    assert z.stepper_pins == {"z": "PA7", "z1": "PD7"}


def test_axis_with_too_few_switches_stops_at_the_first(load) -> None:
    further = "[stepper_z2]\nstep_pin: PE2\ndir_pin: PE3\nenable_pin: !PE4\nmicrosteps: 16\n"
    draft, machine = load(more=further + "rotation_distance: 8\n")
    assert machine.homing["z"].pin == "PA7"
    assert not machine.homing["z"].stepper_pins
    assert any("[stepper_z] endstop_pin" in text for text in remarks(draft, "decide"))


def test_heaters_have_sensors_gains_limits_and_protections(load) -> None:
    draft, machine = load()
    hotend, bed = machine.heaters["hotend"], machine.heaters["bed"]
    assert (hotend.pin, hotend.sensor_pin, hotend.max_c, hotend.max_power) == (
        "PA1",
        "PC5",
        250,
        0.8,
    )
    assert hotend.control.model_dump(include={"kp", "ki", "kd"}) == {
        "kp": 21.5,
        "ki": 1.06,
        "kd": 109,
    }
    epcos = load((("sensor_type: mine"), "sensor_type: EPCOS 100K B57560G104F"))[1].heaters[
        "hotend"
    ]
    assert hotend.sensor.r25_ohm == pytest.approx(epcos.sensor.r25_ohm, rel=1e-4)
    assert hotend.sensor.beta_k == pytest.approx(epcos.sensor.beta_k, rel=1e-4)
    protection = hotend.protection
    assert (protection.watch_s, protection.watch_rise_c, protection.runaway_c) == (30, 1.5, 6)
    assert any("max_error" in text for text in remarks(draft, "changed"))
    assert (bed.control.kind, bed.control.hysteresis_c) == ("bang-bang", 1.5)
    assert bed.max_c == 130


def test_fans_of_each_kind(load) -> None:
    more = "[fan_generic Chamber]\npin: PA10\ncycle_time: 0.001\n"
    more += "[temperature_fan rpi]\npin: PA11\nsensor_type: rpi\n"
    draft, machine = load(more=more)
    part, hot, board = (machine.fans[name] for name in ("part", "Hotend_Fan", "board"))
    assert (part.pin, part.kick_start_s, part.off_below, part.pwm_hz) == ("PA0", 0.3, 0.1, 50)
    assert (hot.follows, hot.above_c) == ("hotend", 45)
    assert (board.follows_motors, board.stays_on_s) == (["x", "z1"], 20)
    assert machine.fans["Chamber"].number == 1
    assert [machine.fans[name].pwm_hz for name in ("Chamber", "Hotend_Fan")] == [1000, 100]
    assert "off until M106 P2 sets it" in "".join(remarks(draft, "decide"))
    assert (machine.fans["rpi"].number, machine.fans["rpi"].thermostat) == (2, None)
    assert board.follows_targets == ["hotend"]
    assert [heater.pwm_hz for heater in machine.heaters.values()] == [10, 10]


def test_extruder_limits_follow_from_nozzle_and_filament(load) -> None:
    """Klipper's default: four nozzles squared of plastic at the speed and acceleration of moves."""
    wide = "max_power: 0.8", "max_power: 0.8\nmax_extrude_cross_section: 50"
    _, machine = load(wide)
    ratio = 4 * 0.4**2 / (math.pi * 0.875**2)
    assert machine.extruders["e"].speed_mm_s == pytest.approx(300 * ratio, rel=1e-5)
    assert machine.extruders["e"].accel_mm_s2 == pytest.approx(3000 * ratio, rel=1e-5)


def test_shapers_and_pressure_advance(load) -> None:
    shaper = "[input_shaper]\nshaper_freq_x: 52\nshaper_type: ei\nshaper_freq_y: 40\n"
    shaper += "shaper_type_y: EI(v_tol=0.02)\ndamping_ratio_y: 0.05\n"
    advance = ("pressure_advance: 0.06\npressure_advance_smooth_time: 0.03\n", "nozzle_diameter")
    _, machine = load((advance[1], "".join(advance)), more=shaper)
    x, y = machine.shaping["x"], machine.shaping["y"]
    assert (x.type, x.frequency_hz) == ("ei", 52)
    assert (y.type, y.frequency_hz, y.damping) == ("ei(v_tol=0.02)", 40, 0.05)
    assert "z" not in machine.shaping
    assert machine.extruders["e"].advance_s == 0.06
    assert machine.extruders["e"].advance_smooth_s == 0.03


def test_the_accelerometer_has_its_bus_point_and_directions(load) -> None:
    rpi = "[mcu rpi]\nserial: /tmp/klipper_host_mcu\n"
    chip = "[adxl345 head]\ncs_pin: rpi:None\nspi_bus: spidev0.0\naxes_map: -y, x, z\n"
    tester = (
        "[resonance_tester]\naccel_chip_x: adxl345 head\naccel_chip_y: lis2dw\n"
        "probe_points:\n  110,115,20\naccel_per_hz: 75\nmax_smoothing: 0.2\n"
    )
    pins = "cs_pin: PE1\nspi_software_sclk_pin: PE2\nspi_software_mosi_pin: PE3\n"
    pins += "spi_software_miso_pin: PE4\n"
    draft, machine = load(more=f"{rpi}[lis2dw]\n{pins}{chip}{tester}")
    part = machine.accelerometer
    assert part is not None
    assert (part.chip, part.spi_bus, part.cs_pin) == ("adxl345", "rpi:spidev0.0", None)
    assert part.axes_map == ["-y", "x", "z"] and part.point_mm == [110, 115, 20]
    assert (part.accel_per_hz, part.max_smoothing_mm) == (75, 0.2)
    assert any("[lis2dw]: one accelerometer" in text for text in remarks(draft, "dropped"))
    _, machine = load(more=f"[lis2dw]\n{pins}")
    assert (machine.accelerometer.chip, machine.accelerometer.miso_pin) == ("lis2dw", "PE4")


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (
            "i2c_mcu: rpi\ni2c_bus: i2c.1\ni2c_speed: 100000\n",
            ("rpi:i2c.1", None, None, 25, 100_000),
        ),
        (
            "i2c_software_scl_pin: PE1\ni2c_software_sda_pin: PE2\ni2c_address: 24\n",
            (None, "PE1", "PE2", 24, 400_000),
        ),
    ],
)
def test_the_accelerometer_may_be_on_i2c(load, more: str, expected: tuple) -> None:
    rpi = "[mcu rpi]\nserial: /tmp/klipper_host_mcu\n"
    _, machine = load(more=f"{rpi}[lis2dw]\n{more}")
    part = machine.accelerometer
    found = (part.i2c_bus, part.scl_pin, part.sda_pin, part.i2c_address, part.i2c_hz)
    assert (part.chip, found) == ("lis2dw", expected)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("cs_pin: PE1\n", "give [accelerometer] its spi_bus, or clock_pin"),
        ("spi_bus: spi1\n", "give [accelerometer] cs_pin, clock_pin"),
        ("cs_pin: can:PE1\nspi_bus: spi1\n", "spi_bus = 'can:spi1' when its board has link"),
        ("[lis2dw]\n", "give [accelerometer] its i2c_bus, or scl_pin"),
        ("[lis2dw]\ni2c_mcu: can\ni2c_bus: i2c1\n", "i2c_bus = 'can:i2c1' when its board has link"),
    ],
)
def test_accelerometer_without_a_bus_is_a_decision(
    tmp_path: Path, more: str, expected: str
) -> None:
    path = tmp_path / "printer.cfg"
    head = "" if more.startswith("[") else "[adxl345]\nrate: 800\n"
    path.write_text(f"{BASE}[mcu can]\ncanbus_uuid: 1\n{head}{more}")
    draft = imported(path)
    assert not any(key[0] == "accelerometer" for key in draft.keys)
    assert any(expected in text for text in remarks(draft, "decide"))


@pytest.mark.parametrize(
    ("chip", "rate", "used"), [("adxl345", 800, 800), ("adxl345", 400, 800), ("lis2dw", 3200, 1600)]
)
def test_accelerometer_of_a_known_board_has_its_rate(load, chip: str, rate: int, used: int) -> None:
    """BASE without its second motor of Z is wired as a board of Creality."""
    second = BASE[BASE.index("[stepper_z1]") : BASE.index("[extruder]")]
    own = (second, ""), ("stepper_x, stepper_z1", "stepper_x")
    more = f"[{chip}]\ncs_pin: PC13\nspi_bus: spi2\nrate: {rate}\n"
    draft, machine = load(*own, more=more)
    assert machine.board.base == "creality-4.2.2"
    assert (machine.accelerometer.spi_bus, machine.accelerometer.rate_hz) == ("spi2", used)
    assert any("rate" in text for text in remarks(draft, "changed")) == (rate != used)


def test_comments_name_line_file_and_default(load, tmp_path: Path) -> None:
    draft, _ = load()
    text = draft.text("From a test.")
    assert "max_mm = 235.0  # printer.cfg:10\n" in text
    assert "min_mm = 0.0  # printer.cfg:2, default\n" in text


def test_board_has_port_baud_and_the_clock_of_its_chip(load) -> None:
    _, machine = load()
    board = machine.board
    assert (board.base, board.link, board.port) == ("klipper", "serial", "/dev/ttyACM0")
    assert (board.baud, board.clock_hz) == (250_000, 72_000_000)
    draft, machine = load(("STM32F103", "secret chip"))
    assert any("reads its clock from the firmware" in text for text in remarks(draft, "changed"))
    assert not machine.board.knows_clock


def test_names_keep_their_case_and_are_found_in_any(load, tmp_path) -> None:
    more = """\
[fan_generic Fan_Side]
pin: PA10
[heater_generic Chamber_Heater]
heater_pin: PB1
sensor_type: EPCOS 100K B57560G104F
sensor_pin: PC1
max_temp: 80
min_temp: 0
control: watermark
[gcode_macro _My_Vars]
variable_count: 3
gcode:
[gcode_macro look]
gcode:
  SET_FAN_SPEED FAN=fan_SIDE SPEED=0.5
  SET_HEATER_TEMPERATURE HEATER=Chamber_heater TARGET=40
  {% set vars = printer["gcode_macro _My_Vars"] %}
  SET_GCODE_VARIABLE MACRO=_my_vars VARIABLE=count VALUE={ vars.count + 1 }
  Say
[gcode_macro say]
gcode: M118 { printer["gcode_macro _My_Vars"].count } { printer["fan_generic Fan_Side"].speed
  } { printer["heater_generic Chamber_Heater"].target }
"""
    _, machine = load(more=more)
    assert [*machine.macros] == ["_My_Vars", "look", "say"]
    path, told = tmp_path / "look.gcode", []
    path.write_text("LOOK\n")
    job = Print(machine)
    job.macros.watchers.append(lambda _, text: told.append(text))
    job.run(path)
    assert told[-1] == "M118 4 0.5 40.0"


def test_pins_of_a_second_board_are_imported(load) -> None:
    more = "[mcu EBBCan]\nserial: /dev/ttyACM1\n"
    _, machine = load(("pin: PA8", "pin: !EBBCan: PB3"), more=more)
    assert machine.fans["Hotend_Fan"].pin == "!EBBCan:PB3"
    assert machine.boards["EBBCan"].port == "/dev/ttyACM1"


def test_drivers_have_currents_and_wires(load) -> None:
    tmc = "uart_pin: PC11\nrun_current: 0.58\nstealthchop_threshold: 999999\nuart_address: 2\n"
    spi = "cs_pin: PD1\nrun_current: 0.6\nhold_current: 0.4\n"
    wires = "spi_software_sclk_pin: PD2\nspi_software_mosi_pin: PD4\nspi_software_miso_pin: PE1\n"
    more = f"[tmc2209 stepper_x]\n{tmc}[tmc2130 stepper_y]\n{spi}{wires}[tmc5160 extruder]\n"
    more += spi.replace("PD1", "PD7")
    more += "[tmc2660 stepper_z]\nrun_current: 1\ncs_pin: PE15\nspi_bus: spi9\n"
    draft, machine = load(more=more)
    x, y = machine.steppers["x"], machine.steppers["y"]
    assert x.tmc is not None
    assert y.tmc is not None
    assert (x.driver, x.tmc.run_current_a, x.tmc.address) == ("TMC2209", 0.58, 2)
    assert x.tmc.stealthchop_below_mm_s == 999_999
    assert (y.driver, y.tmc.cs_pin, y.tmc.clock_pin, y.tmc.hold_current_a) == (
        "TMC2130",
        "PD1",
        "PD2",
        0.4,
    )
    e = machine.steppers["e"].tmc  # without spi_bus: the first unit of an STM32
    assert e is not None
    assert (e.cs_pin, e.miso_pin, e.mosi_pin, e.clock_pin) == ("PD7", "PB14", "PB15", "PB13")
    assert any("[tmc2660 stepper_z]" in text for text in remarks(draft, "decide"))


def test_a_driver_of_an_atmega2560_is_on_its_one_spi_unit(tmp_path: Path) -> None:
    motors = "".join(
        f"[stepper_{a}]\nstep_pin: PC{i}\ndir_pin: PL{i}\nenable_pin: !PA{i}\nmicrosteps: 16\n"
        f"rotation_distance: 32\nendstop_pin: ^PK{i}\nposition_max: 200\n"
        for i, a in enumerate("xyz")
    )
    head = "[mcu]\nserial: /dev/ttyACM0\n[printer]\nkinematics: cartesian\nmax_velocity: 200\n"
    more = "max_accel: 1000\n[tmc2130 stepper_x]\ncs_pin: PG0\nrun_current: 0.3\n"
    (tmp_path / "printer.cfg").write_text(head + more + motors, encoding="utf-8")
    draft = imported(tmp_path / "printer.cfg")
    pins = [
        draft.keys["steppers", "x", "tmc", f"{pin}_pin"][0] for pin in ("miso", "mosi", "clock")
    ]
    assert pins == ["PB3", "PB2", "PB1"]


def test_drivers_keep_their_registers(load) -> None:
    wires = "spi_software_sclk_pin: PD2\nspi_software_mosi_pin: PD4\nspi_software_miso_pin: PE1\n"
    more = f"""[tmc2240 stepper_x]
cs_pin: PD1
run_current: 0.8
rref: 11000
coolstep_threshold: 30
high_velocity_threshold: 200
driver_TPFD: 5
driver_SEMIN: 3
driver_multistep_filt: False
driver_OFFSET_SIN90: -3
driver_SLOPE_CONTROL: 2
driver_SG4_THRS: 90
driver_VACTUAL: 5
{wires}
[tmc2660 stepper_z]
cs_pin: PE15
run_current: 1.2
sense_resistor: 0.051
idle_current_percent: 60
driver_HDEC: 1
{wires}
"""
    draft, machine = load(more=more)
    x, z = machine.steppers["x"].tmc, machine.steppers["z"].tmc
    assert x is not None and z is not None
    assert (x.run_current_a, x.reference_resistor_ohm, x.coolstep_above_mm_s) == (0.8, 11_000, 30)
    assert x.high_speed_above_mm_s == 200
    assert x.registers == {
        "tpfd": 5, "semin": 3, "multistep_filt": 0, "offset_sin90": -3, "slope_control": 2,
    }  # fmt: skip
    assert (machine.steppers["z"].driver, z.registers, z.hold_current_a) == (
        "TMC2660", {"hdec": 1}, None,
    )  # fmt: skip
    lost = remarks(draft, "dropped")
    assert any("idle_current_percent" in text for text in lost)
    assert any("driver_vactual" in text for text in lost)


def test_a_tuned_driver_gets_the_constants_of_its_motor(load) -> None:
    more = """[tmc2209 stepper_x]
uart_pin: PC11
run_current: 0.8
stealthchop_threshold: 999999
[tmc2209 stepper_z]
uart_pin: PC12
run_current: 0.6
hold_current: 0.9
[motor_constants ours]
resistance: 1.65
inductance: 0.0036
holding_torque: 0.45
max_current: 1.68
steps_per_revolution: 200
[autotune_tmc stepper_x]
motor: ours
voltage: 48
extra_hysteresis: 2
tbl: 1
[autotune_tmc stepper_z]
motor: somebodys
tuning_goal: silent
"""
    draft, machine = load(more=more)
    x, z = machine.steppers["x"].tmc, machine.steppers["z"].tmc
    assert x is not None and x.motor is not None and z is not None
    assert (x.motor.inductance_mh, x.motor.supply_v, x.motor.extra_hysteresis) == (3.6, 48, 2)
    assert x.registers == {"tbl": 1}
    assert x.stealthchop_below_mm_s is None  # auto: X is strong
    assert (z.stealthchop_below_mm_s, z.hold_current_a) == (1e6, None)
    decided = remarks(draft, "decide")
    assert any("give steppers.z.tmc.motor from the data sheet of somebodys" in t for t in decided)


def test_a_motor_that_is_known_by_name_needs_no_constants(load) -> None:
    more = "[tmc2209 stepper_x]\nuart_pin: PC11\nrun_current: 0.8\n"
    more += "[autotune_tmc stepper_x]\nmotor: LDO-42sth48-2004ac\nvoltage: 48\n"
    draft, machine = load(more=more)
    driver = machine.steppers["x"].tmc
    assert driver is not None and driver.motor is not None
    assert driver.motor.model_dump(exclude={"extra_hysteresis"}) == {
        "resistance_ohm": 1.6,
        "inductance_mh": 3.0,
        "holding_torque_nm": 0.59,
        "max_current_a": 2.0,
        "supply_v": 48,
    }
    assert not [r for r in draft.remarks if "motor" in r.what]


@pytest.mark.parametrize("name", known_motors())
def test_each_known_motor_has_constants_that_fit_together(name: str) -> None:
    """A coil with its rated current has a few watts, and a time constant of milliseconds."""
    motor = MotorConstants(**known_motors()[name])
    assert 1 <= motor.resistance_ohm * motor.max_current_a**2 <= 8
    assert 0.5 <= motor.inductance_mh / motor.resistance_ohm <= 4


def test_klipper_probe_homes_z_and_mesh_is_within_reach(load) -> None:
    more = """\
[probe]
pin: ^PA12
x_offset: -30
y_offset: 10
z_offset: 1.5
speed: 4
samples: 3
samples_result: median
samples_tolerance: 0.02
[safe_z_home]
home_xy_position: 100, 110
[bed_mesh]
mesh_min: 10, 20
mesh_max: 230, 200
probe_count: 6, 5
algorithm: bicubic
"""
    virtual = ("endstop_pin: PA7\nposition_endstop: 0.5", "endstop_pin: probe:z_virtual_endstop")
    draft, machine = load(virtual, ("endstop_pin: PD7\n", ""), more=more)
    assert machine.homing["z"].probe
    assert machine.homing["z"].position == 1.5
    assert machine.probe_home_mm == (70.0, 120.0)
    probe, mesh = machine.probe, machine.levelling
    assert (probe.offset_mm, probe.samples, probe.result, probe.fast_mm_s) == (
        [-30, 10],
        3,
        "median",
        4,
    )
    assert mesh.area == [10, 20, 205, 200]
    assert mesh.count == [6, 5]
    assert any("the probe does not get so far" in text for text in remarks(draft, "changed"))


def test_bltouch_with_its_own_kind(load) -> None:
    more = "[bltouch]\nsensor_pin: ^PA12\ncontrol_pin: PA13\nz_offset: 2\n"
    more += "probe_with_touch_mode: True\n"
    _, machine = load(more=more)
    dump = machine.probe.model_dump()
    assert (dump["kind"], dump["control_pin"], dump["touch_mode"]) == ("bltouch", "PA13", True)


def test_twist_of_the_axis_comes_with_its_heights(load) -> None:
    more = "[probe]\npin: ^PA12\nz_offset: 2\nactivate_gcode: G4 P100\n"
    more += "[axis_twist_compensation]\ncalibrate_start_x: 10\ncalibrate_end_x: 200\n"
    more += "calibrate_y: 100\nz_compensations: 0.0125, 0.005, -0.0175\n"
    more += "compensation_start_x: 20\ncompensation_end_x: 190\n"
    _, machine = load(more=more)
    twist = machine.probe.twist["x"]
    assert (twist.from_mm, twist.to_mm, twist.across_mm) == (20, 190, 100)
    assert twist.heights_mm == [0.0125, 0.005, -0.0175]
    assert machine.probe.arm_gcode == "G4 P100"


def test_smart_effector_is_the_nozzle_that_settles_before_a_descent(load) -> None:
    draft, machine = load(more="[smart_effector]\npin: ^PA12\nz_offset: 0\nprobe_accel: 50\n")
    assert (machine.probe.kind, machine.probe.settle_s) == ("nozzle", 0.4)
    assert any("probe_accel: a descent has the" in text for text in remarks(draft, "dropped"))


def test_delta_has_towers_and_carriage_heights(load) -> None:
    head, rest = BASE.split("[stepper_x]")[0], BASE[BASE.index("[extruder]") :]
    tower = "enable_pin: !PC3\nmicrosteps: 16\nrotation_distance: 40\n"
    towers = "".join(
        f"[stepper_{n}]\nstep_pin: PE{i}\ndir_pin: PG{i}\nendstop_pin: ^PF{i}\n{tower}"
        for i, n in enumerate("abc", 1)
    )
    towers = towers.replace(
        "[stepper_b]", "position_endstop: 298\narm_length: 218\nhoming_speed: 60\n[stepper_b]"
    )
    text = head + towers + rest
    changes = [
        ("kinematics: cartesian", "kinematics: delta\ndelta_radius: 100\nprint_radius: 90"),
        ("stepper: stepper_x, stepper_z1", "stepper: stepper_a"),
    ]
    calibrated = "[delta_calibrate]\nradius: 80\n"
    draft, machine = load(*changes, text=text, more=calibrated)
    assert (machine.probe.kind, machine.levelling.delta.radius_mm) == ("manual", 80)
    assert any("DELTA_CALIBRATE" in text for text in remarks(draft, "changed"))
    rise = math.sqrt(218**2 - 100**2)
    for name in "abc":
        homing = machine.homing[name]
        assert homing.position == pytest.approx(298 + rise, abs=1e-6)
        assert (homing.direction, homing.fast, homing.slow) == ("max", 60, 30)
    assert machine.home_mm["z"] == pytest.approx(298, abs=1e-5)
    assert machine.geometry.model_dump()["rods"] == [218, 218, 218]


ARMS = "upper_arm_length: 170\nlower_arm_length: 320\nposition_endstop: 252\nhoming_speed: 17\n"
ROTARY = [
    (
        "kinematics: cartesian",
        "kinematics: rotary_delta\nshoulder_radius: 34\nshoulder_height: 413",
    ),
    ("stepper: stepper_x, stepper_z1", "stepper: stepper_a"),
]


def rotary_delta() -> str:
    head, rest = BASE.split("[stepper_x]")[0], BASE[BASE.index("[extruder]") :]
    motor = "enable_pin: !PC3\nmicrosteps: 16\ngear_ratio: 107:16, 60:16\n"
    arms = "".join(
        f"[stepper_{n}]\nstep_pin: PE{i}\ndir_pin: {'!' * (i == 2)}PG{i}\n"
        f"endstop_pin: ^PF{i}\n{motor}"
        for i, n in enumerate("abc", 1)
    )
    return head + arms.replace("[stepper_b]", f"{ARMS}[stepper_b]") + rest


def test_rotary_delta_counts_angles_downward(load) -> None:
    _, machine = load(*ROTARY, text=rotary_delta())
    geometry = machine.geometry
    assert (geometry.arm_length, geometry.rod_length, geometry.z_offset) == (170, 320, 413)
    inward = (geometry.base_length - geometry.effector_length) / math.sqrt(12)
    assert inward == pytest.approx(34, abs=1e-6)
    # Klipper's arms at 30, 150 and 270 degrees are those of Passo's motors b, c and a.
    assert [machine.steppers[name].step_pin for name in "bca"] == ["PE1", "PE2", "PE3"]
    assert [machine.steppers[name].invert for name in "bca"] == [True, False, True]
    assert machine.steppers["a"].steps_per_degree == pytest.approx(3200 * 107 * 60 / 256 / 360)
    # An elbow at its endstop, 320 mm from the nozzle at 252 mm.
    up = math.radians(-machine.homing["a"].position)
    elbow = 34 + 170 * math.cos(up), 413 + 170 * math.sin(up) - 252
    assert math.hypot(*elbow) == pytest.approx(320, abs=1e-3)
    assert up > 0
    assert (machine.axes["z"].max_mm, machine.axes["x"].max_mm) == (252, 204)
    assert machine.homing["a"].fast == pytest.approx(math.degrees(0.1), abs=1e-4)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[stepper_c]", "[stepper_c]\nangle: 280", "Passo's arms are 120 degrees apart"),
        ("[stepper_c]", "[stepper_c]\nupper_arm_length: 171", "Passo's arms have one length"),
        ("position_endstop: 252", "position_endstop: 950", "a height in reach: arm A and its rod"),
    ],
)
def test_unsupported_arms_are_refused(load, old: str, new: str, sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        load(*ROTARY, (old, new), text=rotary_delta())


def test_corexy_motors_are_imported(load) -> None:
    _, machine = load(("cartesian", "corexy"), ("stepper: stepper_x", "stepper: stepper_y"))
    assert machine.steppers["a"].step_pin == "PC2"
    assert machine.fans["board"].follows_motors == ["b", "z1"]


def test_macros_keep_templates_variables_and_names(load) -> None:
    more = """\
[gcode_macro start_print]
description: Heats
variable_bed: 60
variable_names: ["a", 'b']
variable_odd: open(
variable_stage: None
variable_corner: (10, 20.5)
variable_empty: ()
variable_names_by_tool: {0: 'PLA', .6: ["a", None]}
variable_materials: {"PLA": {"bed": 60, 'soak time': [1, 2]}}
variable_pa_petg0.8: 0.035
variable_large: 10000000000000000000
gcode:
  {% set t = params.T|default(200)|int %}
  M104 S{t} # heat
  {% if t > 250 %}
    M117 hot
  {% endif %}
[gcode_macro M600]
rename_existing: M600.1
gcode:
  M600.1
[gcode_macro G28]
rename_existing: HOME_ALL
gcode: home_all
[gcode_macro M117]
gcode: M118 none
[delayed_gcode later]
initial_duration: 5
gcode: M117 later
[gcode_macro G1]
gcode: G0 X1
"""
    draft, machine = load(more=more)
    start = machine.macros["start_print"]
    assert start.gcode.splitlines()[1:] == [
        "M104 S{t} {#- heat #}",
        "{% if t > 250 %}",
        "M117 hot",
        "{% endif %}",
    ]
    assert (start.description, start.variables) == (
        "Heats",
        {
            "bed": 60,
            "names": ["a", "b"],
            "materials": {"PLA": {"bed": 60, "soak time": [1, 2]}},
            "pa_petg0.8": 0.035,
        },
    )
    assert start.values() == start.variables | {
        "stage": None,
        "corner": (10, 20.5),
        "empty": (),
        "names_by_tool": {0: "PLA", 0.6: ["a", None]},
        "large": 10**19,
    }
    assert machine.macros["M600"].rename_existing == "M600.1"
    assert (machine.macros["G28"].rename_existing, machine.macros["G28"].gcode) == (
        "G9028",
        "G9028",
    )
    assert machine.macros["M117"].rename_existing == "M9117"
    assert machine.delayed_gcode["later"].initial_duration_s == 5
    assert "G1" not in machine.macros
    lost = remarks(draft, "dropped")
    assert any("variable_odd" in text for text in lost)
    assert any("[gcode_macro G1]" in text for text in lost)


COMMENTED = """\
[gcode_macro START]
gcode: # of this printer
  ##### Temperatures #####
  # {% if params.T is not defined %} { 1 / 0 } #}
  {% set hot = params.T|default(200)|int   # of the slicer
             if params.T != "9" else 0 %}
# at the margin
  M118 {hot}   # shown {hot}
  ; M118 old
  M118 it is { "}" } ; not {# this

  # the end

# Heats the bed.
[gcode_macro BED]
gcode:
  M118 { 1 }
# of the next
[gcode_macro NEXT]
gcode: M118 next
"""


def test_comments_of_macros_stay_and_are_never_read(load, tmp_path: Path) -> None:
    _, machine = load(more=COMMENTED)
    kept = machine.macros["START"].gcode
    assert kept.splitlines() == [
        "{# of this printer #}",
        "{# Temperatures ##### #}",
        "{# {% if params.T is not defined %} { 1 / 0 } # } #}",
        "{% set hot = params.T|default(200)|int",
        'if params.T != "9" else 0 %}',
        "{# at the margin #}",
        "M118 {hot} {#- shown {hot} #}",
        "{# M118 old #}",
        'M118 it is { "}" } {#- not {# this #}',
        "{# the end #}",
    ]
    assert machine.macros["BED"].gcode == "M118 { 1 }"
    path, told = tmp_path / "a.gcode", []
    path.write_text("START T=9\nSTART\n")
    job = Print(machine)
    job.macros.watchers.append(
        lambda _, text: told.append([line for line in text.split("\n") if line])
    )
    job.run(path)
    assert told == [["M118 0", "M118 it is }"], ["M118 200", "M118 it is }"]]


def test_comment_of_jinja_in_a_printer_cfg_is_cut_as_by_klipper(load) -> None:
    draft, machine = load(more="[gcode_macro ODD]\ngcode:\n  {# note #}\n  M118 x\n")
    assert "ODD" not in machine.macros
    assert any("macros.ODD: it is left out" in text for text in remarks(draft, "decide"))


def test_each_part_that_is_left_out_is_named_with_what_it_means(load) -> None:
    more = "[manual_stepper sign]\npin: PC1\n[brand_new thing]\n[pause_resume]\n"
    draft, _ = load(("max_temp: 250", "max_temp: 250\ninline_resistor: 220"), more=more)
    lost = "\n".join(remarks(draft, "dropped"))
    assert "[manual_stepper sign]: the motor does not move" in lost
    assert "[brand_new thing]: Passo does not have this part" in lost
    assert "[extruder] inline_resistor: readings are a little off" in lost
    assert any("PAUSE, RESUME" in text for text in remarks(draft, "changed"))


def test_included_files_and_saved_values_are_read(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/bed.cfg").write_text("[heater_bed]\nmax_temp: 111\n")
    saved = (
        "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n#*# DO NOT EDIT\n#*#\n"
    )
    saved += "#*# [extruder]\n#*# pid_kp = 33.5\n#*# [heater_bed]\n#*# max_temp = 112\n"
    path = tmp_path / "printer.cfg"
    path.write_text(BASE.replace("pid_Kp: 21.5\n", "") + "[include parts/*.cfg]\n" + saved)
    machine = config.load_text(imported(path).text(""), "x.toml")
    assert machine.heaters["hotend"].control.model_dump()["kp"] == 33.5
    assert machine.heaters["bed"].max_c == 112


def test_include_with_an_absolute_path_and_a_pattern(tmp_path: Path) -> None:
    folder = tmp_path / "p1"
    (folder / "a").mkdir(parents=True)
    (folder / "a/bed.cfg").write_text("[heater_bed]\nmax_temp: 111\n")
    (folder / "a/.bed.cfg").write_text("[heater_bed]\nmax_temp: 112\n")
    path = folder / "printer.cfg"
    for pattern in (f"{tmp_path}/p[12]/a/*.cfg", "a/*.cfg", "**/*.cfg", f"{folder}/a/bed.cfg"):
        path.write_text(f"{BASE}[include {pattern}]\n")
        machine = config.load_text(imported(path).text(""), "x.toml")
        assert machine.heaters["bed"].max_c == 111, pattern


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "rotation_distance: 8",
            "rotation_distance: 1e999",
            "'1e999': expected a number from -1e+12",
        ),
        ("rotation_distance: 8", "rotation_distance: nan", "'nan': expected a number from -1e+12"),
        ("gear_ratio: 80:20", "gear_ratio: 1e999:1", "expected pairs of teeth"),
        ("microsteps: 16\nrotation", "microsteps: 16.5\nrotation", "a whole number from 0"),
        ("rotation_distance: 8", "rotation_distance: 0", "expected a number greater than 0"),
        ("gear_ratio: 80:20", "gear_ratio: 80:0", "expected pairs of teeth"),
        ("step_pin: PC2", "step_pin: <GND>", "expected a pin of a board"),
        (
            "kinematics: cartesian",
            "kinematics: generic_cartesian",
            "the kind of machine is 'generic_cartesian'",
        ),
        ("max_accel: 3000", "max_accel: -1", "expected more than 0"),
        ("[printer]", "[include printer.cfg]\n[printer]", "include each other"),
        ("[printer]", "[include /*/*/*]\n[printer]", "in at most 2 parts of the path"),
        ("[printer]", "what is this\n[printer]", "'what is this' is not an option"),
        ("[printer]", "[other]", "the section [printer] is missing"),
    ],
)
def test_wrong_and_dangerous_values_have_a_sentence(load, old: str, new: str, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load((old, new))
    assert message in "\n".join(str(problem) for problem in caught.value.problems)


@pytest.mark.parametrize(
    "text",
    ["[printer]\nkinematics: " + "x" * 5_000_000, "[" * 100_000, "\0" * 1000, "[a]\n b\n c: d", ""],
)
def test_hostile_text_has_a_sentence(load, text: str) -> None:
    with pytest.raises(ConfigError):
        load(text=text)


def test_command_writes_the_file_and_the_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    parts = "[manual_stepper sign]\npin: PC1\n[manual_stepper lamp]\npin: PC6\n"
    Path("printer.cfg").write_text(BASE + parts)
    assert main(["import", "printer.cfg", "--output", "mine.toml"]) == 0
    out = capsys.readouterr().out
    named = "[manual_stepper sign]; [manual_stepper lamp]"
    line = f"  printer.cfg:106, 108: {named}: the motor does not move.\n"
    assert f"Not taken over:\n{line}" in out
    assert out.endswith("Next: passo serve --machine mine.toml\n")
    assert main(["check", "mine.toml"]) == 0
    assert main(["import", "printer.cfg", "--output", "mine.toml"]) == 4
    assert main(["import", "printer.cfg", "--output", "b.toml", "--report", "r.txt"]) == 0
    assert "[manual_stepper sign]" in Path("r.txt").read_text()
    assert main(["import", "none.cfg"]) == 3
    capsys.readouterr()


PROBE = "[probe]\npin: PC14\nx_offset: 20\ny_offset: -10\nz_offset: 1\n"


def test_screws_are_where_the_probe_is_over_them(load) -> None:
    screws = "[screws_tilt_adjust]\nscrew1: 10, 40\nscrew1_name: left\nscrew2: 180, 40\n"
    by_hand = "[bed_screws]\nscrew1: 30, 30\nscrew2: 200,30\nscrew2_name: right\n"
    _, machine = load(more=f"{PROBE}{screws}screw_thread: CCW-M4\n{by_hand}")
    found = machine.levelling.screws
    assert found.thread == "M4 ccw"
    assert [(s.name, s.x, s.y) for s in found.places] == [("left", 30, 30), ("screw 2", 200, 30)]
    draft, machine = load(more=screws + by_hand)
    assert [s.name for s in machine.levelling.screws.places] == ["screw 1", "right"]
    assert any("[screws_tilt_adjust]" in text for text in remarks(draft, "dropped"))
    far = screws.replace("180, 40", "234, 240")
    draft, machine = load(more=PROBE + far)
    assert machine.levelling.screws is None
    assert any("X254 Y230" in text for text in remarks(draft, "decide"))


def test_motors_of_z_have_pivots_and_points(load) -> None:
    tilt = "[z_tilt]\nz_positions:\n  -10, 100\n  240, 100\npoints:\n  10, 110\n  200, 110\n"
    _, machine = load(more=f"{PROBE}{tilt}retries: 7\nretry_tolerance: 0.02\n")
    motors = machine.levelling.motors
    assert motors.pivots == {"z": [-10, 100], "z1": [240, 100]}
    assert [(p.x, p.y) for p in motors.points] == [(30, 100), (220, 100)]
    assert (motors.retries, motors.tolerance_mm) == (7, 0.02)
    draft, machine = load(more=PROBE + tilt.replace("  240, 100\n", ""))
    assert machine.levelling.motors is None
    assert "of which there are 2" in "".join(remarks(draft, "decide"))
    draft, machine = load(more=tilt)
    assert machine.levelling.motors is None
    assert any("G34 needs a probe" in text for text in remarks(draft, "dropped"))


def test_gantry_corners_are_the_pivots_of_four_motors(load) -> None:
    further = "".join(
        f"[stepper_z{n}]\nstep_pin: PE{n}\ndir_pin: PE{n + 4}\nenable_pin: !PE{n + 8}\n"
        "microsteps: 16\nrotation_distance: 8\n"
        for n in (2, 3)
    )
    gantry = "[quad_gantry_level]\ngantry_corners:\n  -60,-10\n  290, 320\npoints:\n  0, 20\n"
    gantry += "  0,200\n  200,200\n  200, 20\nmax_adjust: 10\n"
    _, machine = load(("endstop_pin: PD7\n", ""), more=PROBE + further + gantry)
    motors = machine.levelling.motors
    assert motors.pivots == {
        "z": [-60, -10],
        "z1": [-60, 320],
        "z2": [290, 320],
        "z3": [290, -10],
    }
    assert motors.points[1].model_dump() == {"x": 20, "y": 190}
    assert motors.max_adjust_mm == 10


SAVED = "#*# <---------------------- SAVE_CONFIG ---------------------->\n"


@pytest.mark.parametrize("file", ["none.cfg", "~/none.cfg", "/dev/zero"])
def test_missing_include_is_an_open_decision(load, file: str) -> None:
    draft, _ = load(("[printer]", f"[include {file}]\n[printer]"))
    assert f"[include {file}]: the file is missing" in "\n".join(remarks(draft, "decide"))


def test_stored_skew_is_a_profile_with_its_reach(load) -> None:
    more = "[skew_correction]\n" + SAVED + "#*# [skew_correction my]\n#*# xz_skew = -0.017\n"
    _, machine = load(more=more)
    skewed = machine.geometry.model_copy(update={"skew": [0.0, -0.017, 0.0]})
    assert [*check_skew(machine.model_copy(update={"geometry": skewed}))] == []
    assert (machine.steppers["x"].min_mm, machine.steppers["x"].max_mm) == (0.0, 235.0)
    assert machine.steppers["y"].min_mm is None
    draft, machine = load(("kinematics: cartesian", "kinematics: corexy"), more=more)
    z = machine.axes["z"]
    found = re.search(
        r"LOAD=my uses it, when geometry has reach_x_mm = \[(.*), (.*)\], if the carriages reach",
        "\n".join(remarks(draft, "decide")),
    )
    assert found is not None
    reach = float(found[1]), float(found[2])
    assert reach == pytest.approx((0.017 * min(z.min_mm, 0.0), 235 + 0.017 * z.max_mm), abs=0.01)
    assert draft.commands == ["SKEW_PROFILE SET=my XY=0.000000000 XZ=-0.017000000 YZ=0.000000000"]


OVERRIDE = """[homing_override]
axes: z
set_position_z: 0
gcode:
  G90
  G1 Z5 F600
  g28 X Y
  G1 X90 Y100 F3600
  G28 Z
"""


def test_homing_override_is_a_macro_g28(load) -> None:
    draft, machine = load(more=OVERRIDE)
    macro = machine.macros["G28"]
    assert macro.rename_existing == "G28.1"
    lines = macro.gcode.splitlines()
    assert lines[0].startswith("{% if 'Z' in params or not (")
    assert lines[1:-3] == [
        *("G92 Z0", "G90", "G1 Z5 F600", "g28 X Y", "G1 X90 Y100 F3600", "G28 Z"),
    ]
    assert lines[-3:] == ["{% else %}", "G28.1 {rawparams}", "{% endif %}"]
    assert any("[homing_override]" in text for text in remarks(draft, "changed"))
    draft, machine = load(
        more=f"{OVERRIDE}[gcode_macro G28]\nrename_existing: G28.2\ngcode: M118 x\n"
    )
    assert "M118" in machine.macros["G28"].gcode
    assert any("[homing_override]" in text for text in remarks(draft, "decide"))


SAFE = "[safe_z_home]\nhome_xy_position: 110, 120\nspeed: 80\nz_hop: 10\n"


def simulated(draft: Draft) -> Scenario:
    """The imported printer on a simulated board."""
    del draft.keys["board", "link"], draft.keys["board", "port"]
    return Scenario(config.load_text(draft.text("From a test."), "printer.toml"))


def nozzle(s: Scenario) -> list[float]:
    """X, Y and Z at standstill, to a whole number of steps."""
    s.host.ok("M400", 10)
    return [round(s.positions()[axis], 2) for axis in "xyz"]


def test_safe_z_home_of_a_switch_rises_and_goes_to_its_place(load) -> None:
    draft, _ = load(more=SAFE)
    assert any("do not rise" in text for text in remarks(draft, "changed"))
    with simulated(draft) as s:
        start = s.positions()
        s.host.ok("G91")
        s.host.send("G28")
        assert s.until(lambda: s.positions()["x"] != start["x"], 10)
        assert s.positions()["z"] == start["z"] + 10
        s.host.expect("^ok", 200)
        assert nozzle(s) == [110, 120, 10]
        s.host.ok("G1 X-20 Z-6 F3000", 10)  # relative, as before G28
        s.host.send("G28 X")
        assert s.until(lambda: s.positions()["x"] != 90, 10)
        assert round(s.positions()["z"], 2) == 10
        s.host.expect("^ok", 60)
        s.host.ok("G28 O", 10)
        assert nozzle(s) == [0, 120, 10]


def test_safe_z_home_needs_x_and_y_and_stays_up_at_the_upper_end(load) -> None:
    draft, _ = load(("position_endstop: 0.5", "position_endstop: 250"), more=SAFE)
    with simulated(draft) as s:
        assert "axis X is not homed" in " ".join(s.host.ok("G28 Z", 60))
        s.host.ok("G28", 400)
        assert nozzle(s) == [110, 120, 250]


def test_safe_z_home_of_a_probe_rises_by_the_start_of_a_descent(load) -> None:
    virtual = ("endstop_pin: PA7\nposition_endstop: 0.5", "endstop_pin: probe:z_virtual_endstop")
    more = "[probe]\npin: PA12\nz_offset: 1\n"
    more += SAFE.replace("z_hop: 10", "z_hop: 25\nmove_to_previous: True\nz_hop_speed: 7")
    speed = "position_max: 250", "position_max: 250\nhoming_speed: 9"
    draft, machine = load(virtual, ("endstop_pin: PD7\n", ""), speed, more=more)
    assert (machine.probe.start_mm, machine.probe.travel_mm_s) == (25, 80)
    assert "homing_speed 9: the probe homes Z" in "".join(remarks(draft, "changed"))
    dropped = remarks(draft, "dropped")
    assert any("stays where Z was homed" in text for text in dropped)
    assert any("rises with probe.lift_mm_s" in text for text in dropped)
    draft, machine = load(
        virtual, ("endstop_pin: PD7\n", ""), more=more.replace("z_hop: 25", "z_hop: 4")
    )
    assert machine.probe.start_mm == 10
    assert any("rises by probe.start_mm, 10 mm" in text for text in remarks(draft, "changed"))


def test_g28_in_helpers_of_homing_override_is_the_command(load) -> None:
    more = (
        "[gcode_macro _HOME_X]\ngcode:\n  {% for axis in ['X'] %}\n  G28 {axis}\n  {% endfor %}\n"
    )
    more += "  G1 X20 F6000\n[gcode_macro _HOME_XY]\ngcode:\n  _HOME_X\n  G28 Y\n"
    more += "[homing_override]\ngcode:\n  _HOME_XY\n  G28 Z\n"
    draft, _ = load(more=more)
    assert remarks(draft, "decide") == []
    with simulated(draft) as s:
        s.host.ok("G28", 400)
        assert nozzle(s) == [20, 230, 0.5]
        s.host.ok("G1 X50 F6000", 10)
        s.host.ok("_HOME_X", 400)  # outside of the override, its G28 is the override
        assert nozzle(s) == [20, 230, 0.5]


def test_board_on_a_can_bus_needs_usb(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    text = BASE.replace("[fan]\npin: PA0", "[fan]\npin: head: PA0")
    path.write_text(f"{text}[mcu head]\ncanbus_uuid: 0e0d81e4210c\n", encoding="utf-8")
    draft = imported(path)
    assert any("does not use CAN" in text for text in remarks(draft, "decide"))
    machine = config.load_text(draft.text(""), "x.toml")
    assert [board.link for board in machine.all_boards.values()] == ["simulated"] * 2
    assert any("until boards.head has link and port" in t for t in remarks(draft, "decide"))


def test_board_is_known_by_its_pins(load) -> None:
    """BASE without its second motor of Z is wired as a board of Creality."""
    second = BASE[BASE.index("[stepper_z1]") : BASE.index("[extruder]")]
    own = (second, ""), ("stepper_x, stepper_z1", "stepper_x"), ("STM32F103", "chip of 2020")
    draft, machine = load(*own)
    assert (machine.board.base, machine.board.clock_hz) == ("creality-4.2.2", 72_000_000)
    assert any("creality-4.2.2" in text for text in remarks(draft, "changed"))
    _, machine = load(*own, ("heater_pin: PA2", "heater_pin: PA3"))
    assert machine.board.base == "creality-4.2.2"
    _, machine = load(*own, ("/dev/ttyACM0", "/dev/serial/by-id/usb-Klipper_stm32f446xx_1-if00"))
    assert (machine.board.base, machine.board.clock_hz) == ("creality-4.2.2", 180_000_000)
    assert load(*own, ("dir_pin: PB7", "dir_pin: PB10"))[1].board.base == "klipper"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[printer]\nkinematics: " + "x; " * 10_000, "2: the line has more than 20000 characters"),
        ("#" * (5 << 20), "more than 4194304 bytes"),
        ("\0" * 1000, "is not an option of the form"),
        ("[include *.cfg]\n", "include each other"),
        ("[printer]\nkinematics: " + "x" * 10_000, "the kind of machine is 'xxx"),
        ("[printer]\nkinematics: delta\nmax_velocity: " + "1" * 900 + "y" * 9000, "111…"),
    ],
)
def test_hostile_files_get_a_short_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "printer.cfg"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        imported(path)
    assert sentence in str(caught.value)
    assert len(str(caught.value)) < 1000


def test_includes_that_double_at_each_step_end_soon(tmp_path: Path) -> None:
    for number in range(15):
        text = f"[include {number + 1}.cfg]\n" * 2
        (tmp_path / f"{number}.cfg").write_text(text)
    (tmp_path / "15.cfg").write_text("")
    with pytest.raises(ConfigError, match="more than 1000 files are included"):
        imported(tmp_path / "0.cfg")


def test_endless_templates_are_imported_and_end_as_they_run(load) -> None:
    """What a template may take is bounded when it runs: tests/printer has that."""
    loop = "[gcode_macro LONG]\ngcode:\n  {% for i in range(99999) %}\n  G4 P{i}\n  {% endfor %}\n"
    _, machine = load(more=loop + "variable_deep: " + "[" * 5000 + "\n")
    assert "range(99999)" in machine.macros["LONG"].gcode
    assert machine.macros["LONG"].variables == {}
