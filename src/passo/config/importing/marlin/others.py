"""Options of Marlin without a key in a machine file, and how Passo handles them."""

from __future__ import annotations

import re

from passo.config.importing.draft import Other, built_in, lost

_NO_RISE = "before X and Y home, the nozzle rises to probe.start_mm; without a probe it does not"
OTHERS: dict[str, Other] = {
    "SDSUPPORT": built_in("passo serve --sd DIR has the files"),
    "ARC_SUPPORT": built_in("arcs are always there, and are exact"),
    "BABYSTEPPING": built_in("M290 is always there"),
    "EMERGENCY_PARSER": built_in("M108, M112 and M410 always act at once"),
    "HOST_ACTION_COMMANDS": built_in("action commands are always there"),
    "POWER_LOSS_RECOVERY": built_in("each print has a journal: resume after a power cut"),
    "CANCEL_OBJECTS": built_in("M486 is always there"),
    "GCODE_MACROS": built_in("write macros in the machine file"),
    "Z_HOMING_HEIGHT": lost(_NO_RISE),
    "Z_CLEARANCE_FOR_HOMING": lost(_NO_RISE),
    "S_CURVE_ACCELERATION": lost(
        "jerk_mm_s3 in [limits] makes S-curves; shapers leave less ringing"
    ),
    "FILAMENT_RUNOUT_SENSOR": lost("a print does not pause when the filament ends"),
    "FILAMENT_WIDTH_SENSOR": lost("the width of the filament is not measured"),
    "CASE_LIGHT_ENABLE": lost("the light stays off"),
    "NEOPIXEL_LED": lost("the light stays off"),
    "RGB_LED": lost("the light stays off"),
    "RGBW_LED": lost("the light stays off"),
    "BLINKM": lost("the light stays off"),
    "PCA9632": lost("the light stays off"),
    "DUAL_X_CARRIAGE": lost("the second carriage does not move"),
    "MIXING_EXTRUDER": lost("filaments are not mixed: each extruder is a tool"),
    "SWITCHING_EXTRUDER": lost("the servo of the extruder does not turn"),
    "SWITCHING_NOZZLE": lost("the servo of the nozzle does not turn"),
    "SWITCHING_TOOLHEAD": lost("tools are not fetched: write macros T0, T1"),
    "PARKING_EXTRUDER": lost("tools are not parked: write macros T0, T1"),
    "MAGNETIC_PARKING_EXTRUDER": lost("tools are not parked: write macros T0, T1"),
    "PRUSA_MMU2": lost("the unit for several materials is not used"),
    "MMU_MODEL": lost("the unit for several materials is not used"),
    "NOZZLE_CLEAN_FEATURE": lost("write G12 as a macro"),
    "PHOTO_GCODE": lost("no camera is released"),
    "COOLANT_CONTROL": lost("the coolant is not switched"),
    "AIR_ASSIST": lost("the air is not switched"),
    "TEMP_SENSOR_PROBE": lost("the temperature of the probe is not shown"),
    "TEMP_SENSOR_BOARD": lost("the temperature of the board is not shown"),
    "TEMP_SENSOR_COOLER": lost("the cooler is not controlled"),
    "TEMP_SENSOR_REDUNDANT": lost("the second sensor of the hotend is not read"),
    "AUTOTEMP": lost("the target does not follow the speed of the filament"),
    "EXTRUDER_RUNOUT_PREVENT": lost("a hot nozzle extrudes nothing by itself"),
    "PID_EXTRUSION_SCALING": lost("the power does not follow the speed of the filament"),
    "VOLUMETRIC_EXTRUSION": lost("M200 sets it"),
    "JOYSTICK": lost("the joystick is not read"),
    "I2C_POSITION_ENCODERS": lost("encoders are not read"),
    "CUSTOM_USER_BUTTONS": lost("the buttons do nothing"),
    "DIGIPOT_MOTOR_CURRENT": lost("the currents of the motors stay as the board sets them"),
    "DIGIPOT_I2C_MOTOR_CURRENTS": lost("the currents of the motors stay as the board sets them"),
    "PWM_MOTOR_CURRENT": lost("the currents of the motors stay as the board sets them"),
}
# What does not concern the machine: menus, texts, buffers, Marlin's own workings, limits of menus.
_SILENT = re.compile(
    r"LCD|_LCD|DISPLAY|U8G|MENU|TFT|DWIN|DGUS|TOUCH_|ENCODER|BEEP|SPEAKER|LANGUAGE|GLCD|EXTUI"
    r"|STATUS_|BOOT|LOGO|FONT|PREHEAT_|EEPROM|SERIAL|BAUD|BUFFER|BUFSIZE|BLOCK_|TX_|RX_|MEATPACK"
    r"|DEBUG|VERSION|_H_|STRING_|AUTHOR|CONFIG|MACHINE_NAME|MACHINE_UUID|KEEPALIVE|ADVANCED_OK"
    r"|NO_TIMEOUTS|PRINTCOUNTER|PRINTJOB|TIMER|REPORT|M115|M114|M503|CAPABILITIES|EDIT|MICROSTEP_MODES"
    r"|SOFTWARE_ENDSTOP|SOFT_ENDSTOP|ENDSTOP_INTERRUPTS|HOMING|HOME_|QUICK_HOME|_HOME$|DISABLE_"
    r"|DUMMY_THERMISTOR|PID_FUNCTIONAL|PID_K1|MPC_|OVERSHOOT|COLD|LENGTHY|MAXLENGTH|SEGMENT"
    r"|STEP_STATE|ADAPTIVE_STEP|ENABLE_ON|MINIMUM|MIN_STEP|PROBE_OFFSET|ERROR_TOLERANCE|CLEARANCE"
    r"|SLOWDOWN|INACTIV|IDLE|AXIS_RELATIVE|NOMINAL|FILAMENT_|_MICROSTEPS|_CURRENT|_RSENSE|_CHAIN_POS"
    r"|_INTERPOLATE|CHOPPER|MONITOR_DRIVER|TMC_|REPEATABILITY|FASTER|HOST_|SD_|SDCARD|MEDIA|PASSWORD"
    r"|EVENT_GCODE|NOZZLE_|PAUSE_|FWRETRACT|RETRACT_|TOOLCHANGE|FTM_|SHAPING_|ARC_|CNC_|BABYSTEP"
    r"|THERMAL_PROTECTION|WATCH_|_MINTEMP|_MAXTEMP|TEMP_SENSOR|TEMP_|_AUTO_FAN|FANMUX|SOFT_PWM|FAN_"
    r"|POWER_MONITOR|PSU_|PS_|SERVO|GRID_|MESH_|LEVEL|UBL|TRAMMING|LED|KILL|WATCHDOG|CODES"
    r"|GCODE|M43|PINS_|CONTROLLER|PROBING_|Z_PROBE|_MIN_POS|_MAX_POS|_BED_SIZE|CUSTOM_|HAPPY"
    r"|HYSTERESIS|CHECK_INTERVAL|DEFAULT_(bed|chamber)?K|_DRIVER_TYPE$|JD_HANDLE|SKEW|_SIDE_|_DIAG_"
    r"|THERMOCOUPLE|AUTO_REPORT|_KEEP_|PLANNER|DELTA_|STEPPER|EXTRAPOLATE|ENDSTOP|AXIS\d|ACCURATE|"
    r"HYBRID_THRESHOLD|STEALTHCHOP_|STALL_|PTC_|FIL_|RUNOUT|_SUBDIVISIONS|CURRENT_STEP|LPQ_|SET_"
    r"|MAX_CMD|BUSY_|MULTISTEPPING|_POWER$|MANUAL_PROBE|EDGE_STEPPING|M100_|STOP_ON|SERVICE_|PARK_|"
    r"FEEDRATE|TEMPERATURE_UNITS|^E\d|BAND|DEFAULT_(MIN|E)|WAIT|FLOW|VALIDATE|VOLUMETRIC|LIN_ADVANCE"
)


def is_silent(name: str) -> bool:
    """Whether a define does not concern the machine itself."""
    return _SILENT.search(name) is not None
