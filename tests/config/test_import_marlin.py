"""Marlin's Configuration.h becomes a machine file. The configurations here are our own."""

import math
import re
from pathlib import Path

import pytest
from tests.support.import_remarks import remarks

from passo import config
from passo.cli.main import main
from passo.config.importing.formats import imported
from passo.config.importing.marlin.conversion import TABLE
from passo.config.importing.marlin.defines import Defines
from passo.errors import ConfigError

BASE = """\
/* A printer of our own: #define MOTHERBOARD BOARD_NONE
   is within a comment. */
#pragma once
#ifndef MOTHERBOARD
  #define MOTHERBOARD BOARD_RAMPS_14_EFB // the board
#endif
#define CUSTOM_MACHINE_NAME "Test // Printer"
#define EXTRUDERS 1
#define X_DRIVER_TYPE DRV8825
#define Z2_DRIVER_TYPE A4988
#define X_BED_SIZE 210
#define Y_BED_SIZE 200
#define X_MIN_POS -5
#define Y_MIN_POS 0
#define X_MAX_POS (X_BED_SIZE + 5)
#define Y_MAX_POS Y_BED_SIZE
#define Z_MAX_POS 180
#define DEFAULT_AXIS_STEPS_PER_UNIT { 80, 80.5, 3200 / 8, \\
                                      95 }
#define DEFAULT_MAX_FEEDRATE { 300, 250, 5, 25 }
#define DEFAULT_MAX_ACCELERATION { 3000, 2000, 100, 10000 }
#define DEFAULT_ACCELERATION 1500
#define DEFAULT_TRAVEL_ACCELERATION 2500
#define DEFAULT_RETRACT_ACCELERATION 3500
#define CLASSIC_JERK
#if ENABLED(CLASSIC_JERK)
  #define DEFAULT_XJERK 8.0
  #define DEFAULT_YJERK DEFAULT_XJERK
  #define DEFAULT_ZJERK 0.3
  #define DEFAULT_EJERK 5.0
#else
  #define JUNCTION_DEVIATION_MM 0.013
#endif
#define ENDSTOPPULLUPS
#define X_MIN_ENDSTOP_HIT_STATE HIGH
#define Y_MAX_ENDSTOP_HIT_STATE LOW
#define Z_MIN_ENDSTOP_INVERTING true
#define X_HOME_DIR -1
#define Y_HOME_DIR 1
#define Z_HOME_DIR -1
#define MANUAL_X_HOME_POS -4
#define HOMING_FEEDRATE_MM_M { (50*60), (40*60), (4*60) }
#define HOMING_BUMP_MM { 5, 0, 2 }
#define HOMING_BUMP_DIVISOR { 2, 4, 4 }
#define INVERT_X_DIR true
#define INVERT_Z_DIR false
#define INVERT_E0_DIR true
#define INVERT_Z2_VS_Z_DIR
#define TEMP_SENSOR_0 5
#define TEMP_SENSOR_BED 1
#define HEATER_0_MINTEMP 6
#define HEATER_0_MAXTEMP 280
#define BED_MINTEMP 7
#define BED_MAXTEMP 125
#define PIDTEMP
#if BOTH(PIDTEMP, PID_PARAMS_PER_HOTEND)
  #define DEFAULT_Kp_LIST { 1, 2 }
#else
  #define DEFAULT_Kp 21.5
  #define DEFAULT_Ki 1.25
  #define DEFAULT_Kd 86
#endif
#define MAX_BED_POWER 204
#if HAS_HOTEND && TEMP_SENSOR_BED
  #define TEMP_WINDOW 2
  #define TEMP_HYSTERESIS 4
  #define TEMP_RESIDENCY_TIME 8
  #define BED_CHECK_INTERVAL 3000
  #define BED_HYSTERESIS 1.5
#endif
#define THERMAL_PROTECTION_HOTENDS
"""
ADVANCED = """\
#if ALL(HAS_HOTEND, THERMAL_PROTECTION_HOTENDS)
  #define THERMAL_PROTECTION_PERIOD 30
  #define THERMAL_PROTECTION_HYSTERESIS 5
  #define WATCH_TEMP_PERIOD 25
  #define WATCH_TEMP_INCREASE 3
#endif
#define FAN_MIN_PWM 51
#define FAN_KICKSTART_TIME 100
#define E0_AUTO_FAN_PIN 44
#define EXTRUDER_AUTO_FAN_TEMPERATURE 45
#define EXTRUDER_AUTO_FAN_SPEED 204
#define DEFAULT_STEPPER_TIMEOUT_SEC 120
"""


@pytest.fixture
def load(tmp_path: Path):
    """A function from a Configuration.h, which changes make of BASE, to its draft and its
    machine."""

    def convert(*changes: tuple[str, str], more: str = "", advanced: str = ADVANCED):
        text = BASE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "Configuration.h"
        path.write_text(text + more, encoding="utf-8")
        path.with_name("Configuration_adv.h").write_text(advanced, encoding="utf-8")
        draft = imported(path)
        return draft, config.load_text(draft.text("From a test."), "printer.toml")

    return convert


def test_axes_and_motors_have_the_values_of_the_file(load) -> None:
    _, machine = load()
    x, y, z = (machine.axes[name] for name in "xyz")
    assert (x.min_mm, x.max_mm, x.speed_mm_s, x.accel_mm_s2) == (-5, 215, 300, 3000)
    assert (y.min_mm, y.max_mm, y.speed_mm_s) == (0, 200, 250)
    assert (z.min_mm, z.max_mm, z.jerk_mm_s) == (0, 180, 0.3)
    motors = machine.steppers
    steps = {name: motor.steps_per_unit for name, motor in motors.items()}
    assert steps == {"x": 80, "y": 80.5, "z": 400, "z1": 400, "e": 95}
    assert [motors[name].invert for name in ("x", "y", "z", "z1", "e")] == [
        True,
        False,
        False,
        True,
        True,
    ]
    assert (motors["x"].driver, motors["z1"].driver, motors["z1"].socket) == (
        "DRV8825",
        "A4988",
        "E1",
    )
    limits = machine.limits
    assert (limits.print_accel_mm_s2, limits.travel_accel_mm_s2) == (1500, 2500)
    assert (limits.retract_accel_mm_s2, limits.junction) == (3500, "jerk")
    assert (x.jerk_mm_s, y.jerk_mm_s, machine.extruders["e"].jerk_mm_s) == (8, 8, 5)
    assert (machine.bed.size_mm, machine.bed.center_mm) == ([210, 200], [105, 100])


