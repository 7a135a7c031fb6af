"""Imports [printer], [stepper_…], and the motion options of [extruder]."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from passo.config.importing.klipper.cfg import Section
from passo.config.importing.klipper.deltesian import MOTORS as SIDES
from passo.config.importing.klipper.deltesian import put_deltesian
from passo.config.importing.klipper.drivers import put_driver
from passo.config.importing.klipper.homing import put_homing
from passo.config.importing.klipper.polar import put_polar
from passo.config.importing.klipper.rotary_delta import ARMS, put_rotary_delta
from passo.config.importing.klipper.winch import put_winch
from passo.config.importing.numbers import NUMBER, in_range, number_of
from passo.config.types import MIN_SPEED
from passo.errors import ConfigError
from passo.geometry.delta import ANGLES

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath, Place
    from passo.config.importing.klipper.conversion import Import

_ACTUATORS = {  # Klipper's letter of a stepper: Passo's motor
    "cartesian": {"x": "x", "y": "y", "z": "z"},
    "corexy": {"x": "a", "y": "b", "z": "z"},
    "corexz": {"x": "a", "y": "y", "z": "b"},
    "hybrid_corexy": {"x": "a", "y": "y", "z": "z"},
    "hybrid_corexz": {"x": "a", "y": "y", "z": "z"},
    "delta": {"a": "a", "b": "b", "c": "c"},
}
# Kalico's names of kinematics with limits for each axis.
_LIMITED = {f"limited_{kind}": kind for kind in ("cartesian", "corexy", "corexz")}
_MICROSTEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)  # of Passo; other drivers have others
_COLDEST = ("limits", "min_extrude_c")
_ROTARY, _DELTESIAN = "rotary_delta", "deltesian"
_POLAR, _WINCH, _STILL = "polar", "winch", "none"
_KNOWN = (*_ACTUATORS, _ROTARY, _DELTESIAN, _POLAR, _WINCH, _STILL)
_WHOLE = {"full_steps_per_rotation": 200, "microsteps": 16}  # of a stepper, with usual values


def put_motion(job: Import) -> None:
    """Imports geometry, axes, motors, limits, homing and extruders. Raises ConfigError."""
    printer = job.required("printer")
    written = printer.text("kinematics")
    kind = _LIMITED.get(written, written)
    if kind not in _KNOWN:
        place = printer.at("kinematics")
        raise ConfigError.of(
            "import.kinematics",
            place.file,
            place.line,
            value=kind[:40],
            limit=", ".join(_KNOWN),
        )
    speed, accel = _positive(printer, "max_velocity"), _positive(printer, "max_accel")
    corner = max(printer.number("square_corner_velocity", 5.0) or 0.0, MIN_SPEED)
    job.draft.put(("geometry", "kind"), kind, printer.at("kinematics"))
    z_speed = printer.number("max_z_velocity", speed) or speed
    if kind == _DELTESIAN:
        put_deltesian(job, printer, (speed, z_speed, accel))
        for side, motor in SIDES.items():
            section = job.required(f"stepper_{side}")
            put_stepper(job, section, motor, section)
        _put_motors(job, job.required("stepper_y"), "y", "y")
    elif kind == _ROTARY:
        put_rotary_delta(job, printer, (speed, z_speed, accel))
        for letter, (_, motor) in ARMS.items():
            section, first = job.required(f"stepper_{letter}"), job.required("stepper_a")
            _put_arm(job, section, motor, first, reversed_=True)
    elif kind == _POLAR:
        put_polar(job, printer, (speed, z_speed, accel))
        bed, arm = job.required("stepper_bed"), job.required("stepper_arm")
        _put_arm(job, bed, "a", bed, reversed_=False)
        put_stepper(job, arm, "b", arm)
        put_homing(job, [arm], ["b"], "x", "b", part="b")
        _put_motors(job, job.required("stepper_z"), "z", "z")
    elif kind == _WINCH:
        for motor, section in put_winch(job, printer, (speed, accel)).items():
            put_stepper(job, section, motor, section)
    elif kind != _STILL:
        _put_axes(job, printer, kind, speed, accel)
        for letter, motor in _ACTUATORS[kind].items():
            _put_motors(job, job.required(f"stepper_{letter}"), letter, motor)
    job.draft.put(("limits", "speed_mm_s"), speed, printer.at("max_velocity"))
    job.draft.put(("limits", "junction"), "square_corner", None)
    place = printer.at("square_corner_velocity")
    job.draft.put(("limits", "square_corner_mm_s"), corner, place)
    _put_cruise_ratio(job, printer, accel)
    if kind == "delta":
        _put_delta(job, printer)
    for section in [*job.config.of("extruder"), *_numbered(job, "extruder")]:
        _put_extruder(job, section, speed, accel)
        coldest = section.number("min_extrude_temp")
        limit = job.draft.keys.get(_COLDEST, (0.0, None))[0]
        if coldest is not None and coldest >= float(str(limit)):  # the highest one is for all
            job.put_value(_COLDEST, section, "min_extrude_temp", coldest)


def _put_cruise_ratio(job: Import, printer: Section, accel: float) -> None:
    """Converts minimum_cruise_ratio, or max_accel_to_decel of older configurations: Klipper takes
    1 - max_accel_to_decel / max_accel."""
    option, old = "minimum_cruise_ratio", "max_accel_to_decel"
    ratio, slower = printer.number(option, 0.5), printer.number(old)
    if option not in printer.options and slower is not None:
        option, ratio = old, round(1 - min(max(slower / accel, 0.0), 1.0), 6)
        job.draft.changed(printer.at(old), old, f"it is a minimum_cruise_ratio of {ratio:g}")
    job.draft.put(("limits", "minimum_cruise_ratio"), ratio, printer.at(option))


def _put_axes(job: Import, printer: Section, kind: str, speed: float, accel: float) -> None:
    for axis in "xyz":
        path = ("axes", axis)
        if kind == "delta":
            _put_delta_axis(job, printer, axis)
        else:
            stepper = job.required(f"stepper_{axis}")
            job.put("axis", stepper, axis=axis)
        for key, name, common in (
            ("speed_mm_s", "velocity", speed),
            ("accel_mm_s2", "accel", accel),
        ):
            own = f"max_{axis}_{name}"
            value = printer.number(own, common)
            job.draft.put((*path, key), value, printer.at(own if axis == "z" else f"max_{name}"))


def _put_delta_axis(job: Import, printer: Section, axis: str) -> None:
    path = ("axes", axis)
    if axis == "z":
        ends = [job.required(f"stepper_{letter}") for letter in "abc"]
        first = ends[0]
        heights = [end.number("position_endstop", first.number("position_endstop")) for end in ends]
        known = [height for height in heights if height is not None]
        if not known:
            raise first.missing("position_endstop")
        top = min(known)
        low = printer.number("minimum_z_position", 0.0)
        job.draft.put((*path, "min_mm"), low, printer.at("minimum_z_position"))
        job.draft.put((*path, "max_mm"), top, first.at("position_endstop"))
        job.draft.put((*path, "home_mm"), top, first.at("position_endstop"))
        return
    radius = printer.number("print_radius", printer.needed("delta_radius"))
    assert radius is not None
    place = printer.at("print_radius")
    job.draft.put((*path, "min_mm"), -radius, place)
    job.draft.put((*path, "max_mm"), radius, place)
    job.draft.put((*path, "home_mm"), 0.0, None)


def _put_delta(job: Import, printer: Section) -> None:
    radius = printer.needed("delta_radius")
    towers = [job.required(f"stepper_{letter}") for letter in "abc"]
    first = towers[0].needed("arm_length")
    rods = [tower.number("arm_length", first) or first for tower in towers]
    angles = [tower.number("angle", usual) for tower, usual in zip(towers, ANGLES, strict=True)]
    put, limit = job.draft.put, printer.number("print_radius", radius)
    put(("geometry", "radius"), radius, printer.at("delta_radius"))
    put(("geometry", "rods"), [*rods], towers[0].at("arm_length"))
    put(("geometry", "angles"), [a for a in angles if a is not None], towers[0].at("angle"))
    put(("geometry", "limit_radius"), limit, printer.at("print_radius"))


def _put_motors(job: Import, section: Section, letter: str, motor: str) -> None:
    """Imports the motor of an axis or a tower, further motors of the same axis, and its
    endstops."""
    sections = [section, *_numbered(job, f"stepper_{letter}")]
    names = [motor, *(f"{motor}{index}" for index in range(1, len(sections)))]
    first = job.required("stepper_a") if letter in "bc" else section
    for name, one in zip(names, sections, strict=True):
        put_stepper(job, one, name, first)
    put_homing(job, sections, names, letter, motor)


def _put_arm(job: Import, section: Section, name: str, first: Section, *, reversed_: bool) -> None:
    """Imports the motor of an arm or a bed that turns, whose scale follows from its gears. If
    `reversed_`, Klipper counts its angle the other way round."""
    steps = _put_whole(job, section, name, first)
    ratio = _gear_ratio(section if "gear_ratio" in section.options else first)
    path, place = ("steppers", name), section.at("gear_ratio")
    if not reversed_:
        job.draft.put((*path, "gear_ratio"), ratio, place)
        _put_pins(job, section, name, first)
        return
    job.draft.put((*path, "steps_per_degree"), float(f"{steps * ratio / 360:.10g}"), place)
    _put_pins(job, section, name, first)
    inverted = (*path, "invert") not in job.draft.keys
    job.draft.keys.pop((*path, "invert"), None)
    job.draft.put((*path, "invert"), inverted or None, section.at("dir_pin"))


def put_stepper(job: Import, section: Section, name: str, first: Section) -> None:
    """Imports a motor with its pins, scale and driver. A further motor of an axis takes missing
    options from the `first`."""
    path = ("steppers", name)
    put = job.draft.put
    distance = section.number("rotation_distance") or first.number("rotation_distance")
    if distance is None:
        _put_step_distance(job, section, name, first)
        _put_pins(job, section, name, first)
        return
    put((*path, "rotation_distance_mm"), distance, section.at("rotation_distance"))
    _put_whole(job, section, name, first)
    ratio = _gear_ratio(section if "gear_ratio" in section.options else first)
    if ratio != 1.0:
        put((*path, "gear_ratio"), ratio, section.at("gear_ratio"))
    _put_pins(job, section, name, first)


def _put_step_distance(job: Import, section: Section, name: str, first: Section) -> None:
    """Imports the scale of a configuration from before 2021. Raises ConfigError."""
    step = section.number("step_distance") or first.number("step_distance")
    if not step:
        raise section.missing("rotation_distance")
    place = section.at("step_distance")
    job.draft.put(("steppers", name, "steps_per_mm"), float(f"{1 / step:.8g}"), place)


def _put_whole(job: Import, section: Section, name: str, first: Section) -> int:
    """Imports the steps of a motor, and returns how many a rotation has."""
    read: dict[str, tuple[int | None, Place]] = {}
    for option in _WHOLE:
        source = section if option in section.options else first
        section.used.add(option)
        read[option] = source.whole(option), source.at(option)
    full, micro = (read[option][0] or usual for option, usual in _WHOLE.items())
    if micro not in _MICROSTEPS:
        read = {"full_steps_per_rotation": (full * micro, read["microsteps"][1])}
        read["microsteps"] = 1, read["full_steps_per_rotation"][1]
        text = f"the steps of a rotation are {full * micro}, as full steps"
        job.draft.changed(read["microsteps"][1], f"[{section.name}] microsteps {micro}", text)
    for option, (value, place) in read.items():
        job.draft.put(("steppers", name, option), value, place)
    return full * micro


def _put_pins(job: Import, section: Section, name: str, first: Section) -> None:
    """Imports the pins and the driver of a motor."""
    path: KeyPath = ("steppers", name)
    job.put("stepper", section, name=name)
    job.put("enable", section, first, name=name)
    direction = job.pins.of(section, "dir_pin")
    if direction is None:
        raise section.missing("dir_pin")
    job.put_value((*path, "direction_pin"), section, "dir_pin", direction.replace("!", ""))
    job.put_value((*path, "invert"), section, "dir_pin", "!" in direction or None)
    put_driver(job, section, path)


def _put_extruder(job: Import, section: Section, speed: float, accel: float) -> None:
    number = section.kind.removeprefix("extruder") or "0"
    name = "e" if number == "0" else f"e{number}"
    job.used.add(section.name)
    if "step_pin" not in section.options:
        return  # a hotend with the motor of another extruder
    put_stepper(job, section, name, section)
    nozzle = section.number("nozzle_diameter", 0.4) or 0.4
    filament = section.number("filament_diameter", 1.75) or 1.75
    # Klipper's default limits of a move of filament alone are those of a line as wide as four
    # squares of the nozzle, at full speed.
    ratio = 4 * nozzle**2 / (math.pi * (filament / 2) ** 2)
    put, path = job.draft.put, ("extruders", name)
    values = (
        ("speed_mm_s", "max_extrude_only_velocity", speed),
        ("accel_mm_s2", "max_extrude_only_accel", accel),
    )
    for key, option, limit in values:
        value = section.number(option, float(f"{limit * ratio:.6g}"))
        put((*path, key), value, section.at(option))
    job.put("extruder", section, name=name)


def _numbered(job: Import, stem: str) -> list[Section]:
    """The sections `stem1`, `stem2` …, in the order of their numbers."""
    found = [
        (int(match[1]), section)
        for section in job.config.sections.values()
        if (match := re.fullmatch(rf"{stem}(\d{{1,2}})", section.name))
    ]
    job.used.update(section.name for _, section in found)
    return [section for _, section in sorted(found, key=lambda pair: pair[0])]


def _gear_ratio(section: Section) -> float:
    """`80:20, 2:1` as the rotations of the motor per rotation of the shaft."""
    ratio = 1.0
    written = section.text("gear_ratio")
    for teeth in written.split(",") if written else ():
        try:
            driven, driving = (number_of(part) for part in teeth.split(":"))
            ratio *= driven / driving
        except (ValueError, ZeroDivisionError):
            raise section.wrong("gear_ratio", "pairs of teeth as 80:20") from None
    if not in_range(ratio):
        raise section.wrong("gear_ratio", NUMBER)
    return ratio


def _positive(section: Section, name: str) -> float:
    value = section.needed(name)
    if value <= 0:
        raise section.wrong(name, "more than 0", f"{value:g}")
    return value
