"""The reference page on the import of each section of a printer.cfg."""

from __future__ import annotations

from passo.config.importing.klipper.others import OPTIONS, OTHERS
from passo.config.importing.reference_rows import table, tables_of_others

_HEAD = """# What becomes of a printer.cfg

Made from `src/passo/config/importing/klipper/`.
[How to import a file](../how-to/move-from-klipper.md).
A section that is in none of these tables is reported as *Passo does not have this part*.

## Sections that become keys of the machine file

| section | tables |
|---|---|
"""
_TAKEN = (
    ("printer", "`geometry`, `axes`, `limits`"),
    ("stepper_x …, stepper_a …, stepper_z1 …", "`steppers`, `axes`, `homing`"),
    ("extruder, extruder1 …", "`steppers`, `extruders`, `heaters`, `tools`"),
    ("tmc2208, tmc2209, tmc2130, tmc5160", "`steppers.NAME.tmc`"),
    ("input_shaper", "`shaping`"),
    ("adxl345, lis2dw, resonance_tester", "`accelerometer`; one measures all axes"),
    ("heater_bed, heater_generic", "`heaters`; M141 sets a heater_generic, as a chamber"),
    ("thermistor", "`heaters.NAME.sensor`"),
    ("verify_heater", "`heaters.NAME.protection`"),
    ("fan, heater_fan, controller_fan, fan_generic, temperature_fan", "`fans`"),
    ("probe, bltouch", "`probe`, `homing.z`"),
    ("safe_z_home", "`homing.z.probe_at_mm`; for a switch, the macro `G28`"),
    ("homing_override", "the macro `G28`"),
    ("bed_mesh", "`levelling`; fade and stored heights are to decide, with the commands"),
    ("firmware_retraction", "to decide: the report has the commands M207 and M208"),
    ("idle_timeout", "`idle`"),
    ("screws_tilt_adjust, bed_screws", "`levelling.screws`"),
    ("z_tilt, quad_gantry_level", "`levelling.motors`"),
    ("skew_correction NAME", "to decide: the report has the command"),
    ("gcode_macro, delayed_gcode", "`macros`, `delayed_gcode`"),
    ("mcu, board_pins", "`board`, `boards`; other names of pins become the pins"),
)


def reference() -> str:
    """The page, in Markdown."""
    return (
        _HEAD
        + "".join(f"| {name} | {tables} |\n" for name, tables in _TAKEN)
        + tables_of_others("section", OTHERS)
        + table("Options that are not taken over", "option | what that means", OPTIONS)
    )