def test_homing_has_side_pin_position_and_speeds(load) -> None:
    draft, machine = load()
    x, y, z = (machine.homing[name] for name in "xyz")
    assert (x.direction, x.position, x.pin) == ("min", -4, "^X_MIN")
    assert (x.fast, x.slow, x.retract) == (50, 25, 5)
    assert (y.direction, y.position, y.pin) == ("max", 200, "!^Y_MAX")
    assert (y.fast, y.slow, y.retract) == (40, 10, 3)
    assert (z.pin, z.fast, z.slow, z.position) == ("!^Z_MIN", 4, 1, 0)
    assert any("HOMING_BUMP_MM" in text for text in remarks(draft, "changed"))


def test_stall_homing_has_threshold_current_and_speed(load) -> None:
    """X and Y of a TMC2130 each, whose DIAG outputs are on the pins of the switches."""
    driver = "#define {0}_CURRENT 500\n#define {0}_CURRENT_HOME (500/2)\n#define {0}_CS_PIN {1}\n"
    more = "#define SENSORLESS_HOMING\n#define X_STALL_SENSITIVITY 3\n"
    more += "#define Y_STALL_SENSITIVITY -4\n#define TMC_SW_SCK 52\n#define TMC_SW_MOSI 51\n"
    more += "#define TMC_SW_MISO 50\n#define TMC_USE_SW_SPI\n"
    more += driver.format("X", 63) + driver.format("Y", 40)
    drivers = "X_DRIVER_TYPE TMC2130\n#define Y_DRIVER_TYPE TMC2130"
    draft, machine = load(("X_DRIVER_TYPE DRV8825", drivers), more=more)
    x, y = machine.homing["x"], machine.homing["y"]
    assert x.stall is not None and y.stall is not None
    assert (x.stall.threshold, x.stall.current_a, x.fast) == (3, 0.25, 50)
    assert (y.stall.threshold, y.direction, y.position) == (-4, "max", 200)
    assert x.pin is None
    tmc = machine.steppers["x"].tmc
    assert tmc is not None and tmc.diag1_pin is not None and "X_MIN" in tmc.diag1_pin
    assert not [r for r in draft.remarks if "STALL" in r.what]


RUNOUT = "#define FILAMENT_RUNOUT_SENSOR\n#define FIL_RUNOUT_STATE {}\n#define FIL_RUNOUT_PULLUP\n"


def test_runout_switch_pauses_prints(load) -> None:
    more = RUNOUT.format("HIGH") + "#define FIL_RUNOUT_PIN 57\n"
    more += "#define FILAMENT_RUNOUT_DISTANCE_MM 25\n#define FIL_RUNOUT_ENABLED_DEFAULT false\n"
    draft, machine = load(more=more)
    sensor = machine.filament_sensors["runout"]
    assert (sensor.kind, sensor.delay_mm, sensor.enabled) == ("switch", 25, False)
    assert sensor.pin.startswith("!^")
    assert not [r for r in draft.remarks if "RUNOUT" in r.what]
    _, machine = load(more=f"{more}#define FILAMENT_MOTION_SENSOR\n".replace("HIGH", "LOW"))
    sensor = machine.filament_sensors["runout"]
    assert (sensor.kind, sensor.length_mm, sensor.pin[0]) == ("motion", 25, "^")


def test_runout_switch_without_a_pin_is_for_the_owner(load) -> None:
    draft, machine = load(more=RUNOUT.format("LOW"))
    assert machine.filament_sensors == {}
    assert "[filament_sensors.runout] pin" in "".join(remarks(draft, "decide"))


def test_homing_that_passo_does_not_have_is_reported(load) -> None:
    more = "#define SENSORLESS_HOMING\n#define Y_STALL_SENSITIVITY 8\n"
    more += "#define Z_SAFE_HOMING\n#define Z_HOMING_HEIGHT 4\n"
    draft, machine = load(more=more)
    assert "y" not in machine.homing and machine.home_mm["y"] == 200
    assert "takes it to be at 200 mm" in "".join(remarks(draft, "decide"))
    dropped = "".join(remarks(draft, "dropped"))
    assert "Z homes where the nozzle is" in dropped and "Z_HOMING_HEIGHT" in dropped
    draft, _ = load(("(4*60) }", "(5*60) }"), more=f"{PROBE}#define BLTOUCH\n")
    assert "the probe homes Z with its own speeds" in "".join(remarks(draft, "changed"))


def test_heaters_have_sensors_gains_limits_and_protections(load) -> None:
    draft, machine = load()
    hotend, bed = machine.heaters["hotend"], machine.heaters["bed"]
    assert (hotend.pin, hotend.sensor_pin, hotend.min_c, hotend.max_c) == ("D10", "T0", 6, 280)
    assert (hotend.sensor.r25_ohm, hotend.sensor.beta_k) == (99_005, 4682.8)
    gains = hotend.control.model_dump(include={"kp", "ki", "kd"})
    assert gains == {"kp": 21.5, "ki": 1.25, "kd": 86}
    protection = hotend.protection
    assert (protection.watch_s, protection.watch_rise_c) == (25, 3)
    assert (protection.runaway_s, protection.runaway_c) == (30, 5)
    arrival = hotend.arrival
    assert (arrival.window_c, arrival.leaves_c, arrival.seconds) == (2, 4, 8)
    assert (bed.control.kind, bed.control.hysteresis_c, bed.control.interval_s) == (
        "bang-bang",
        1.5,
        3,
    )
    assert (bed.min_c, bed.max_c, bed.max_power) == (7, 125, pytest.approx(0.8))
    assert any("THERMAL_PROTECTION_BED is off" in text for text in remarks(draft, "changed"))


def test_part_hotend_and_board_fans_are_imported(load) -> None:
    more = "#define USE_CONTROLLER_FAN\n#define CONTROLLER_FAN_PIN 6\n"
    _, machine = load(advanced=ADVANCED + more + "#define CONTROLLERFAN_IDLE_TIME 15\n")
    part, hotend, board = (machine.fans[name] for name in ("part", "hotend_fan", "board"))
    assert (part.pin, part.min_power, part.kick_start_s) == ("D9", 0.2, 0.1)
    assert (hotend.pin, hotend.follows, hotend.above_c) == ("D44", "hotend", 45)
    assert hotend.max_power == pytest.approx(0.8)
    assert (board.pin, board.stays_on_s) == ("D6", 15)
    assert board.follows_motors == ["x", "y", "z", "z1", "e"]
    assert machine.idle.motors_off_s == 120


def test_junction_deviation_is_used_without_classic_jerk(load) -> None:
    _, machine = load(("#define CLASSIC_JERK\n", ""))
    assert (machine.limits.junction, machine.limits.junction_deviation_mm) == ("deviation", 0.013)


