"""A polar machine: a bed that turns, an arm and Z. Klipper limits the speed of the bed by the step
rate alone, and its acceleration not at all."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

_NEAR_MM = 10.0  # nearer to the middle the bed gets no faster, unless the file has a limit


def put_polar(job: Import, printer: Section, limits: tuple[float, float, float]) -> None:
    """Converts axes and the limits of the bed, not the motors. `limits` are the speed, the speed of
    Z and the acceleration. Raises ConfigError."""
    arm, z = job.required("stepper_arm"), job.required("stepper_z")
    speed, z_speed, accel = limits
    put, reach = job.draft.put, arm.needed("position_max")
    z_accel = printer.number("max_z_accel", accel) or accel
    home = arm.number("position_endstop")
    for axis, at, fastest, most in (
        ("x", home, speed, accel),
        ("y", 0.0, speed, accel),
        ("z", None, z_speed, z_accel),
    ):
        if axis == "z":
            job.put("axis", z, axis=axis)
        else:
            put(("axes", axis, "min_mm"), -reach, arm.at("position_max"))
            put(("axes", axis, "max_mm"), reach, arm.at("position_max"))
            put(("axes", axis, "home_mm"), at, None)
        put(("axes", axis, "speed_mm_s"), fastest, printer.at("max_velocity"))
        put(("axes", axis, "accel_mm_s2"), most, printer.at("max_accel"))
    put(("steppers", "b", "min_mm"), arm.number("position_min", 0.0), arm.at("position_min"))
    put(("steppers", "b", "max_mm"), reach, arm.at("position_max"))
    place = printer.at("max_angular_velocity")
    turning = printer.number("max_angular_velocity", speed / _NEAR_MM) or speed / _NEAR_MM
    put(("steppers", "a", "speed_deg_s"), float(f"{degrees(turning):.6g}"), place)
    harder = float(f"{degrees(accel / _NEAR_MM):.6g}")
    put(("steppers", "a", "accel_deg_s2"), harder, printer.at("max_accel"))
    text = f"the bed accelerates by at most {harder:g} degrees/s², as max_accel needs {_NEAR_MM:g}"
    text += " mm from the middle: Klipper has no such limit"
    job.draft.changed(printer.at("max_accel"), "[stepper_bed]", text)
