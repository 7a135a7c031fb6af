"""Checks between the parts of a machine file.

They read the raw tables, not the models, so that a wrong value elsewhere does not hide their
findings. Values of the wrong type are skipped here; the models report them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from passo.config.accelerometer import check_accelerometer
from passo.config.driver_checks import check_drivers, check_thresholds
from passo.config.eddy_checks import check_eddy_wiring
from passo.config.findings import Finding, array, did_you_mean, number, table, tables
from passo.config.heat_checks import check_fans, check_heaters, check_pulses
from passo.config.i2c_sensors import check_i2c_sensors
from passo.config.inputs import check_inputs
from passo.config.klipper_options.check import check_kept_options
from passo.config.light_effects import check_light_effects
from passo.config.lights import check_lights
from passo.config.macro_checks import check_macros
from passo.config.motor_roles import Drivable, Driven, axis_order
from passo.config.output_checks import check_names, check_outputs, check_shown_sensors
from passo.config.pin_checks import check_pins
from passo.config.servos import check_servos
from passo.geometry.base import GeometryModel

Raw = Mapping[str, Any]

_MAX_FURTHER_AXES = 4
_STILL = "none"  # the kind of a geometry without X, Y and Z
_PER_MM = ("steps_per_mm", "rotation_distance_mm")
_LIMIT_KEYS = ("speed_{}_s", "accel_{}_s2", "min_{}", "max_{}")
# Keys of fans that commands do not set.
_LEADERS = {"follows", "follows_heaters", "follows_motors", "follows_targets", "thermostat"}


def check_link(data: Raw) -> Iterator[Finding]:
    """Checks that a real board has a valid address, that all boards are real or all are simulated,
    and that only a further, simulated board has a different clock."""
    main = table(data, "board")
    for key in ("drift_ppm", "start_s"):
        if number(main, key):
            limit = "0: the machine's time is this board's clock"
            yield Finding("config.conflict", ("board", key), main[key], limit)
    yield from _check_port(main, ("board",))
    for name, board in tables(data, "boards"):
        yield from _check_port(board, ("boards", name))
        link = board.get("link", "simulated")
        simulated = main.get("link", "simulated") == "simulated"
        if (link == "simulated") != simulated:
            limit = "simulated, as board is" if simulated else "serial or tcp, as board is"
            yield Finding("config.conflict", ("boards", name, "link"), link, limit)


def _check_port(board: Raw, place: tuple[str, ...]) -> Iterator[Finding]:
    link, port = board.get("link", "simulated"), board.get("port")
    path = (*place, "port")
    if link == "serial" and not port:
        yield Finding("config.missing-key", path, None, "a serial device such as /dev/ttyUSB0")
    host, _, number_ = port.rpartition(":") if isinstance(port, str) else ("", "", "")
    if link == "tcp" and not (host and number_.isdecimal() and 0 < int(number_) < 65536):
        code = "config.missing-key" if port is None else "config.value"
        yield Finding(code, path, port, "host:port, such as 192.168.1.20:8888")


def with_still_axes(data: Raw) -> Raw:
    """The same data; on a machine without X, Y and Z, these have a place that they never leave."""
    if table(data, "geometry").get("kind") != _STILL:
        return data
    still = {"min_mm": 0.0, "max_mm": 1.0, "speed_mm_s": 100.0, "accel_mm_s2": 1000.0}
    return {**data, "axes": {**{name: {**still} for name in "xyz"}, **table(data, "axes")}}


def check_axes(data: Raw, actuators: tuple[str, ...], *, still: bool = False) -> Iterator[Finding]:
    """Checks that X, Y and Z exist, unless the machine stands `still`, that further axes are at
    most four with different names, and that minima are below maxima."""
    axes = table(data, "axes")
    for name in "xyz":
        if still and name in axes:
            limit = f"no table: a machine of the kind {_STILL} has no X, Y and Z"
            yield Finding("config.conflict", ("axes", name), name, limit)
        elif not still and name not in axes:
            yield Finding("config.missing-key", ("axes", name), None, "a table with its limits")
    further = axis_order(axes)[3:]
    if len(further) > _MAX_FURTHER_AXES:
        limit = f"at most {_MAX_FURTHER_AXES} axes besides x, y, z"
        yield Finding("config.value", ("axes",), ", ".join(further), limit)
    for name in further:
        if name in actuators:
            limit = "a letter that is not an actuator of the geometry"
            yield Finding("config.conflict", ("axes", name), name, limit)
    for name, axis in tables(data, "axes"):
        yield from _check_extruder_axis(data, name, axis)
        yield from _check_range(("axes", name), axis, "mm")
        home, low, high = number(axis, "home_mm"), number(axis, "min_mm"), number(axis, "max_mm")
        if home is not None and high is not None and not (low or 0) <= home <= high:
            limit = f"a position between {low or 0:g} and {high:g}"
            yield Finding("config.value", ("axes", name, "home_mm"), home, limit)


def _check_extruder_axis(data: Raw, name: str, axis: Raw) -> Iterator[Finding]:
    """Checks that a further axis for filament has a hotend, and neither limits nor an endstop."""
    path, heater = ("axes", name), axis.get("heater")
    if axis.get("extruder") is not True:
        if heater is not None:
            limit = "no heater: this axis is not an extruder"
            yield Finding("config.conflict", (*path, "heater"), heater, limit)
        return
    if name in ("x", "y", "z"):
        limit = "a further axis, such as u"
        yield Finding("config.conflict", (*path, "extruder"), "true", limit)
    for key in ("min_mm", "max_mm", "home_mm"):
        if key in axis:
            limit = "no such key: filament has no limits"
            yield Finding("config.conflict", (*path, key), axis[key], limit)
    if name in table(data, "homing"):
        limit = "no table: filament has no home"
        yield Finding("config.conflict", ("homing", name), name, limit)
    known = table(data, "heaters")
    if isinstance(heater, str) and heater not in known:
        hint = did_you_mean(heater, known)
        limit = "the name of one of the heaters"
        yield Finding("config.value", (*path, "heater"), heater, limit, hint)


def _check_range(path: tuple[str, ...], content: Raw, unit: str) -> Iterator[Finding]:
    low, high = number(content, f"min_{unit}"), number(content, f"max_{unit}")
    if low is not None and high is not None and low >= high:
        limit = f"more than min_{unit}, which is {low:g}"
        yield Finding("config.value", (*path, f"max_{unit}"), high, limit)


def check_steppers(
    data: Raw, actuators: tuple[str, ...], rotary: tuple[str, ...]
) -> Iterator[Finding]:
    """Checks that each motor drives a part, in the right unit, and that each moving part has a
    motor."""
    drivable = Drivable(actuators, axis_order(table(data, "axes")), table(data, "extruders"))
    driven_names: set[Driven] = set()
    for name, stepper in tables(data, "steppers"):
        path = ("steppers", name)
        driven = drivable.of(name, stepper.get("drives"))
        if driven is None:
            word = stepper.get("drives", name)
            hint = did_you_mean(word, drivable.by_name)
            limit = "the name of an actuator, axis or extruder"
            yield Finding("config.value", (*path, "drives"), word, limit, hint)
            continue
        driven_names.add(driven)
        turns = driven.drive == "actuator" and actuators[driven.index] in rotary
        yield from _check_scale(path, stepper, turns)
        yield from _check_range(path, stepper, "deg" if turns else "mm")
        yield from check_thresholds(stepper, path, turns)
    for name, driven in drivable.by_name.items():
        if driven not in driven_names:
            limit = f"a motor that drives {driven.drive} {name}"
            yield Finding("config.missing-key", ("steppers", name), None, limit)


def _check_scale(path: tuple[str, ...], stepper: Raw, turns: bool) -> Iterator[Finding]:
    given = [key for key in (*_PER_MM, "steps_per_degree") if key in stepper]
    right = ("steps_per_degree",) if turns else _PER_MM
    wanted = "steps_per_degree or gear_ratio" if turns else " or ".join(_PER_MM)
    geared = turns and "gear_ratio" in stepper
    for key in given:
        if key not in right:
            limit = f"{wanted} for a {'turning' if turns else 'linear'} motor"
            yield Finding("config.conflict", (*path, key), stepper[key], limit)
    if not given and not geared:
        yield Finding("config.missing-key", (*path, right[0]), None, wanted)
    elif len([key for key in given if key in right]) + geared > 1:
        yield Finding("config.conflict", (*path, given[-1]), stepper[given[-1]], f"only {wanted}")
    wrong, unit = ("mm", "deg") if turns else ("deg", "mm")
    for pattern in _LIMIT_KEYS:
        key = pattern.format(wrong)
        if key in stepper:
            limit = f"{pattern.format(unit)} here"
            yield Finding("config.conflict", (*path, key), stepper[key], limit)


def check_references(data: Raw) -> Iterator[Finding]:
    """Checks that tools name existing extruders, heaters and fans."""
    commanded = [name for name, fan in tables(data, "fans") if not _LEADERS & fan.keys()]
    for index, tool in enumerate(array(data, "tools")):
        for i, fan in enumerate(array(table(tool), "fans")):
            if isinstance(fan, str) and fan not in commanded:
                limit, hint = "the name of a fan that M106 sets", did_you_mean(fan, commanded)
                yield Finding("config.value", ("tools", index, "fans", i), fan, limit, hint)
        for key in ("extruder", "heater"):
            word, known = table(tool).get(key), table(data, f"{key}s")
            if isinstance(word, str) and word not in known:
                path, hint = ("tools", index, key), did_you_mean(word, known)
                limit = f"the name of one of the {key}s"
                yield Finding("config.value", path, word, limit, hint)


def check_homing(data: Raw, model: type[GeometryModel]) -> Iterator[Finding]:
    """Checks that each homed part exists, and has one endstop or one for each of its motors."""
    axes, actuators, arms = axis_order(table(data, "axes")), _actuators(data, model), model.arms
    drivable = Drivable(actuators, axes, table(data, "extruders"))
    alone = [axis for axis in axes if axis in actuators or axis not in axes[:2]]
    names = [*arms, *alone] if arms else axes if model.homes else axes[3:]
    sections = dict(tables(data, "homing"))
    for name, homing in sections.items():
        path = ("homing", name)
        if name not in names:
            limit = f"one of {', '.join(dict.fromkeys(names))}"
            yield Finding("config.unknown-key", path, name, limit, did_you_mean(name, names))
        pins, by_probe = table(homing, "stepper_pins"), homing.get("probe") is True
        if ("pin" in homing) + bool(pins) + by_probe + ("stall" in homing) != 1:
            limit = "either pin, or stepper_pins with a pin for each motor, or stall"
            limit += ", or probe = true" if name == "z" else ""
            yield Finding("config.conflict", (*path, "pin"), homing.get("pin"), limit)
        if by_probe and (name != "z" or arms):
            limit = "false: the probe homes only the axis Z, of a machine without arms or towers"
            yield Finding("config.conflict", (*path, "probe"), True, limit)
        for stepper in pins:
            drives = table(data, "steppers", stepper).get("drives")
            if stepper not in table(data, "steppers") or drivable.of(stepper, drives) is None:
                limit = "the name of a motor of this axis"
                yield Finding("config.value", (*path, "stepper_pins", stepper), stepper, limit)
    if any(name in sections for name in arms):
        for name in arms:
            if name not in sections and name not in model.free:
                yield Finding(
                    "config.missing-key", ("homing", name), None, "a table like its twins'"
                )


def _actuators(data: Raw, model: type[GeometryModel]) -> tuple[str, ...]:
    return model.motors_of(table(data, "geometry"))


def _check_endless(data: Raw, model: type[GeometryModel]) -> Iterator[Finding]:
    """Checks that motors that turn without end have no limits of their position."""
    for name in model.endless:
        for key in ("min_deg", "max_deg"):
            if key in (stepper := table(data, "steppers", name)):
                limit = "no such key: it turns without end"
                yield Finding("config.conflict", ("steppers", name, key), stepper[key], limit)


def check_all(data: Raw, model: type[GeometryModel] | None) -> Iterator[Finding]:
    """Runs all checks; without a known geometry, skips those that need it."""
    parts: list[Callable[[Raw], Iterator[Finding]]] = [
        check_references,
        check_heaters,
        check_fans,
        check_pulses,
        check_outputs,
        check_lights,
        check_light_effects,
        check_servos,
        check_shown_sensors,
        check_i2c_sensors,
        check_names,
        check_drivers,
        check_pins,
        check_accelerometer,
        check_eddy_wiring,
        check_inputs,
        check_macros,
        check_kept_options,
    ]
    yield from check_link(data)
    if model is None:
        yield from check_axes(data, ())
    else:
        actuators = _actuators(data, model)
        yield from check_axes(data, actuators, still=not actuators)
        yield from check_steppers(data, actuators, model.rotary)
        yield from check_homing(data, model)
        yield from _check_endless(data, model)
    for check in parts:
        yield from check(data)