PROBE = """\
#define Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN
#define NOZZLE_TO_PROBE_OFFSET { -40, 12, -1.35 }
#define XY_PROBE_FEEDRATE (133*60)
#define Z_PROBE_FEEDRATE_FAST (4*60)
#define Z_PROBE_FEEDRATE_SLOW (Z_PROBE_FEEDRATE_FAST / 2)
#define MULTIPLE_PROBING 3
#define Z_CLEARANCE_BETWEEN_PROBES 6
#define Z_PROBE_LOW_POINT -3
#define PROBING_MARGIN 15
#define Z_SAFE_HOMING
#define Z_SAFE_HOMING_X_POINT ((X_BED_SIZE) / 4)
#define Z_SAFE_HOMING_Y_POINT 60
"""


@pytest.mark.parametrize(
    ("define", "kind", "control"),
    [
        ("#define BLTOUCH", "bltouch", "SERVO0"),
        ("#define FIX_MOUNTED_PROBE", "fixed", None),
        ("#define NOZZLE_AS_PROBE", "nozzle", None),
        ("#define Z_PROBE_SERVO_NR 1\n#define Z_SERVO_ANGLES { 80, 10 }", "servo", "SERVO1"),
    ],
)
def test_marlin_probe_homes_z(load, define: str, kind: str, control: str | None) -> None:
    _, machine = load(more=f"{PROBE}{define}\n")
    probe = machine.probe
    assert (probe.kind, probe.pin, probe.offset_mm) == (kind, "!^Z_MIN", [-40, 12])
    assert (probe.trigger_height_mm, probe.low_mm, probe.start_mm) == (1.35, -1.65, 6)
    assert (probe.travel_mm_s, probe.fast_mm_s, probe.slow_mm_s) == (133, 4, 2)
    assert (probe.samples, getattr(probe, "control_pin", None)) == (3, control)
    if kind == "servo":
        assert (probe.deploy_deg, probe.stow_deg) == (80, 10)
    home = machine.homing["z"]
    assert (home.probe, home.probe_at_mm, home.position) == (True, [52, 60], 1.35)


@pytest.mark.parametrize(
    ("define", "method", "smooth"),
    [
        ("AUTO_BED_LEVELING_BILINEAR", "mesh", "bilinear"),
        ("AUTO_BED_LEVELING_UBL\n#define ABL_BILINEAR_SUBDIVISION", "mesh", "bicubic"),
        ("AUTO_BED_LEVELING_3POINT", "linear", None),
        ("AUTO_BED_LEVELING_LINEAR", "linear", None),
    ],
)
def test_levelling_within_the_margins(load, define: str, method: str, smooth: str | None) -> None:
    grid = "#define GRID_MAX_POINTS_X 4\n#define GRID_MAX_POINTS_Y GRID_MAX_POINTS_X\n"
    _, machine = load(more=f"{PROBE}#define BLTOUCH\n#define {define}\n{grid}")
    levelling = machine.levelling
    assert levelling.method == method
    if smooth is None:
        x = sorted({point.x for point in levelling.points})
        assert (x[0], x[-1]) == (15, 175)  # the probe is 40 mm left of a nozzle that gets to 215
    else:
        assert levelling.area == [15, 15, 175, 185]
        assert (levelling.count, levelling.interpolation) == ([4, 4], smooth)


def test_mesh_by_hand_without_a_probe(load) -> None:
    _, machine = load(more="#define MESH_BED_LEVELING\n#define MESH_INSET 20\n")
    assert machine.probe.kind == "manual"
    assert machine.levelling.area == [20, 20, 190, 180]
    assert machine.homing["z"].pin == "!^Z_MIN"


def test_marlin_screws_and_z_motors_are_imported(load) -> None:
    more = """\
#define ASSISTED_TRAMMING
#define TRAMMING_POINT_XY { { 20, 21 }, { 170, 20 } }
#define TRAMMING_POINT_NAME_1 "left"
#define TRAMMING_SCREW_THREAD M4_CCW
#define Z_STEPPER_AUTO_ALIGN
#define Z_STEPPER_ALIGN_STEPPER_XY { { -20, 100 }, { 230, 100 } }
#define Z_STEPPER_ALIGN_XY { { 15, 100 }, { 170, 100 } }
#define Z_STEPPER_ALIGN_ITERATIONS 7
#define Z_STEPPER_ALIGN_ACC 0.05
"""
    _, machine = load(more=f"{PROBE}#define BLTOUCH\n", advanced=ADVANCED + more)
    screws, motors = machine.levelling.screws, machine.levelling.motors
    assert screws.thread == "M4 ccw"
    assert [(s.name, s.x, s.y) for s in screws.places] == [("left", 20, 21), ("screw 2", 170, 20)]
    assert motors.pivots == {"z": [-20, 100], "z1": [230, 100]}
    assert [(p.x, p.y) for p in motors.points] == [(15, 100), (170, 100)]
    assert (motors.retries, motors.tolerance_mm) == (7, 0.05)


def test_an_endstop_for_each_motor(load) -> None:
    more = "#define Z_MULTI_ENDSTOPS\n#define Z2_USE_ENDSTOP _ZMAX_\n"
    _, machine = load(advanced=ADVANCED + more)
    assert machine.homing["z"].stepper_pins == {"z": "!^Z_MIN", "z1": "!^Z_MAX"}
    draft, machine = load(advanced=f"{ADVANCED}#define Z_DUAL_ENDSTOPS\n")
    assert machine.homing["z"].pin == "!^Z_MIN"
    assert any("Z_DUAL_ENDSTOPS" in text for text in remarks(draft, "decide"))


def test_two_extruders_have_tools_and_their_own_values(load) -> None:
    _, machine = load(
        ("EXTRUDERS 1", "EXTRUDERS 2"),
        ("BOARD_RAMPS_14_EFB", "BOARD_RAMPS_14_EEB"),
        ("#define Z2_DRIVER_TYPE A4988\n", ""),
        ("95 }", "95, 190 }"),
        ("25 }", "25, 26 }"),
        more="#define TEMP_SENSOR_1 -1\n#define HEATER_1_MINTEMP 5\n"
        "#define HEATER_1_MAXTEMP 300\n#define HOTEND_OFFSET_X { 0.0, 18.5 }\n"
        "#define LIN_ADVANCE\n#define ADVANCE_K { 0.1, 0.2 }\n",
        advanced="",
    )
    assert machine.steppers["e1"].steps_per_unit == 190
    assert machine.steppers["e1"].socket == "E1"
    assert [machine.extruders[name].speed_mm_s for name in ("e", "e1")] == [25, 26]
    assert [machine.extruders[name].advance_s for name in ("e", "e1")] == [0.1, 0.2]
    assert (machine.tools[1].extruder, machine.tools[1].heater) == ("e1", "hotend1")
    assert machine.tools[1].offset_mm == [18.5, 0, 0]
    assert machine.heaters["hotend1"].sensor.kind == "ad595"
    assert "part" not in machine.fans


