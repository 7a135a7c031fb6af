"""A rotary delta: three arms that turn on the base. Klipper counts their angles upward, and gives
heights and speeds of the nozzle; Passo counts downward, and has angles and degrees a second."""

from __future__ import annotations

from math import degrees, sqrt
from typing import TYPE_CHECKING

from passo.geometry.base import Unreachable
from passo.geometry.rotary_delta import RotaryDelta

if TYPE_CHECKING:
    from passo.config.importing.klipper.cfg import Section
    from passo.config.importing.klipper.conversion import Import

# Klipper's steppers with their usual angles, and the motors of Passo there.
ARMS = {"a": (30.0, "b"), "b": (150.0, "c"), "c": (270.0, "a")}
_EFFECTOR_MM = 30.0  # only the difference of both sides counts, so one may be chosen


def put_rotary_delta(job: Import, printer: Section, limits: tuple[float, float, float]) -> None:
    """Converts geometry, axes and homing, not the motors. `limits` are the speed, the speed of Z
    and the acceleration. Raises ConfigError for arms of different lengths or at other angles, and
    for endstops that the arms do not reach."""
    first = job.required("stepper_a")
    radius, height = (printer.needed(f"shoulder_{word}") for word in ("radius", "height"))
    upper, lower = _length(job, "upper_arm_length"), _length(job, "lower_arm_length")
    put, path = job.draft.put, ("geometry",)
    base = round(_EFFECTOR_MM + 2 * sqrt(3) * radius, 6)
    place = printer.at("shoulder_radius")
    put((*path, "effector_length"), _EFFECTOR_MM, None)
    put((*path, "base_length"), base, place)
    text = f"the side of the base is {base:g} mm for an effector of {_EFFECTOR_MM:g} mm"
    job.draft.changed(place, "shoulder_radius", f"{text}: only the difference counts")
    put((*path, "rod_length"), lower, first.at("lower_arm_length"))
    put((*path, "arm_length"), upper, first.at("upper_arm_length"))
    put((*path, "z_offset"), height, printer.at("shoulder_height"))
    geometry = RotaryDelta(
        kind="rotary_delta",
        effector_length=_EFFECTOR_MM,
        base_length=base,
        rod_length=lower,
        arm_length=upper,
        z_offset=height,
    )
    # The limit of Klipper's rotary_delta.py for X and Y.
    reach = round(min(radius + upper, lower - radius), 3)
    ends = [_home(job, geometry, letter, upper) for letter in ARMS]
    speed, z_speed, accel = limits
    for axis, low, high, fastest in (
        ("x", -reach, reach, speed),
        ("y", -reach, reach, speed),
        ("z", printer.number("minimum_z_position", 0.0), min(ends), z_speed),
    ):
        put(("axes", axis, "min_mm"), low, None)
        put(("axes", axis, "max_mm"), high, None)
        put(("axes", axis, "home_mm"), min(ends) if axis == "z" else 0.0, None)
        put(("axes", axis, "speed_mm_s"), fastest, printer.at("max_velocity"))
        put(("axes", axis, "accel_mm_s2"), accel, printer.at("max_accel"))


def _length(job: Import, option: str) -> float:
    """The length that all arms have. Raises ConfigError."""
    first = job.required("stepper_a")
    length = first.needed(option)
    for letter in "bc":
        section = job.required(f"stepper_{letter}")
        if section.number(option, length) != length:
            limit = f"{length:g}, as of stepper_a: Passo's arms have one length"
            raise section.wrong(option, limit)
    return length


def _home(job: Import, geometry: RotaryDelta, letter: str, arm_mm: float) -> float:
    """Converts the homing of an arm, and returns the height of the nozzle at its endstop."""
    section, first = job.required(f"stepper_{letter}"), job.required("stepper_a")
    angle, motor = ARMS[letter]
    if section.number("angle", angle) != angle:
        limit = f"{angle:g}: Passo's arms are 120 degrees apart"
        raise section.wrong("angle", limit)
    end = section.number("position_endstop", first.needed("position_endstop"))
    assert end is not None
    try:
        position = geometry.inverse((0.0, 0.0, end))["abc".index(motor)]
    except Unreachable as error:
        limit = f"a height in reach: {error}"
        raise section.wrong("position_endstop", limit, f"{end:g}") from None
    put, path = job.draft.put, ("homing", motor)
    put((*path, "direction"), "min", None)
    put((*path, "position"), round(position, 4), section.at("position_endstop"))
    put((*path, "pin"), job.pins.of(section, "endstop_pin"), section.at("endstop_pin"))
    speed = first.number("homing_speed", 5.0) or 5.0
    values = (
        ("fast", "homing_speed", speed),
        ("retract", "homing_retract_dist", first.number("homing_retract_dist", 5.0)),
        ("slow", "second_homing_speed", first.number("second_homing_speed", speed / 2)),
    )
    section.used.update(option for _, option, _ in values)
    for key, option, value in values:
        turned = float(f"{degrees((value or 0.0) / arm_mm):.6g}")
        put((*path, key), turned or None, first.at(option))
    return end
