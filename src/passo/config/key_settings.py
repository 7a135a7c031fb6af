"""The keys of a machine file whose values commands can set too."""

from __future__ import annotations

import re

# The command and its word.
_SETTINGS = (
    (re.compile(r"axes\.(.)\.speed_mm_s"), "M203", ""),
    (re.compile(r"axes\.(.)\.accel_mm_s2"), "M201", ""),
    (re.compile(r"axes\.(.)\.jerk_mm_s"), "M205", ""),
    (re.compile(r"extruders\.(e)\.speed_mm_s"), "M203", ""),
    (re.compile(r"extruders\.(e)\.accel_mm_s2"), "M201", ""),
    (re.compile(r"limits\.print_accel_mm_s2"), "M204", "P"),
    (re.compile(r"limits\.travel_accel_mm_s2"), "M204", "T"),
    (re.compile(r"limits\.retract_accel_mm_s2"), "M204", "R"),
    (re.compile(r"limits\.junction_deviation_mm"), "M205", "J"),
    (re.compile(r"limits\.square_corner_mm_s"), "SET_VELOCITY_LIMIT", "SQUARE_CORNER_VELOCITY="),
    (re.compile(r"extruders\.e\.advance_s"), "SET_PRESSURE_ADVANCE", "ADVANCE="),
    (re.compile(r"extruders\.e\.advance_smooth_s"), "SET_PRESSURE_ADVANCE", "SMOOTH_TIME="),
    *(
        (re.compile(rf"shaping\.{axis}\.{key}"), "SET_INPUT_SHAPER", f"{word}_{axis.upper()}=")
        for axis in "xyz"
        for key, word in (("frequency_hz", "SHAPER_FREQ"), ("damping", "DAMPING_RATIO"))
    ),
    (re.compile(r"limits\.jerk_mm_s3"), "SET_JERK_LIMIT", "JERK="),
    (re.compile(r"backlash\.([xyz])_mm"), "M425", ""),
    (re.compile(r"backlash\.smooth_mm"), "M425", "S"),
    (re.compile(r"limits\.speed_mm_s"), "SET_VELOCITY_LIMIT", "VELOCITY="),
    (re.compile(r"limits\.minimum_cruise_ratio"), "SET_VELOCITY_LIMIT", "MINIMUM_CRUISE_RATIO="),
)


def setting_of(key: str) -> tuple[str, str] | None:
    """The command and the word that also set the value of a key; None for most keys."""
    for pattern, command, word in _SETTINGS:
        if match := pattern.fullmatch(key):
            return command, word or match[1].upper()
    return None