def test_drivers_with_registers(load) -> None:
    more = """\
#define X_CURRENT 760
#define HOLD_MULTIPLIER 0.5
#define X_MICROSTEPS 16
#define X_RSENSE 0.11
#define X_SERIAL_TX_PIN 40
#define X_SERIAL_RX_PIN 63
#define X_SLAVE_ADDRESS 2
#define STEALTHCHOP_XY
#define HYBRID_THRESHOLD
#define X_HYBRID_THRESHOLD 90
#define Y_CURRENT 800
"""
    draft, machine = load(
        (
            "X_DRIVER_TYPE DRV8825",
            "X_DRIVER_TYPE TMC2209\n#define Y_DRIVER_TYPE TMC2208_STANDALONE",
        ),
        ("Z2_DRIVER_TYPE A4988", "Z_DRIVER_TYPE TMC2209\n#define Z2_DRIVER_TYPE L6470"),
        advanced=ADVANCED + more,
    )
    x = machine.steppers["x"]
    assert (x.driver, x.microsteps, machine.steppers["y"].driver) == ("TMC2209", 16, "TMC2208")
    tmc = x.tmc
    assert (tmc.run_current_a, tmc.hold_current_a, tmc.sense_resistor_ohm) == (0.76, 0.38, 0.11)
    assert (tmc.uart_pin, tmc.tx_pin, tmc.address) == ("D63", "D40", 2)
    assert tmc.stealthchop_below_mm_s == 90
    assert machine.steppers["y"].tmc is None
    assert any("Z_DRIVER_TYPE" in text for text in remarks(draft, "decide"))
    assert any("L6470" in text for text in remarks(draft, "changed"))


@pytest.mark.parametrize(
    ("board", "base", "sockets", "wire"),
    [
        ("BTT_SKR_MINI_E3_V2_0", "skr-mini-e3-v2", ["X", "Y", "Z", "E0"], ("PC11", "PC10", 2)),
        (
            "BTT_OCTOPUS_V1_1",
            "octopus",
            ["MOTOR0", "MOTOR1", "MOTOR2", "MOTOR4"],
            ("PD11", None, 0),
        ),
    ],
)
def test_boards_with_the_firmware_of_klipper(load, board, base, sockets, wire) -> None:
    _, machine = load(
        ("BOARD_RAMPS_14_EFB", f"BOARD_{board}"),
        (
            "#define Z2_DRIVER_TYPE A4988\n",
            "#define Y_DRIVER_TYPE TMC2209\n#define Y_CURRENT 600\n",
        ),
        ("Y_HOME_DIR 1", "Y_HOME_DIR -1"),
        advanced="",
    )
    assert machine.board.base == base
    assert [machine.steppers[name].socket for name in ("x", "y", "z", "e")] == sockets
    tmc = machine.steppers["y"].tmc
    send = machine.pin(tmc.tx_pin) if tmc.tx_pin else None
    assert (machine.pin(tmc.uart_pin), send, tmc.address) == wire


def test_marlin_shapers_are_imported(load) -> None:
    more = "#define INPUT_SHAPING_X\n#define SHAPING_FREQ_X 41.5\n#define SHAPING_ZETA_X 0.15f\n"
    more += "#define FT_MOTION\n#define FTM_IS_DEFAULT_MOTION\n"
    more += "#define FTM_DEFAULT_SHAPER_Y ftMotionShaper_2HEI\n"
    more += "#define FTM_SHAPING_DEFAULT_FREQ_Y 37.0f\n"
    _, machine = load(advanced=ADVANCED + more)
    x, y = machine.shaping["x"], machine.shaping["y"]
    assert (x.type, x.frequency_hz, x.damping) == ("zv", 41.5, 0.15)
    assert (y.type, y.frequency_hz) == ("2hump_ei", 37)


def test_marlin_backlash_is_imported(load) -> None:
    more = "#define BACKLASH_COMPENSATION\n#define BACKLASH_DISTANCE_MM { 0.2, 0.1, 0 }\n"
    more += "#define BACKLASH_CORRECTION 0.5\n#define BACKLASH_SMOOTHING_MM 2\n"
    _, machine = load(advanced=ADVANCED + more)
    assert machine.gaps_mm == {"x": 0.1, "y": 0.05, "z": 0}
    assert machine.backlash.smooth_mm == 2
    draft, machine = load(advanced=ADVANCED + more.replace("CORRECTION 0.5", "CORRECTION 0.0"))
    assert set(machine.gaps_mm.values()) == {0}
    assert any("no gap is corrected" in text for text in remarks(draft, "dropped"))


def test_marlin_heater_model_is_imported(load) -> None:
    """A block of 20 J/K that loses 0.08 W/K is 500 K above the room at 40 W, in 250 s."""
    more = "#define MPCTEMP\n#define MPC_HEATER_POWER { 40.0f }\n#define MPC_INCLUDE_FAN\n"
    more += "#define MPC_BLOCK_HEAT_CAPACITY { 20 }\n#define MPC_AMBIENT_XFER_COEFF { 0.08 }\n"
    more += "#define MPC_SENSOR_RESPONSIVENESS { 0.2 }\n"
    more += "#define MPC_AMBIENT_XFER_COEFF_FAN255 { 0.1 }\n"
    _, machine = load(("#define PIDTEMP\n", ""), more=more)
    hotend = machine.heaters["hotend"]
    assert hotend.control.kind == "model"
    assert (hotend.model.rise_c, hotend.model.time_constant_s) == (500, 250)
    assert (hotend.model.sensor_lag_s, hotend.model.fan_loss) == (5, 0.25)


def test_marlin_converters_and_amplifiers_are_imported(load) -> None:
    custom = "#define HOTEND0_PULLUP_RESISTOR_OHMS 2200\n#define HOTEND0_BETA 4000\n"
    custom += "#define HOTEND0_RESISTANCE_25C_OHMS 99000\n#define HOTEND0_SH_C_COEFF 1e-7\n"
    _, machine = load(("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 1000"), advanced=custom)
    sensor = machine.heaters["hotend"].sensor
    assert (sensor.r25_ohm, sensor.beta_k, sensor.c_per_k, sensor.pullup_ohm) == (
        99_000,
        4000,
        1e-7,
        2200,
    )
    converter = "#define TEMP_0_CS_PIN 66\n#define MAX31865_SENSOR_OHMS_0 1000\n"
    converter += "#define MAX31865_CALIBRATION_OHMS_0 4300\n"
    _, machine = load(("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 -5"), more=converter)
    hotend = machine.heaters["hotend"]
    assert (hotend.sensor.kind, hotend.sensor.r0_ohm, hotend.sensor_pin) == (
        "max31865",
        1000,
        "D66",
    )
    assert hotend.sensor.clock_pin == "PB1"


