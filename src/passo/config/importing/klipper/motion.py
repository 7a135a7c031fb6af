"""Imports [printer], [stepper_…], drivers, and the motion options of [extruder]."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad
from passo.config.importing.klipper.bed import pair
from passo.config.importing.klipper.cfg import Section
from passo.config.importing.klipper.filters import put_advance
from passo.config.importing.klipper.rotary_delta import ARMS, put_rotary_delta
from passo.config.importing.numbers import NUMBER, in_range, number_of
from passo.config.types import MIN_SPEED
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.conversion import Import

_ACTUATORS = {  # Klipper's letter of a stepper: Passo's motor
    "cartesian": {"x": "x", "y": "y", "z": "z"},
    "corexy": {"x": "a", "y": "b", "z": "z"},
    "corexz": {"x": "a", "y": "y", "z": "b"},
    "delta": {"a": "a", "b": "b", "c": "c"},
}
_ANGLES = (210.0, 330.0, 90.0)
_CHIPS = ("tmc2208", "tmc2209", "tmc2130", "tmc5160")
_MICROSTEPS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
_LONGEST_MM = 1e6
_ROTARY = "rotary_delta"
_WHOLE = {  # of a stepper, with the maximum and the usual value
    "full_steps_per_rotation": (10_000, 200),
    "microsteps": (256, 16),
}


def put_motion(job: Import) -> None:
    """Imports geometry, axes, motors, limits, homing and extruders. Raises ConfigError."""
    printer = job.required("printer")
    kind = printer.text("kinematics")
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
    ratio = printer.number("minimum_cruise_ratio", 0.5)
    job.draft.put(("limits", "minimum_cruise_ratio"), ratio, printer.at("minimum_cruise_ratio"))
    if kind == "delta":
        _put_delta(job, printer)
    for section in [*job.config.of("extruder"), *_numbered(job, "extruder")]:
        _put_extruder(job, section, speed, accel)


def _put_axes(job: Import, printer: Section, kind: str, speed: float, accel: float) -> None:
    z_speed = printer.number("max_z_velocity", speed)
    z_accel = printer.number("max_z_accel", accel)
    for axis in "xyz":
        path = ("axes", axis)
        upright = axis == "z"
        if kind == "delta":
            _put_delta_axis(job, printer, axis)
        else:
            stepper = job.required(f"stepper_{axis}")
            low = stepper.number("position_min", 0.0)
            job.draft.put((*path, "min_mm"), low, stepper.at("position_min"))
            high = stepper.needed("position_max")
            if high > _LONGEST_MM:
                text = f"an axis of Passo ends at {_LONGEST_MM:g} mm at most"
                job.draft.changed(
                    stepper.at("position_max"), f"[stepper_{axis}] position_max", text
                )
                high = _LONGEST_MM
            job.draft.put((*path, "max_mm"), high, stepper.at("position_max"))
        names = ("max_z_velocity", "max_z_accel") if upright else ("max_velocity", "max_accel")
        values = (z_speed, z_accel) if upright else (speed, accel)
        for key, value, name in zip(("speed_mm_s", "accel_mm_s2"), values, names, strict=True):
            job.draft.put((*path, key), value, printer.at(name))


def _put_delta_axis(job: Import, printer: Section, axis: str) -> None:
    path = ("axes", axis)
    if axis == "z":
        ends = [job.required(f"stepper_{letter}") for letter in "abc"]
        first = ends[0]
        heights = [end.number("position_endstop", first.number("position_endstop")) for end in ends]
        top = min(height for height in heights if height is not None)
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
    angles = [tower.number("angle", usual) for tower, usual in zip(towers, _ANGLES, strict=True)]
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
    _put_homing(job, sections, names, letter, motor)


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
        raise section.missing("rotation_distance")
    put((*path, "rotation_distance_mm"), distance, section.at("rotation_distance"))
    _put_whole(job, section, name, first)
    ratio = _gear_ratio(section if "gear_ratio" in section.options else first)
    if ratio != 1.0:
        put((*path, "gear_ratio"), ratio, section.at("gear_ratio"))
    _put_pins(job, section, name, first)


def _put_whole(job: Import, section: Section, name: str, first: Section) -> int:
    """Imports the steps of a motor, and returns how many a rotation has."""
    steps = 1
    for option, (maximum, usual) in _WHOLE.items():
        source = section if option in section.options else first
        section.used.add(option)
        value = source.whole(option, 1, maximum)
        job.draft.put(("steppers", name, option), value, source.at(option))
        steps *= value or usual
    return steps


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
            continue
        run, hold = section.number("run_current"), section.number("hold_current")
        silent = section.number("stealthchop_threshold", 0.0)
        pins = {"uart_pin": "uart_pin", "tx_pin": "tx_pin", "cs_pin": "cs_pin"}
        pins |= {f"spi_software_{a}_pin": f"{b}_pin" for a, b in _SPI.items()}
        if chip in _CHIPS[2:] and "spi_software_sclk_pin" not in section.options:
            text = "Passo sets drivers over pins, not over the SPI unit of a chip: name the pins"
            job.draft.decide(section.at("spi_bus"), f"[{section.name}] spi_bus", text)
            section.used.update(section.options)
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
            address = section.whole("uart_address", 0, 3)
            put((*tmc, "address"), address, section.at("uart_address"))
        for option, key in pins.items():
            put((*tmc, key), job.pins.of(section, option), section.at(option))


_SPI = {"sclk": "clock", "mosi": "mosi", "miso": "miso"}


def _put_homing(
    job: Import, sections: list[Section], names: list[str], letter: str, motor: str
) -> None:
    first, put = sections[0], job.draft.put
    path = ("homing", motor if letter in "abc" else letter)
    written = first.text("endstop_pin")
    by_probe = "probe" in written and "virtual_endstop" in written
    if "virtual_endstop" in written and not by_probe:
        text = "homing without a switch (sensorless) is not there yet; the axis is not homed"
        job.draft.decide(first.at("endstop_pin"), f"[{first.name}] endstop_pin {written}", text)
        for name in ("position_endstop", "homing_speed", "homing_retract_dist"):
            first.used.add(name)
        return
    if by_probe:
        if job.probe_pin is not None:
            put((*path, "direction"), "min", first.at("endstop_pin"))
            put((*path, "probe"), True, first.at("endstop_pin"))
            _put_safe_home(job, path)
            _put_homing_speeds(job, first, path, letter)
        for section in sections:
            section.used |= {"endstop_pin", "position_endstop", "homing_speed"}
            section.used |= {"second_homing_speed", "homing_retract_dist"}
        return
    found = first.option("endstop_pin")
    if found is None:
        raise first.missing("endstop_pin")
    pin = job.pins.pin(first, "endstop_pin", found)
    if pin is None:
        return
    place = found.place
    towers = (job.config.get("stepper_a") or first) if letter in "abc" else first
    position = first.number("position_endstop", towers.number("position_endstop"))
    if position is None:
        raise first.missing("position_endstop")
    put((*path, "direction"), _direction(job, first, letter, position), place)
    if letter in "abc":
        position = _carriage_mm(job, first, position)
    put((*path, "position"), position, first.at("position_endstop"))
    own = {n: job.pins.of(s, "endstop_pin") for n, s in zip(names[1:], sections[1:], strict=True)}
    if own and all(own.values()):
        put((*path, "stepper_pins", motor), pin, place)
        for name, section in zip(names[1:], sections[1:], strict=True):
            put((*path, "stepper_pins", name), own[name], section.at("endstop_pin"))
    else:
        put((*path, "pin"), pin, place)
        if any(own.values()):
            text = "motors without an endstop of their own: all of the axis stop at the first one"
            job.draft.decide(place, f"[{first.name}] endstop_pin", text)
    _put_homing_speeds(job, first, path, letter)


def _put_safe_home(job: Import, path: KeyPath) -> None:
    """Imports [safe_z_home]: the position of the nozzle while the probe homes Z."""
    section = job.config.get("safe_z_home")
    place = pair(section, "home_xy_position") if section else None
    if section is None or place is None:
        return
    job.used.add(section.name)
    section.used |= {"speed", "z_hop", "z_hop_speed", "move_to_previous"}
    at = [round(mm + offset, 4) for mm, offset in zip(place, job.probe_offset, strict=True)]
    job.draft.put((*path, "probe_at_mm"), [*at], section.at("home_xy_position"))


def _put_homing_speeds(job: Import, section: Section, path: KeyPath, letter: str) -> None:
    """Imports the homing speeds; all towers have the speeds of the first one."""
    first = job.required("stepper_a") if letter in "abc" else section
    options = {
        "homing_speed": "fast",
        "homing_retract_dist": "retract",
        "second_homing_speed": "slow",
    }
    values = {"homing_speed": 5.0, "homing_retract_dist": 5.0}
    for option, key in options.items():
        source = section if option in section.options else first
        section.used.add(option)
        value = source.number(option, values.get(option))
        # Klipper's default for the second approach is half the speed of the first
        if value is None:
            value = (values["homing_speed"]) / 2
        values[option] = value
        job.draft.put((*path, key), value or None, source.at(option))


def _direction(job: Import, section: Section, letter: str, position: float) -> str:
    if letter in "abc":
        return "max"
    if "homing_positive_dir" in section.options:
        return "max" if section.flag("homing_positive_dir", False) else "min"
    low, high = section.number("position_min", 0.0), section.needed("position_max")
    assert low is not None
    return "min" if position <= (low + high) / 2 else "max"


def _carriage_mm(job: Import, section: Section, height: float) -> float:
    """The height of a carriage at its endstop, mm: the nozzle height plus the rise of the rod with
    the nozzle in the middle."""
    first = job.required("stepper_a")
    rod = section.number("arm_length", first.needed("arm_length"))
    radius = job.required("printer").needed("delta_radius")
    assert rod is not None
    if rod <= radius:
        raise bad(section.at("arm_length"), "arm_length", f"{rod:g}", f"more than {radius:g}")
    return round(height + math.sqrt(rod**2 - radius**2), 6)


def _put_extruder(job: Import, section: Section, speed: float, accel: float) -> None:
    number = section.kind.removeprefix("extruder") or "0"
    name = "e" if number == "0" else f"e{number}"
    job.used.add(section.name)
    if "step_pin" not in section.options:
        return  # a hotend with the motor of another extruder
    put_stepper(job, section, name, section)
    nozzle = section.number("nozzle_diameter", 0.4) or 0.4
    filament = section.number("filament_diameter", 1.75) or 1.75
    area = section.number("max_extrude_cross_section", 4 * nozzle**2) or 4 * nozzle**2
    ratio = area / (math.pi * (filament / 2) ** 2)
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
