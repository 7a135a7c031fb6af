"""A deltesian: two carriages with rods in the plane XZ, and a motor for Y. Klipper gives heights of
the nozzle in the middle; Passo has the heights of the carriages."""

from __future__ import annotations

from math import cos, radians, sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

MOTORS = {"left": "a", "right": "b"}
_MIN_ANGLE = 5.0  # Klipper's default, degrees


def put_deltesian(job: Import, printer: Section, limits: tuple[float, float, float]) -> None:
    """Converts geometry, axes and the homing of the carriages, not the motors. `limits` are the
    speed, the speed of Z and the acceleration. Raises ConfigError."""
    left, right = (job.required(f"stepper_{side}") for side in MOTORS)
    xs = [left.needed("arm_x_length"), _of(right, "arm_x_length", left)]
    rods = [left.needed("arm_length"), _of(right, "arm_length", left)]
    ends = [left.needed("position_endstop"), _of(right, "position_endstop", left)]
    angle = printer.number("min_angle", _MIN_ANGLE) or 0.0
    for section, x, rod in zip((left, right), xs, rods, strict=True):
        if not 0 < x < rod:
            raise section.wrong("arm_x_length", f"less than arm_length {rod:g}", f"{x:g}")
    put, path = job.draft.put, ("geometry",)
    put((*path, "towers_x"), [-xs[0], xs[1]], left.at("arm_x_length"))
    put((*path, "rods"), [*rods], left.at("arm_length"))
    put((*path, "min_angle"), angle, printer.at("min_angle"))
    for side, x, rod, end in zip(MOTORS, xs, rods, ends, strict=True):
        _put_homing(job, side, round(end + sqrt(rod**2 - x**2), 6))
    flat = [rod * cos(radians(angle)) for rod in rods]
    low, high = max(-xs[0], xs[1] - flat[1]), min(xs[1], flat[0] - xs[0])
    if width := printer.number("print_width"):
        low, high = max(low, -width / 2), min(high, width / 2)
    bottom = printer.number("minimum_z_position", 0.0) or 0.0
    speed, z_speed, accel = limits
    z_accel = printer.number("max_z_accel", accel) or accel
    for axis, ends_mm, home, fastest, most in (
        ("x", (round(low, 3), round(high, 3)), 0.0, speed, accel),
        ("y", None, None, speed, accel),
        ("z", (bottom, min(ends)), min(ends), z_speed, z_accel),
    ):
        if ends_mm is None:
            job.put("axis", job.required("stepper_y"), axis=axis)
        else:
            put(("axes", axis, "min_mm"), ends_mm[0], None)
            put(("axes", axis, "max_mm"), ends_mm[1], None)
            put(("axes", axis, "home_mm"), home, None)
        put(("axes", axis, "speed_mm_s"), fastest, printer.at("max_velocity"))
        put(("axes", axis, "accel_mm_s2"), most, printer.at("max_accel"))
    printer.used.add("slow_ratio")


def _of(section: Section, option: str, first: Section) -> float:
    """The value of the right side, which is that of the left side by default."""
    value = section.number(option, first.needed(option))
    assert value is not None
    return value


def _put_homing(job: Import, side: str, carriage_mm: float) -> None:
    """Converts the homing of a carriage, which goes up no further than its endstop."""
    section, first = job.required(f"stepper_{side}"), job.required("stepper_left")
    put, motor = job.draft.put, MOTORS[side]
    path, place = ("homing", motor), section.at("position_endstop")
    put(("steppers", motor, "max_mm"), carriage_mm, place)
    put((*path, "direction"), "max", None)
    put((*path, "position"), carriage_mm, place)
    put((*path, "pin"), job.pins.of(section, "endstop_pin"), section.at("endstop_pin"))
    job.put("homing", section, first, name=motor)
    slow = first.number("second_homing_speed", job.draft.number((*path, "fast")) / 2)
    section.used.add("second_homing_speed")
    job.put_value((*path, "slow"), first, "second_homing_speed", slow or None)