def test_marlin_delta_is_imported(load) -> None:
    """A carriage is √(rod² - radius²) above the nozzle; a trim of -0.5 puts its switch higher."""
    _, machine = load(
        ("#define Z2_DRIVER_TYPE A4988\n", ""),
        more="#define DELTA\n#define DELTA_RADIUS 120\n#define DELTA_DIAGONAL_ROD 200\n"
        "#define DELTA_HEIGHT 250\n#define PRINTABLE_RADIUS 90\n"
        "#define DELTA_ENDSTOP_ADJ { 0, -0.5, 0 }\n#define DELTA_TOWER_ANGLE_TRIM { 1, 0, 0 }\n"
        "#define DELTA_DIAGONAL_ROD_TRIM_TOWER { 0, 0, 0 }\n",
    )
    geometry = machine.geometry
    assert (geometry.kind, geometry.radius, geometry.rods) == ("delta", 120, [200, 200, 200])
    assert (geometry.angles, geometry.limit_radius) == ([211, 330, 90], 90)
    assert [machine.homing[tower].position for tower in "abc"] == [410, 410.5, 410]
    assert (machine.axes["z"].max_mm, machine.axes["x"].min_mm) == (250, -90)
    assert machine.steppers["a"].speed_mm_s == 300
    assert machine.bed.round


MORGAN, MP = "#define MORGAN_SCARA\n", "#define MP_SCARA\n"
ARMS = (
    "#define SCARA_LINKAGE_1 150\n#define SCARA_LINKAGE_2 150\n"
    "#define SCARA_OFFSET_X 20\n#define SCARA_OFFSET_Y -50\n"
)
ANGLES = "#define SCARA_OFFSET_THETA1 10\n#define SCARA_OFFSET_THETA2 80\n"


@pytest.mark.parametrize(
    ("more", "ends"),
    [
        # The shoulder is at X 20, Y -50. The arms, of 150 mm each, make a right angle where the
        # end is 150 mm to one side of the shoulder, and 150 mm above.
        (f"{MORGAN}#define MANUAL_X_HOME_POS 170\n#define MANUAL_Y_HOME_POS 100\n", (0, 90)),
        (f"{MP}#define MANUAL_X_HOME_POS -130\n#define MANUAL_Y_HOME_POS 100\n", (90, 90)),
        (f"{MORGAN}{ANGLES}", (10, 80)),
    ],
)
def test_marlin_scara_is_imported(load, more: str, ends: tuple[float, float]) -> None:
    draft, machine = load(more=f"{ARMS}{more}")
    geometry = machine.geometry
    assert (geometry.kind, geometry.arm1, geometry.arm2) == ("scara", 150, 150)
    assert (geometry.x_offset, geometry.y_offset) == (20, -50)
    assert geometry.external_motor == (MORGAN in more)
    motor = machine.steppers["a"]
    assert (motor.steps_per_degree, motor.speed_deg_s, motor.accel_deg_s2) == (80, 300, 3000)
    assert (machine.steppers["z"].steps_per_mm, machine.axes["z"].speed_mm_s) == (400, 5)
    assert machine.axes["y"].speed_mm_s == pytest.approx(250 * math.pi / 180 * 300, rel=1e-5)
    homes = machine.homing["a"].position, machine.homing["b"].position
    assert homes == pytest.approx(ends, abs=1e-4)
    assert "min_deg and max_deg" in remarks(draft, "decide")[0]


@pytest.mark.parametrize(
    ("length", "limit"), [(150, "the arms reach from 0.010 to 299.990 mm"), (0, "in reach")]
)
def test_scara_that_does_not_reach_its_home(load, length: float, limit: str) -> None:
    home = "#define MANUAL_X_HOME_POS 400\n#define MANUAL_Y_HOME_POS 100\n"
    with pytest.raises(ConfigError) as caught:
        load(more=f"{ARMS.replace('LINKAGE_1 150', f'LINKAGE_1 {length}')}{MP}{home}")
    assert "MANUAL_X_HOME_POS is '400, 100'" in str(caught.value)
    assert limit in str(caught.value)


def test_marlin_core_belts_are_imported(load) -> None:
    _, machine = load(more="#define COREYX\n")
    assert machine.geometry.kind == "corexy"
    assert (machine.steppers["a"].invert, machine.steppers["b"].invert) == (True, True)


def test_power_laser_park_and_skew(load) -> None:
    more = """\
#define PSU_CONTROL
#define PSU_ACTIVE_STATE LOW
#define PSU_DEFAULT_OFF
#define LASER_FEATURE
#define SPINDLE_LASER_PWM_PIN 4
#define CUTTER_POWER_UNIT PERCENT
#define NOZZLE_PARK_FEATURE
#define NOZZLE_PARK_POINT { (X_MIN_POS + 10), 190, 20 }
#define NOZZLE_PARK_XY_FEEDRATE 90
#define SKEW_CORRECTION
#define XY_SKEW_FACTOR 0.01
#define YZ_DIAG_AC 141.5
#define YZ_DIAG_BD 141
#define YZ_SIDE_AD 100
#define REPRAP_DISCOUNT_SMART_CONTROLLER
#define INPUT_SHAPING_X
"""
    draft, machine = load(more=more)
    assert (machine.mains.pin, machine.mains.on_at_start) == ("!PS_ON", False)
    assert (machine.laser.pin, machine.laser.full_scale) == ("D4", 100)
    assert (machine.park.position_mm, machine.park.raise_mm) == ([5, 190], 20)
    assert machine.park.speed_mm_s == 90
    assert machine.board.fitted == ["reprap-discount-smart"]
    assert any(
        "M852 I0.01, SET_SKEW YZ=141.5,141,100 and M500" in text
        for text in remarks(draft, "decide")
    )


def test_marlin_report_names_unsupported_options(load) -> None:
    more = "#define SDSUPPORT\n#define S_CURVE_ACCELERATION\n#define MY_OWN_OPTION 3\n"
    more += "#if HAS_SOMETHING\n  #define BED_CENTER_AT_0_0\n#endif\n#define FWRETRACT false\n"
    draft, _ = load(more=more)
    assert any("SDSUPPORT: passo serve" in text for text in remarks(draft, "changed"))
    dropped = remarks(draft, "dropped")
    assert any("S_CURVE_ACCELERATION" in text for text in dropped)
    assert any(text.endswith("no such setting: MY_OWN_OPTION") for text in dropped)
    assert not any("FWRETRACT" in text for text in dropped)
    undecided = [text for text in remarks(draft, "decide") if "HAS_SOMETHING" in text]
    assert len(undecided) == 1
    assert "BED_CENTER_AT_0_0" in undecided[0]


