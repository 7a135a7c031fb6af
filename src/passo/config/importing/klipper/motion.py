"""Imports [printer], [stepper_…], drivers, and the motion options of [extruder]."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.cfg import Section
from passo.config.importing.klipper.filters import put_advance
from passo.config.importing.klipper.homing import put_homing
from passo.config.importing.klipper.rotary_delta import ARMS, put_rotary_delta
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
    "delta": {"a": "a", "b": "b", "c": "c"},
}
# Kalico's names of kinematics with limits for each axis.
_LIMITED = {f"limited_{kind}": kind for kind in ("cartesian", "corexy", "corexz")}
_SPI = {"sclk": "clock", "mosi": "mosi", "miso": "miso"}
_CHIPS = ("tmc2208", "tmc2209", "tmc2130", "tmc5160")
_MICROSTEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)  # of Passo; other drivers have others
_ROTARY = "rotary_delta"
_WHOLE = {"full_steps_per_rotation": 200, "microsteps": 16}  # of a stepper, with usual values


def put_motion(job: Import) -> None:
    """Imports geometry, axes, motors, limits, homing and extruders. Raises ConfigError."""
    printer = job.required("printer")
    written = printer.text("kinematics")
    kind = _LIMITED.get(written, written)
    if kind not in (*_ACTUATORS, _ROTARY):
        place = printer.at("kinematics")
        raise ConfigError.of(
            "import.kinematics",
            place.file,
            place.line,
            value=kind[:40],
            limit=", ".join((*_ACTUATORS, _ROTARY)),
        )
    speed, accel = _positive(printer, "max_velocity"), _positive(printer, "max_accel")
    corner = max(printer.number("square_corner_velocity", 5.0) or 0.0, MIN_SPEED)
    job.draft.put(("geometry", "kind"), kind, printer.at("kinematics"))
    if kind == _ROTARY:
        z_speed = printer.number("max_z_velocity", speed) or speed
        put_rotary_delta(job, printer, (speed, z_speed, accel))
        for letter, (_, motor) in ARMS.items():
            _put_arm(job, job.required(f"stepper_{letter}"), motor)
    else:
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
            low = stepper.number("position_min", 0.0)
            job.draft.put((*path, "min_mm"), low, stepper.at("position_min"))
            high = stepper.needed("position_max")
            job.draft.put((*path, "max_mm"), high, stepper.at("position_max"))
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


def _put_arm(job: Import, section: Section, name: str) -> None:
    """Imports the motor of an arm, whose scale follows from its gears. Klipper counts its angle the
    other way round."""
    first = job.required("stepper_a")
    steps = _put_whole(job, section, name, first)
    ratio = _gear_ratio(section if "gear_ratio" in section.options else first)
    path, place = ("steppers", name), section.at("gear_ratio")
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
    put = job.draft.put
    direction = job.pins.of(section, "dir_pin")
    step = job.pins.of(section, "step_pin")
    if step is None or direction is None:
        raise section.missing("step_pin" if step is None else "dir_pin")
    put((*path, "step_pin"), step, section.at("step_pin"))
    put((*path, "direction_pin"), direction.replace("!", ""), section.at("dir_pin"))
    put((*path, "invert"), "!" in direction or None, section.at("dir_pin"))
    enable = job.pins.of(section, "enable_pin")
    if enable is None:
        enable = job.pins.of(first, "enable_pin") if "enable_pin" in first.options else None
    put((*path, "enable_pin"), enable, section.at("enable_pin"))
    pulse = section.number("step_pulse_duration")
    put(
        (*path, "pulse_us"),
        None if pulse is None else pulse * 1e6,
        section.at("step_pulse_duration"),
    )
    _put_driver(job, section, path)


def _put_driver(job: Import, motor: Section, path: KeyPath) -> None:
    found = [s for s in job.config.sections.values() if s.rest == motor.name and "tmc" in s.kind]
    for section in found:
        job.used.add(section.name)
        put, chip = job.draft.put, section.kind
        if chip not in _CHIPS:
            text = "Passo does not set this driver's registers: it runs as its pins are wired"
            job.draft.dropped(section.place, f"[{section.name}]", text)
            section.used.update(section.options)
            job.left_out.add(section.name)
            continue
        run, hold = section.number("run_current"), section.number("hold_current")
        silent = section.number("stealthchop_threshold", 0.0)
        pins = {"uart_pin": "uart_pin", "tx_pin": "tx_pin", "cs_pin": "cs_pin"}
        pins |= {f"spi_software_{a}_pin": f"{b}_pin" for a, b in _SPI.items()}
        if chip in _CHIPS[2:] and "spi_software_sclk_pin" not in section.options:
            text = "Passo sets this driver only over the pins of its SPI bus"
            text += f": give driver and tmc of steppers.{path[-1]}"
            if run is not None:
                text += f", with run_current_a = {run:g}"
            job.draft.decide(section.at("spi_bus"), f"[{section.name}]", text)
            section.used.update(section.options)
            job.left_out.add(section.name)
            continue
        put((*path, "driver"), chip.upper(), section.place)
        tmc = (*path, "tmc")
        put((*tmc, "run_current_a"), run, section.at("run_current"))
        put((*tmc, "hold_current_a"), hold, section.at("hold_current"))
        put(
            (*tmc, "sense_resistor_ohm"),
            section.number("sense_resistor"),
            section.at("sense_resistor"),
        )
        put((*tmc, "stealthchop_below_mm_s"), silent or None, section.at("stealthchop_threshold"))
        if not section.flag("interpolate", True):
            put((*tmc, "interpolate"), False, section.at("interpolate"))
        if chip == "tmc2209":
            address = section.whole("uart_address")
            put((*tmc, "address"), address, section.at("uart_address"))
        for option, key in pins.items():
            put((*tmc, key), job.pins.of(section, option), section.at(option))


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
    corner = section.number("instantaneous_corner_velocity", 1.0)
    put((*path, "jerk_mm_s"), corner, section.at("instantaneous_corner_velocity"))
    put_advance(job, section, path)


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
            key = f"gear_ratio in [{section.name}]"
            raise bad(section.at("gear_ratio"), key, written, "pairs of teeth as 80:20") from None
    if not in_range(ratio):
        raise bad(section.at("gear_ratio"), f"gear_ratio in [{section.name}]", written, NUMBER)
    return ratio


def _positive(section: Section, name: str) -> float:
    value = section.needed(name)
    if value <= 0:
        raise bad(section.at(name), f"{name} in [{section.name}]", f"{value:g}", "more than 0")
    return value
