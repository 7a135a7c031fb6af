"""The reference page for the conversion of Marlin's defines."""

from __future__ import annotations

from passo.config.importing.marlin.boards import BOARDS
from passo.config.importing.marlin.others import OTHERS
from passo.config.importing.reference_rows import tables_of_others

_HEAD = """# What becomes of Marlin's Configuration.h

Made from `src/passo/config/importing/marlin/`.
[How to import a file](../how-to/move-from-marlin.md).
`*` is an axis (X, Y, Z) or a number. Older names, and those of MK4duo and StuFW, are read,
too. Other defines are named together in the report, or concern menus, texts and buffers.

## Defines that become keys of the machine file

| define | key |
|---|---|
"""
TAKEN = (
    ("CUSTOM_MACHINE_NAME", "`name`"),
    (
        "COREXY, COREXZ, COREYZ, COREYX, COREZX, COREZY, DELTA, MORGAN_SCARA, MP_SCARA, MECHANISM",
        "`geometry.kind`",
    ),
    ("SCARA_LINKAGE_1, SCARA_LINKAGE_2", "`geometry.arm1`, `geometry.arm2`"),
    ("SCARA_OFFSET_X, SCARA_OFFSET_Y", "`geometry.x_offset`, `geometry.y_offset`"),
    (
        "SCARA_OFFSET_THETA1, SCARA_OFFSET_THETA2",
        "`homing.a.position`, `homing.b.position`, of a Morgan",
    ),
    ("DELTA_RADIUS", "`geometry.radius`"),
    ("DELTA_DIAGONAL_ROD, DELTA_DIAGONAL_ROD_TRIM_TOWER", "`geometry.rods`"),
    ("DELTA_TOWER_ANGLE_TRIM", "`geometry.angles`"),
    ("PRINTABLE_RADIUS", "`geometry.limit_radius`, `axes`, `bed`"),
    ("DELTA_HEIGHT, DELTA_ENDSTOP_ADJ", "`homing.NAME.position`, of a carriage; `axes.z.max_mm`"),
    ("*_MIN_POS, *_MAX_POS", "`axes.NAME.min_mm`, `max_mm`"),
    ("DEFAULT_MAX_FEEDRATE", "`speed_mm_s` of `axes` and `extruders`"),
    ("DEFAULT_MAX_ACCELERATION", "`accel_mm_s2` of `axes` and `extruders`"),
    ("DEFAULT_AXIS_STEPS_PER_UNIT", "`steppers.NAME.steps_per_mm`"),
    (
        "DEFAULT_ACCELERATION, DEFAULT_TRAVEL_ACCELERATION, DEFAULT_RETRACT_ACCELERATION",
        "`limits.print_accel_mm_s2`, `travel_accel_mm_s2`, `retract_accel_mm_s2`",
    ),
    ("CLASSIC_JERK, DEFAULT_*JERK", "`limits.junction`, `jerk_mm_s` of `axes` and `extruders`"),
    ("JUNCTION_DEVIATION_MM", "`limits.junction_deviation_mm`"),
    ("INVERT_*_DIR, INVERT_*2_VS_*_DIR", "`steppers.NAME.invert`"),
    ("*_DRIVER_TYPE", "`steppers.NAME.driver`; Z2 and so on are further motors"),
    ("*_CURRENT, HOLD_MULTIPLIER", "`steppers.NAME.tmc.run_current_a`, `hold_current_a`"),
    (
        "*_RSENSE, *_MICROSTEPS, *_SLAVE_ADDRESS, INTERPOLATE",
        "`steppers.NAME.tmc`, `microsteps`",
    ),
    (
        "STEALTHCHOP_XY, STEALTHCHOP_Z, STEALTHCHOP_E, HYBRID_THRESHOLD",
        "`steppers.NAME.tmc.stealthchop_below_mm_s`",
    ),
    ("*_HOME_DIR, MANUAL_*_HOME_POS", "`homing.NAME.direction`, `position`"),
    ("*_MIN_ENDSTOP_HIT_STATE, *_MIN_ENDSTOP_INVERTING, ENDSTOPPULLUPS", "`homing.NAME.pin`"),
    ("*_MULTI_ENDSTOPS, *2_USE_ENDSTOP", "`homing.NAME.stepper_pins`"),
    (
        "HOMING_FEEDRATE_MM_M, HOMING_BUMP_MM, HOMING_BUMP_DIVISOR",
        "`homing.NAME.fast`, `retract`, `slow`",
    ),
    ("X_BED_SIZE, Y_BED_SIZE, BED_CENTER_AT_0_0", "`bed`"),
    (
        "BLTOUCH, FIX_MOUNTED_PROBE, NOZZLE_AS_PROBE, Z_PROBE_SERVO_NR, Z_SERVO_ANGLES, "
        "PROBE_MANUALLY",
        "`probe.kind`",
    ),
    ("NOZZLE_TO_PROBE_OFFSET", "`probe.offset_mm`, `trigger_height_mm`"),
    (
        "XY_PROBE_FEEDRATE, Z_PROBE_FEEDRATE_FAST, Z_PROBE_FEEDRATE_SLOW",
        "`probe.travel_mm_s`, `fast_mm_s`, `slow_mm_s`",
    ),
    (
        "MULTIPLE_PROBING, EXTRA_PROBING, Z_CLEARANCE_BETWEEN_PROBES, Z_PROBE_LOW_POINT, "
        "PROBING_HEATERS_OFF",
        "`probe.samples`, `start_mm`, `low_mm`, `heaters_off`",
    ),
    (
        "Z_MIN_PROBE_USES_Z_MIN_ENDSTOP_PIN, USE_PROBE_FOR_Z_HOMING, Z_SAFE_HOMING",
        "`homing.z.probe`, `probe_at_mm`",
    ),
    (
        "AUTO_BED_LEVELING_BILINEAR, AUTO_BED_LEVELING_UBL, MESH_BED_LEVELING, "
        "AUTO_BED_LEVELING_LINEAR, AUTO_BED_LEVELING_3POINT",
        "`levelling.method`",
    ),
    (
        "GRID_MAX_POINTS_X, PROBING_MARGIN, ABL_BILINEAR_SUBDIVISION",
        "`levelling.count`, `area`, `interpolation`",
    ),
    ("ASSISTED_TRAMMING, TRAMMING_POINT_XY, TRAMMING_SCREW_THREAD", "`levelling.screws`"),
    (
        "Z_STEPPER_AUTO_ALIGN, Z_STEPPER_ALIGN_XY, Z_STEPPER_ALIGN_STEPPER_XY",
        "`levelling.motors`",
    ),
    ("EXTRUDERS, SINGLENOZZLE, HOTEND_OFFSET_*", "`extruders`, `tools`"),
    ("LIN_ADVANCE, ADVANCE_K", "`extruders.NAME.advance_s`"),
    ("TEMP_SENSOR_*", "`heaters.NAME.sensor`, by Marlin's number; 1000 by its values"),
    ("HEATER_*_MINTEMP, HEATER_*_MAXTEMP, BED_MAXTEMP", "`heaters.NAME.min_c`, `max_c`"),
    (
        "PIDTEMP, DEFAULT_Kp, PIDTEMPBED, DEFAULT_bedKp, BED_HYSTERESIS",
        "`heaters.NAME.control`",
    ),
    (
        "MPCTEMP, MPC_HEATER_POWER, MPC_BLOCK_HEAT_CAPACITY, MPC_AMBIENT_XFER_COEFF",
        "`heaters.NAME.model`",
    ),
    ("PID_DRIVE_MIN, PID_DRIVE_MAX", "`heaters.NAME.control.drive_min`, `drive_max`; of StuFW"),
    ("PREHEAT_*_TEMP_HOTEND, PREHEAT_*_HOTEND", "to decide: the report has the command M145"),
    ("PID_MAX, BANG_MAX, MAX_BED_POWER", "`heaters.NAME.max_power`"),
    (
        "WATCH_TEMP_PERIOD, WATCH_TEMP_INCREASE, THERMAL_PROTECTION_PERIOD, "
        "THERMAL_PROTECTION_HYSTERESIS",
        "`heaters.NAME.protection`, which is always on",
    ),
    ("TEMP_WINDOW, TEMP_HYSTERESIS, TEMP_RESIDENCY_TIME", "`heaters.NAME.arrival`"),
    ("FAN_PIN, FAN_MIN_PWM, FAN_KICKSTART_TIME", "`fans.part`"),
    ("E*_AUTO_FAN_PIN, EXTRUDER_AUTO_FAN_TEMPERATURE", "`fans.hotend_fan`"),
    ("USE_CONTROLLER_FAN, CONTROLLER_FAN_PIN, CONTROLLERFAN_IDLE_TIME", "`fans.board`"),
    (
        "INPUT_SHAPING_*, SHAPING_FREQ_*, SHAPING_ZETA_*, FTM_DEFAULT_SHAPER_*",
        "`shaping.NAME`",
    ),
    (
        "BACKLASH_COMPENSATION, BACKLASH_DISTANCE_MM, BACKLASH_CORRECTION, BACKLASH_SMOOTHING_MM",
        "`backlash`",
    ),
    ("NOZZLE_PARK_FEATURE, NOZZLE_PARK_POINT", "`park`"),
    ("FWRETRACT, RETRACT_LENGTH, RETRACT_FEEDRATE", "`retraction`"),
    ("EXTRUDE_MINTEMP", "`limits.min_extrude_c`"),
    ("DEFAULT_LEVELING_FADE_HEIGHT", "`levelling.fade_mm`"),
    ("DEFAULT_STEPPER_TIMEOUT_SEC", "`idle.motors_off_s`"),
    ("PSU_CONTROL, PSU_ACTIVE_STATE", "`mains`"),
    ("LASER_FEATURE, SPINDLE_LASER_PWM_PIN, CUTTER_POWER_UNIT", "`laser`"),
    ("SKEW_CORRECTION, XY_SKEW_FACTOR, XY_DIAG_AC", "to decide: the report has the command"),
    ("MOTHERBOARD", "`board.base`, `board.variant`"),
)

_BOARDS = """
## Boards

The numbers of Marlin 1.1 and older names of these boards are known too. A machine with another
board is simulated until `--board` names one with the same wiring.

| MOTHERBOARD | [board](boards.md) | variant |
|---|---|---|
"""


def reference() -> str:
    """The page, in Markdown."""
    return (
        _HEAD
        + "".join(f"| {name.replace('*', chr(92) + '*')} | {key} |\n" for name, key in TAKEN)
        + tables_of_others("define", OTHERS)
        + _BOARDS
        + "".join(
            f"| {name} | {board.base} | {board.variant or ''} |\n"
            for name, board in sorted(BOARDS.items())
        )
    )