def test_comments_name_line_and_file(load, tmp_path: Path) -> None:
    draft, _ = load()
    text = draft.text("")
    assert "print_accel_mm_s2 = 1500.0  # Configuration.h:22" in text
    assert "watch_s = 25.0  # Configuration_adv.h:4" in text


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("#define HEATER_0_MAXTEMP 280\n", "", "HEATER_0_MAXTEMP"),
        ("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 999", "nothing would stop the heater"),
        ("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 666", "a sensor that Passo has"),
    ],
)
def test_heater_without_a_sure_sensor_is_left_out(load, old: str, new: str, reason: str) -> None:
    draft, machine = load((old, new))
    assert [*machine.heaters] == ["bed"]
    assert machine.extruders["e"]
    found = [text for text in remarks(draft, "decide") if "the part is left out" in text]
    assert len(found) == 1 and "TEMP_SENSOR_0" in found[0] and reason in found[0]


@pytest.mark.parametrize(
    ("written", "base"),
    [
        ("33", "ramps"),
        ("BOARD_MKS_13", "mks-gen"),
        ("47", "mks-gen"),
        ("89", "melzi"),
        ("BOARD_RAMPS_CREALITY", "ramps"),
        ("BOARD_TRIGORILLA", "ramps"),
    ],
)
def test_older_names_and_numbers_of_boards(load, written: str, base: str) -> None:
    draft, machine = load(("BOARD_RAMPS_14_EFB", written))
    assert machine.board.base == base
    assert not any("no file of the board" in text for text in remarks(draft, "decide"))


@pytest.mark.parametrize(("written", "name"), [("301", "RAMBO"), ("BOARD_TL_V101", "TL_V101")])
def test_machine_with_an_unknown_board_is_simulated(load, written: str, name: str) -> None:
    draft, machine = load(("BOARD_RAMPS_14_EFB", written))
    assert (machine.board.base, machine.board.link) == ("octopus", "simulated")
    assert f"Passo has no file of the board {name}" in "\n".join(remarks(draft, "decide"))
    assert {"x", "y", "z", "e"} <= machine.steppers.keys()


def test_board_of_the_user_counts_before_motherboard(tmp_path: Path) -> None:
    path = tmp_path / "Configuration.h"
    path.write_text(BASE.replace("BOARD_RAMPS_14_EFB", "301"))
    machine = config.load_text(imported(path, board="skr-1.4").text(""), "x.toml")
    assert (machine.board.base, machine.steppers["x"].socket) == ("skr-1.4", "X")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("TEMP_SENSOR_BED 1", "TEMP_SENSOR_BED EPCOS", "EPCOS is not defined"),
        ("#define EXTRUDERS 1", "#define POLAR", "POLAR"),
        ("EXTRUDERS 1", "EXTRUDERS 1e9", "a whole number from 0 to 8"),
        ("EXTRUDERS 1", "EXTRUDERS 1.5", "a whole number from 0 to 8"),
        ("200\n", "1e999\n", "a number from -1e+12"),
        ("200\n", "(1e999 - 1e999)\n", "a number from -1e+12"),
        ("#define DEFAULT_MAX_FEEDRATE { 300, 250, 5, 25 }", "", "DEFAULT_MAX_FEEDRATE"),
        ("200\n", "(1 / 0)\n", "a number"),
        ("#pragma once", "#if 1", "#if has no"),
        ("#pragma once", "#else", "#else has no"),
    ],
)
def test_errors_name_the_line(load, old: str, new: str, sentence: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load((old, new))
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("#if 1\n" * 200, "more than 100 conditions"),
        ("#define A " + "1+" * 20_000, "more than 20000 characters"),
        ("#define MOTHERBOARD M\n#define M MOTHERBOARD\n", "DEFAULT_MAX_FEEDRATE is not"),
        ('#include "Configuration.h"\n', "include each other"),
        ("\0" * 1000, "MOTHERBOARD is not defined"),
        ("/*" + "\n" * 100_000, "MOTHERBOARD is not defined"),
        ("x" * (5 << 20), "more than 4194304 bytes"),
        (
            "#define MOTHERBOARD BOARD_RADDS\n#define EXTRUDERS (A)\n#define A (B*B)\n"
            "#define B (C*C)\n#define C (A+A)\n",
            "a number",
        ),
        ("#define MOTHERBOARD BOARD_RADDS\n#define EXTRUDERS " + "(" * 900, "a number"),
        ("#define MOTHERBOARD BOARD_RADDS\n#define EXTRUDERS " + "1" * 5000, "a number"),
        ("#define MOTHERBOARD BOARD_RADDS\n#define EXTRUDERS 9999999<<31<<31<<31", "a number"),
    ],
)
def test_hostile_files_get_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "Configuration.h"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        imported(path)
    assert sentence in str(caught.value)


STUFW = """\
#define CONFIGURATION_OVERALL
#define MOTHERBOARD RAMPS_13_HFB
#define MECHANISM COREXY
#define TEMP_SENSOR_0 2
#define TEMP_SENSOR_BED 9
#define T9_R25 120000
#define T9_BETA 4036
#define THERMISTOR_SERIES_RS 4600
#define HEATER_0_MAXTEMP 275
#define HEATER_0_MINTEMP 5
#define BED_MAXTEMP 150
#define BED_MINTEMP 5
#define PIDTEMP true
#define DEFAULT_Kp {40, 40}
#define DEFAULT_Ki {07}
#define DEFAULT_Kd {60}
#define PIDTEMPBED false
#define ENDSTOPPULLUP_XMIN
#define X_MIN_ENDSTOP_LOGIC true
#define X_HOME_DIR -1
#define X_MAX_POS 200
#define Y_MAX_POS 200
#define Z_MAX_POS 200
#define DEFAULT_AXIS_STEPS_PER_UNIT {80, 80, 4000, 625}
#define DEFAULT_MAX_FEEDRATE {300, 300, 2, 100}
#define DEFAULT_MAX_ACCELERATION {3000, 3000, 50, 3000}
#define DEFAULT_XJERK 10.0
#define HOMING_FEEDRATE_X (100*60)
#define HOMING_FEEDRATE_Z (2*60)
#define X_HOME_BUMP_MM 5
"""


