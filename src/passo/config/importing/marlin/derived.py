"""The values that Marlin's own files derive from its options, as far as configurations use them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.importing.marlin.expression import Names

SMART = ("TMC2130", "TMC2160", "TMC2208", "TMC2209", "TMC2240", "TMC2660", "TMC5130", "TMC5160")
PROBES = (
    "FIX_MOUNTED_PROBE",
    "Z_PROBE_FIX_MOUNTED",
    "NOZZLE_AS_PROBE",
    "BLTOUCH",
    "PROBE_MANUALLY",
    "TOUCH_MI_PROBE",
    "SOLENOID_PROBE",
    "Z_PROBE_ALLEN_KEY",
    "Z_PROBE_SLED",
    "RACK_AND_PINION_PROBE",
    "MAG_MOUNTED_PROBE",
    "MAGLEV4",
    "BD_SENSOR",
    "SENSORLESS_PROBING",
)
_MOTORS = ("X", "Y", "Z", "X2", "Y2", "Z2", "Z3", "Z4", "E0", "E1", "E2", "E3")
_CONVERTERS = ("-2", "-3", "-5")


def derived(defines: Names, name: str, argument: str | None) -> int | None:
    """The value of a name, or, with `argument`, of the test `name(argument)`; None if it is not
    known."""
    has = defines.text_of
    if argument is not None:
        if name in ("AXIS_IS_TMC_CONFIG", "AXIS_IS_TMC", "AXIS_HAS_STEALTHCHOP"):
            return int(has(f"{argument}_DRIVER_TYPE") in SMART)
        if name in ("TEMP_SENSOR_IS_MAX_TC", "TEMP_SENSOR_IS_ANY_MAX_TC"):
            return int(has(f"TEMP_SENSOR_{argument}") in _CONVERTERS)
        return None
    if name in ("HAS_HOTEND", "HAS_E_TEMP_SENSOR", "HAS_TEMP_HOTEND"):
        return int(has("TEMP_SENSOR_0") not in (None, "0"))
    if name in ("HAS_HEATED_BED", "HAS_TEMP_BED"):
        return int(has("TEMP_SENSOR_BED") not in (None, "0"))
    if name in ("HOTENDS", "E_STEPPERS", "HAS_MULTI_EXTRUDER", "HAS_MULTI_HOTEND"):
        count = has("EXTRUDERS") or "1"
        if not re.fullmatch("[0-9]{1,2}", count):
            return None
        single = name.endswith(("HOTENDS", "HOTEND")) and defines.is_on("SINGLENOZZLE")
        number = 1 if single else int(count)
        return int(number > 1) if name.startswith("HAS") else number
    if match := re.fullmatch(r"HAS_([XYZ][2-4])_STEPPER", name):
        return int(has(f"{match[1]}_DRIVER_TYPE") is not None)
    if name in ("HAS_TRINAMIC_CONFIG", "HAS_TRINAMIC"):
        return int(any(has(f"{motor}_DRIVER_TYPE") in SMART for motor in _MOTORS))
    if name == "HAS_TMC26X":
        return int(any(has(f"{motor}_DRIVER_TYPE") == "TMC26X" for motor in _MOTORS))
    if name == "HAS_BED_PROBE":
        found = any(defines.is_on(probe) for probe in PROBES if probe != "PROBE_MANUALLY")
        return int(found or has("Z_PROBE_SERVO_NR") is not None)
    if name in ("IS_KINEMATIC", "IS_SCARA", "IS_CARTESIAN"):
        arms = any(map(defines.is_on, ("MORGAN_SCARA", "MP_SCARA", "AXEL_TPARA", "POLAR")))
        bent = arms or (name != "IS_SCARA" and defines.is_on("DELTA"))
        return int(bent != (name == "IS_CARTESIAN"))
    if name.startswith("__") or name == "F_CPU":  # of the compiler
        return 0
    return None
