"""Sections of a printer.cfg that no key of a machine file comes from, and what becomes of them."""

from __future__ import annotations

from typing import NamedTuple


class Other(NamedTuple):
    """What becomes of a section: `part` of Passo without a key, or nothing (`lost`), and what that
    means for the owner."""

    lost: bool
    text: str


def _built_in(text: str) -> Other:
    return Other(False, text)


def _lost(text: str) -> Other:
    return Other(True, text)


# What the loss of an option means, by its name in any section.
OPTIONS: dict[str, str] = {
    "max_extrude_only_distance": "a move of filament alone may have any length",
    "min_extrude_temp": "filament moves from 170 °C; M302 S sets another limit",
    "diag_pin": "the driver's own stall detection is not used",
    "diag1_pin": "the driver's own stall detection is not used",
    "driver_sgthrs": "the driver's own stall detection is not used",
    "speed": "the probe's travel speed counts: probe.travel_mm_s",
    "horizontal_move_z": "the height between points is probe.start_mm",
    "fade_start": "set the fade of the mesh with M420 Z",
    "fade_end": "set the fade of the mesh with M420 Z",
    "fade_target": "the mesh fades to the height in its middle",
    "mesh_pps": "the surface is exact between the points, without steps",
    "bicubic_tension": "the surface is exact between the points, without steps",
    "shutdown_speed": "a fan that follows a heater runs on after a fault",
    "idle_speed": "the fan is off when the motors are",
    "tachometer_pin": "the speed of the fan is not measured",
    "smooth_time": "readings of the sensor are not smoothed; the PID filter has its own time",
    "inline_resistor": "readings are a little off at high temperatures",
    "hardware_pwm": "boards pulse fans in software",
    "homing_retract_speed": "the axis goes back as fast as it homes",
}
OTHERS: dict[str, Other] = {
    "virtual_sdcard": _built_in("passo serve --sd DIR has the files"),
    "pause_resume": _built_in("PAUSE, RESUME and CANCEL_PRINT are always there"),
    "display_status": _built_in("M73 and M117 are always there"),
    "exclude_object": _built_in("EXCLUDE_OBJECT and M486 are always there"),
    "respond": _built_in("RESPOND and M118 are always there"),
    "gcode_arcs": _built_in("arcs are always there, and are exact"),
    "force_move": _built_in("FORCE_MOVE and STEPPER_BUZZ are always there"),
    "save_variables": _built_in("SAVE_VARIABLE stores in the folder of --state"),
    "skew_correction": _built_in("set the skew again, with SET_SKEW"),
    "endstop_phase": _lost("endstops are used as they trigger"),
    "safe_z_home": _lost("home X and Y first; a macro G28 with rename_existing moves to a place"),
    "homing_override": _lost("write its G-code as a macro G28 with rename_existing"),
    "bed_screws": _lost("name the screws in [levelling.screws], for BED_SCREWS_ADJUST"),
    "screws_tilt_adjust": _lost("name the screws in [levelling.screws], for G35"),
    "bed_mesh": _lost("a mesh needs a probe"),
    "bed_tilt": _lost('[levelling] method = "linear" measures and corrects a plane'),
    "z_tilt": _lost("give pivots and points in [levelling.motors], for G34"),
    "quad_gantry_level": _lost("give pivots and points in [levelling.motors], for G34"),
    "delta_calibrate": _built_in("calibrate the delta again, with G33"),
    "resonance_tester": _lost("there is no measurement of resonances by this file"),
    "adxl345": _lost("the accelerometer is not used"),
    "lis2dw": _lost("the accelerometer is not used"),
    "lis3dh": _lost("the accelerometer is not used"),
    "mpu9250": _lost("the accelerometer is not used"),
    "filament_switch_sensor": _lost("a print does not pause when the filament ends"),
    "filament_motion_sensor": _lost("a print does not pause when the filament stops"),
    "firmware_retraction": _lost("set G10 and G11 with M207 and M208"),
    "display": _lost("the display stays dark"),
    "display_glyph": _lost("the display stays dark"),
    "menu": _lost("the display stays dark"),
    "output_pin": _lost("the output keeps the state that it has after a reset"),
    "pwm_tool": _lost("the output keeps the state that it has after a reset"),
    "pwm_cycle_time": _lost("the output keeps the state that it has after a reset"),
    "static_digital_output": _lost("the output keeps the state that it has after a reset"),
    "multi_pin": _lost("outputs that are switched together are not joined"),
    "servo": _lost("the servo does not move"),
    "neopixel": _lost("the light stays off"),
    "dotstar": _lost("the light stays off"),
    "led": _lost("the light stays off"),
    "pca9533": _lost("the light stays off"),
    "temperature_sensor": _lost("the temperature is not shown"),
    "temperature_host": _lost("the temperature is not shown"),
    "temperature_probe": _lost("the temperature is not shown"),
    "gcode_button": _lost("the button does nothing"),
    "manual_stepper": _lost("the motor does not move"),
    "extruder_stepper": _lost("the further motor of the extruder does not move"),
    "dual_carriage": _lost("the second carriage does not move"),
    "idle_timeout": _lost("[idle] has other rules: motors off after 10, heaters after 30 minutes"),
    "sdcard_loop": _lost("loops in files are not carried out"),
    "ad5206": _lost("the currents of the motors stay as the board sets them"),
    "mcp4018": _lost("the currents of the motors stay as the board sets them"),
    "mcp4451": _lost("the currents of the motors stay as the board sets them"),
    "mcp4728": _lost("the currents of the motors stay as the board sets them"),
    "dac084S085": _lost("the currents of the motors stay as the board sets them"),
    "replicape": _lost("Passo does not drive this board"),
    "sx1509": _lost("pins of this chip cannot be used"),
    "smart_effector": _lost("choose a probe of [probe] by hand"),
    "probe_eddy_current": _lost("choose a probe of [probe] by hand"),
    "axis_twist_compensation": _lost("heights are used as they are measured"),
    "homing_heaters": _lost("heaters stay on while the machine homes"),
    "samd_sercom": _built_in("Passo sets drivers over pins"),
    "static_pwm_clock": _lost("the output keeps the state that it has after a reset"),
    "adc_scaled": _lost("the sensor is read without this scaling"),
}