def test_configuration_of_mk4duo_and_stufw(tmp_path: Path) -> None:
    path = tmp_path / "Configuration_Overall.h"
    more = "#define PIDTEMP true\n#define PID_DRIVE_MIN {51}\n#define PID_DRIVE_MAX {204}\n"
    more += "#define DEFAULT_RETRACT_ACCELERATION {10000}\n#define PREHEAT_1_HOTEND 190\n"
    path.write_text(f"{STUFW}{more}#define PREHEAT_1_BED 60\n", encoding="utf-8")
    draft = imported(path)
    machine = config.load_text(draft.text(""), "printer.toml")
    control = machine.heaters["hotend"].control
    assert (control.drive_min, control.drive_max) == (0.2, 0.8)
    assert machine.limits.retract_accel_mm_s2 == 10_000
    assert any("M145 S0 H190 B60 sets it" in text for text in remarks(draft, "decide"))
    assert (machine.geometry.kind, machine.board.variant) == ("corexy", "HFB")
    hotend, bed = machine.heaters["hotend"].sensor, machine.heaters["bed"].sensor
    assert (hotend.r25_ohm, hotend.beta_k, hotend.pullup_ohm) == (100_000, 3950, 4600)
    assert (bed.r25_ohm, bed.beta_k) == (120_000, 4036)
    assert machine.heaters["hotend"].control.kp == 40
    assert machine.heaters["bed"].control.kind == "bang-bang"
    assert (machine.homing["x"].pin, machine.homing["y"].pin) == ("!^X_MIN", "Y_MIN")
    assert (machine.homing["x"].fast, machine.homing["z"].fast) == (100, 2)


DUMP = """\
echo:; Steps per unit:
echo:  M92 X80.50 Y81.00 Z401.00 E96.10
echo:  M203 X310.00 Y260.00 Z6.00 E30.00 ; units/s
echo:  M201 X3100.00 Y2100.00 Z110.00 E9000.00
echo:  M204 P1400.00 R3300.00 T2400.00
echo:  M205 B20000.00 S0.00 T0.00 X9.00 Y9.50 Z0.40 E4.00
echo:  M301 P20.10 I1.30 D80.00
echo:  M851 X-41.00 Y11.00 Z-1.80
echo:  M900 K0.08
echo:  M593 X F44.00 D0.12
echo:  M206 X0.00 Y1.00 Z0.00
echo:  M281 P0 L66.00 U2.00
echo:  M906 X620 E480
echo:  M907 X3
echo:  M145 S0 H185.00 B45.00 F255
ok
"""


def test_values_of_m503_override_the_configuration(load, tmp_path: Path) -> None:
    more = f"{PROBE}#define BLTOUCH\n#define INPUT_SHAPING_X\n#define SHAPING_FREQ_X 40\n"
    _, before = load(more=f"{more}#define LIN_ADVANCE\n#define ADVANCE_K 0\n")
    ends = before.homing
    dump = tmp_path / "m503.txt"
    dump.write_text(DUMP, encoding="utf-8")
    draft = imported(tmp_path / "Configuration.h", dump)
    machine = config.load_text(draft.text("From a test."), "printer.toml")
    steps = {name: motor.steps_per_unit for name, motor in machine.steppers.items()}
    assert steps == {"x": 80.5, "y": 81, "z": 401, "z1": 401, "e": 96.1}
    assert (machine.axes["z"].speed_mm_s, machine.axes["y"].accel_mm_s2) == (6, 2100)
    assert (machine.axes["y"].jerk_mm_s, machine.extruders["e"].jerk_mm_s) == (9.5, 4)
    assert (machine.extruders["e"].speed_mm_s, machine.extruders["e"].accel_mm_s2) == (30, 9000)
    limits = machine.limits
    assert (limits.print_accel_mm_s2, limits.travel_accel_mm_s2) == (1400, 2400)
    assert (limits.retract_accel_mm_s2, machine.heaters["hotend"].control.ki) == (3300, 1.3)
    probe = machine.probe
    assert (probe.offset_mm, probe.trigger_height_mm, probe.low_mm) == ([-41, 11], 1.8, -1.2)
    assert machine.extruders["e"].advance_s == 0.08
    assert (machine.shaping["x"].frequency_hz, machine.shaping["x"].damping) == (44, 0.12)
    dropped = [text for text in remarks(draft, "dropped") if text.startswith("m503.txt")]
    assert len(dropped) == 1
    assert "M907 X3" in dropped[0]
    assert machine.homing["y"].position == ends["y"].position + 1
    assert "steps_per_mm = 80.5  # m503.txt:2" in draft.text("")
    for line, match in (
        ("M92 X8.0.5", "M92 X is '8.0.5'"),
        ("M92 X" + "9" * 400, "a number from -1e"),
        ("M301 E1.5 P20", "M301 E is '1.5'"),
    ):
        dump.write_text(f"{line}\n", encoding="utf-8")
        with pytest.raises(ConfigError, match=f"m503.txt:1: .*{match}"):
            imported(tmp_path / "Configuration.h", dump)


def test_stored_servo_currents_and_nozzles(load, tmp_path: Path) -> None:
    servo = f"{PROBE}#define Z_PROBE_SERVO_NR 0\n#define TMC_SW_SCK 65\n"
    servo += "#define X_CURRENT 500\n#define X_SERIAL_RX_PIN 63\n"
    changes = (("EXTRUDERS 1", "EXTRUDERS 2"), ("#define Z2_DRIVER_TYPE A4988\n", ""))
    load(*changes, ("X_DRIVER_TYPE DRV8825", "X_DRIVER_TYPE TMC2209"), more=servo)
    dump = tmp_path / "m503.txt"
    dump.write_text(f"{DUMP}echo:  M218 T1 X25.00 Y-1.50\necho:  M218 T7 X1\n", encoding="utf-8")
    draft = imported(tmp_path / "Configuration.h", dump)
    machine = config.load_text(draft.text("From a test."), "printer.toml")
    assert (machine.probe.deploy_deg, machine.probe.stow_deg) == (66, 2)
    assert machine.steppers["x"].tmc.run_current_a == 0.62
    assert machine.tools[1].offset_mm == [25, -1.5, 0]
    assert any("M218 T7 X1" in text for text in remarks(draft, "dropped"))


def test_stored_geometry_of_a_delta(load, tmp_path: Path) -> None:
    load(
        ("#define Z2_DRIVER_TYPE A4988\n", ""),
        more="#define DELTA\n#define DELTA_RADIUS 100\n#define DELTA_DIAGONAL_ROD 190\n"
        "#define DELTA_HEIGHT 240\n#define PRINTABLE_RADIUS 90\n"
        "#define DELTA_ENDSTOP_ADJ { 0, -0.25, 0 }\n",
    )
    dump = tmp_path / "m503.txt"
    rods = "L200.00 R120.00 H250.00 S80.00 X1.00 Y0.00 Z-0.50"

    def machine(text: str) -> config.MachineConfig:
        dump.write_text(f"{text}\n", encoding="utf-8")
        draft = imported(tmp_path / "Configuration.h", dump)
        return config.load_text(draft.text("From a test."), "printer.toml")

    found = machine(f"echo:  M665 {rods} A0.00 B0.00 C0.00")
    geometry = found.geometry
    assert (geometry.radius, geometry.rods) == (120, [200, 200, 200])
    assert geometry.angles == [211, 330, 89.5]
    # The carriages are √(200² - 120²) = 160 mm above the nozzle, at 250 mm.
    assert [found.homing[tower].position for tower in "abc"] == [410, 410.25, 410]
    assert (found.axes["z"].max_mm, found.axes["z"].home_mm) == (250, 250)
    found = machine(f"M666 X-0.10 Y-0.20 Z0.00\nM665 {rods} A1.00 B0.00 C0.00")
    assert found.geometry.rods == [201, 200, 200]
    ends = [found.homing[tower].position for tower in "abc"]
    assert ends == pytest.approx([250 + (201**2 - 120**2) ** 0.5 + 0.1, 410.2, 410], abs=1e-5)
    with pytest.raises(ConfigError, match="M665 L is '90'"):
        machine("M665 L90 R120")


def test_command_imports_by_the_ending(tmp_path: Path, capsys) -> None:
    path = tmp_path / "Configuration.h"
    path.write_text(BASE, encoding="utf-8")
    output = tmp_path / "mine.toml"
    assert main(["import", str(path), "--output", str(output)]) == 0
    assert config.load(output).name == "test_printer"
    assert "To decide:" in capsys.readouterr().out


def test_every_define_of_the_reference_is_read(load, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = set[str]()
    for name in ("first", "on"):
        old = getattr(Defines, name)

        def recording(self, *names: str, old=old):
            asked.update(names)
            return old(self, *names)

        monkeypatch.setattr(Defines, name, recording)
    on = """BLTOUCH FWRETRACT PREVENT_COLD_EXTRUSION
        ASSISTED_TRAMMING PROBE_MANUALLY INPUT_SHAPING_X USE_CONTROLLER_FAN
        BACKLASH_COMPENSATION
        MESH_BED_LEVELING SKEW_CORRECTION NOZZLE_PARK_FEATURE LIN_ADVANCE PSU_CONTROL FT_MOTION
        FTM_IS_DEFAULT_MOTION STEALTHCHOP_XY Z_STEPPER_AUTO_ALIGN ADVANCED_PAUSE_FEATURE
        SENSORLESS_HOMING FILAMENT_RUNOUT_SENSOR"""
    values = {
        "Z_STEPPER_ALIGN_XY": "{ { 10, 10 }, { 150, 10 } }",
        "NOZZLE_PARK_POINT": "{ 10, 10, 5 }",
        "FTM_DEFAULT_SHAPER_Y": "ftMotionShaper_ZV",
        "FTM_SHAPING_DEFAULT_FREQ_Y": 40,
        "SHAPING_FREQ_X": 40,
        "TRAMMING_POINT_XY": "{ { 50, 50 }, { 150, 50 } }",
        "CONTROLLER_FAN_PIN": 17,
        "FIL_RUNOUT_PIN": 57,
        "X_CURRENT": 500,
        "X_STALL_SENSITIVITY": 70,
        "X_SERIAL_RX_PIN": 63,
        "Z_CURRENT": 500,
        "Z_SERIAL_RX_PIN": 40,
        "E0_DRIVER_TYPE": "TMC2208",
        "E0_CURRENT": 500,
        "E0_SERIAL_RX_PIN": 42,
    }
    more = "".join(f"#define {name}\n" for name in on.split())
    more += "".join(f"#define {name} {value}\n" for name, value in values.items())
    drivers = "X_DRIVER_TYPE TMC2209\n#define Z_DRIVER_TYPE TMC2209"
    load(("X_DRIVER_TYPE DRV8825", drivers), more=PROBE + more)
    laser = "#define LASER_FEATURE\n#define SPINDLE_LASER_PWM_PIN 4\n#define Z_MULTI_ENDSTOPS\n"
    laser += "#define CUTTER_POWER_UNIT RPM\n#define MPC_INCLUDE_FAN\n"
    model = ("HEATER_POWER", "BLOCK_HEAT_CAPACITY", "AMBIENT_XFER_COEFF", "SENSOR_RESPONSIVENESS")
    laser += "".join(f"#define MPC_{name} 2\n" for name in model)
    load(("#define PIDTEMP\n", "#define MPCTEMP\n"), more=laser)
    chamber = "#define TEMP_SENSOR_CHAMBER 1\n#define HEATER_CHAMBER_PIN 4\n"
    chamber += "#define TEMP_CHAMBER_PIN 15\n#define CHAMBER_MINTEMP 5\n"
    load(("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 1000"), more=chamber + "#define CHAMBER_MAXTEMP 60\n")
    load(("TEMP_SENSOR_0 5", "TEMP_SENSOR_0 -5"), more="#define TEMP_0_CS_PIN 53\n")
    servo = f"{PROBE}#define Z_PROBE_SERVO_NR 0\n"
    two = (("EXTRUDERS 1", "EXTRUDERS 2"), ("#define Z2_DRIVER_TYPE A4988\n", ""))
    load(*two, more=f"{servo}#define PIDTEMPBED\n", advanced="")
    load(
        ("#define Z2_DRIVER_TYPE A4988\n", ""),
        more="#define DELTA\n#define DELTA_RADIUS 120\n#define DELTA_DIAGONAL_ROD 200\n"
        "#define DELTA_HEIGHT 250\n#define PRINTABLE_RADIUS 90\n",
    )
    load(more=f"{ARMS}{MORGAN}{ANGLES}")
    rows = [row for group in TABLE.groups.values() if group.of for row in group.rows]
    options = [name for row in rows for name in row.option.split() if "/" not in name]
    names = [name.partition("#")[0] for name in options]
    patterns = {name: re.sub(r"\{\w+\}", r"\\w*", name) for name in names}
    missing = [n for n, p in patterns.items() if not any(re.fullmatch(p, one) for one in asked)]
    assert missing == []


def test_retraction_cold_limit_and_fade_are_taken_over(load) -> None:
    more = "#define FWRETRACT\n#define RETRACT_LENGTH 0.7\n#define RETRACT_FEEDRATE 40\n"
    more += "#define RETRACT_RECOVER_LENGTH -0.05\n#define PREVENT_COLD_EXTRUSION\n"
    more += "#define EXTRUDE_MINTEMP 160\n#define DEFAULT_LEVELING_FADE_HEIGHT 8.0\n"
    _, machine = load(more=f"{PROBE}#define BLTOUCH\n#define AUTO_BED_LEVELING_BILINEAR\n{more}")
    retraction = machine.retraction
    assert (retraction.length_mm, retraction.speed_mm_s, retraction.extra_mm) == (0.7, 40, -0.05)
    assert (machine.limits.min_extrude_c, machine.levelling.fade_mm) == (160, 8)
