"""Heaters, their sensors and protections, and fans."""

from __future__ import annotations

from math import exp, log
from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import NO_BUS, UNKNOWN_SENSOR, UNSAFE, bad
from passo.config.importing.klipper.buses import wires_of
from passo.config.importing.klipper.cfg import Section
from passo.config.part_names import part_name
from passo.config.sensor_names import values_of
from passo.config.thermistor import ZERO_C, Ntc

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath, Value
    from passo.config.importing.klipper.conversion import Import

_PT100_AMPLIFIER, _FULL_SCALE_V = "PT100 INA826", 5.0
_PLATINUM = ("pt1000", "pt100")
_AMPLIFIERS = ("AD595", "AD8495")
_CONVERTERS = ("MAX6675", "MAX31855", "MAX31856", "MAX31865")
# Klipper's values of a platinum sensor on a MAX31865.
_RTD = {
    "rtd_nominal_r": ("r0_ohm", 100),
    "rtd_reference_r": ("reference_ohm", 430.0),
    "rtd_num_of_wires": ("wires", 2),
}


def put_heat(job: Import) -> None:
    """Imports all heaters, then all fans. A heater without a sensor or a maximum temperature is
    left out."""
    for section in job.config.sections.values():
        kind = section.kind
        if kind.removeprefix("extruder").isdigit() or section.name == "extruder":
            if "heater_pin" in section.options:
                job.heaters[section.name] = f"hotend{kind.removeprefix('extruder')}"
        elif section.name == "heater_bed":
            job.heaters[section.name] = "bed"
        elif kind == "heater_generic":
            job.heaters[section.name] = part_name(section.rest)
    sections = [*job.heaters]
    job.heaters |= {name.partition(" ")[2]: job.heaters[name] for name in sections if " " in name}
    for section in [job.config.sections[name] for name in sections]:
        heater = job.heaters[section.name]
        if not job.part(section, _put_heater, "the heater"):
            job.lost_heaters.append(heater)
            job.heaters = {key: one for key, one in job.heaters.items() if one != heater}
    _put_fans(job)
    _put_tools(job)


def _put_heater(job: Import, section: Section) -> None:
    name = job.heaters[section.name]
    path, chamber = ("heaters", name), section.kind == "heater_generic"
    kind = "chamber" if chamber else "bed" if name == "bed" else "hotend"
    job.draft.put((*path, "kind"), kind, section.place)
    if chamber:
        job.draft.changed(section.place, f"[{section.name}]", "M141 and M191 set it, as a chamber")
    job.put("heater", section, name=name)
    further: list[Value] = [*job.pins.others_of(section, "heater_pin")]
    job.put_value((*path, "further_pins"), section, "heater_pin", further or None)
    put_sensor(job, section, path)
    control = section.text("control")
    kind = "bang-bang" if control == "watermark" else "pid"
    job.put_value((*path, "control", "kind"), section, "control", kind)
    if control in ("pid", "watermark"):
        job.put(control, section, name=name)
    else:
        text = "run an autotune of the heater (M303), and store it with M500"
        job.draft.decide(section.at("control"), f"[{section.name}] control {control}", text)
    protection = job.config.get(f"verify_heater {section.name}")
    if protection is not None:
        job.used.add(protection.name)
        job.put("verify_heater", protection, name=name)


def put_sensor(job: Import, section: Section, path: KeyPath) -> None:
    """Imports the sensor of a section to the part at `path`. Raises ConfigError."""
    written, place = section.text("sensor_type"), section.at("sensor_type")
    pullup = section.number("pullup_resistor", 4700.0)
    own = job.config.get(f"thermistor {written}")
    keys: dict[str, Any]
    if own is not None:
        job.used.add(own.name)
        ntc = _own_thermistor(own)
        keys = {"kind": "thermistor", "r25_ohm": ntc.r25_ohm, "beta_k": ntc.beta_k}
        keys |= {"c_per_k": ntc.c_per_k, "pullup_ohm": pullup}
    elif written.lower() in _PLATINUM:
        keys = {"kind": written.lower(), "pullup_ohm": pullup}
    elif written in _AMPLIFIERS:
        keys = {"kind": written.lower(), **_full_scale(section)}
    elif written in _CONVERTERS:
        keys = {"kind": written.lower(), **_converter_wires(job, section)}
        for option, (key, usual) in _RTD.items() if written == "MAX31865" else ():
            keys[key] = type(usual)(section.number(option) or usual)
    elif written == _PT100_AMPLIFIER:
        keys = {"kind": written, **_full_scale(section)}
    elif values_of(written) is not None:
        keys = {"kind": written} | ({"pullup_ohm": pullup} if pullup != 4700.0 else {})
    else:
        raise section.wrong("sensor_type", UNKNOWN_SENSOR)
    if keys.keys() == {"kind"} and values_of(written) is not None:
        job.draft.put((*path, "sensor"), written, place)
        return
    for key, value in keys.items():
        job.draft.put((*path, "sensor", key), value, place)


def _converter_wires(job: Import, section: Section) -> dict[str, str]:
    """The pins of a converter's bus. Raises ConfigError if they are not known."""
    wires = wires_of(job, section, "sensor_pin")
    if not wires:
        raise section.missing("spi_software_sclk_pin", NO_BUS)
    return wires


def _full_scale(section: Section) -> dict[str, float]:
    """The voltage of the ADC that reads an amplifier, if it is not the usual one."""
    volt = section.number("adc_voltage", _FULL_SCALE_V)
    return {"full_scale_v": volt} if volt and volt != _FULL_SCALE_V else {}


def _own_thermistor(section: Section) -> Ntc:
    """A [thermistor] from three points, or from one point and β."""
    beta = section.number("beta")
    if beta is not None:
        celsius, ohm = section.number("temperature1", 25.0), section.number("resistance1")
        if celsius is None or ohm is None:
            raise section.missing("resistance1", UNSAFE)
        try:
            return _with_beta(celsius, ohm, beta)
        except (ZeroDivisionError, OverflowError):
            raise section.wrong("beta", "a value in kelvin", f"{beta:g}") from None
    points: list[tuple[float, float]] = []
    for index in "123":
        celsius, ohm = (section.number(f"{what}{index}") for what in ("temperature", "resistance"))
        if celsius is None or ohm is None or ohm <= 0:
            raise section.missing(f"resistance{index}", UNSAFE)
        points.append((celsius, ohm))
    try:
        ntc = Ntc.through(points[0], points[1], points[2])
        if ntc.c_per_k >= 0:
            return ntc
        # Rounded points may give a slightly negative curvature; then only the outer two points are
        # used.
        (low_c, low_ohm), _, (high_c, high_ohm) = sorted(points)
        inverse = 1 / (low_c + ZERO_C) - 1 / (high_c + ZERO_C)
        return _with_beta(low_c, low_ohm, log(low_ohm / high_ohm) / inverse)
    except (ValueError, ZeroDivisionError, OverflowError):
        key = f"[{section.name}]"
        raise bad(section.place, key, str(points), "points of one falling curve") from None


def _with_beta(celsius: float, ohm: float, beta: float) -> Ntc:
    """A thermistor by one point and β. Raises ZeroDivisionError or OverflowError for values that no
    thermistor has."""
    return Ntc(ohm * exp(beta * (1 / (25.0 + ZERO_C) - 1 / (celsius + ZERO_C))), beta)


def _put_fans(job: Import) -> None:
    used = set[str]()
    for section in job.config.sections.values():
        kind, name = section.kind, part_name(section.rest or section.kind)
        if kind not in ("fan", "heater_fan", "controller_fan", "fan_generic", "temperature_fan"):
            continue
        name = "part" if section.name == "fan" else name
        while name in used:
            name += "_2"
        used.add(name)
        job.part(section, lambda job, section, name=name: _put_fan(job, section, ("fans", name)))


def _put_fan(job: Import, section: Section, path: KeyPath) -> None:
    put, kind, pin = job.draft.put, section.kind, job.pins.of(section, "pin")
    if pin is None:
        job.draft.dropped(section.place, f"[{section.name}]", "it has no pin that Passo drives")
        job.leave_out(section)
        return
    name = path[1]
    job.put("fan", section, name=name)
    further: list[Value] = [*job.pins.others_of(section, "pin")]
    job.put_value((*path, "further_pins"), section, "pin", further or None)
    power, option = section.number("max_power", 1.0) or 1.0, "max_power"
    if kind in ("heater_fan", "controller_fan") and "fan_speed" in section.options:
        power, option = power * (section.number("fan_speed") or 1.0), "fan_speed"
    job.put_value((*path, "max_power"), section, option, power if power < 1.0 else None)
    if kind in ("heater_fan", "controller_fan"):  # these fans always start with full power
        job.put(kind, section, name=name)
    else:
        job.put("fan_kick", section, name=name)
    if (*path, "tachometer", "pin") in job.draft.keys:
        tachometer = (*path, "tachometer")
        poll, poll_s = "tachometer_poll_interval", section.number("tachometer_poll_interval")
        pulses = section.number("tachometer_ppr")
        job.put_value((*tachometer, "pulses"), section, "tachometer_ppr", pulses and int(pulses))
        job.put_value((*tachometer, "poll_ms"), section, poll, poll_s and poll_s * 1000)
    if kind == "heater_fan":
        heaters = [h.strip() for h in section.text("heater", "extruder").split(",")]
        follows = job.heater(section, "heater", heaters[0])
        job.put_value((*path, "follows"), section, "heater", follows)
        also: list[Value] = [job.heater(section, "heater", one) for one in heaters[1:]]
        job.put_value((*path, "follows_heaters"), section, "heater", also or None)
    elif kind == "controller_fan":
        given = [s.strip() for s in section.text("stepper").split(",") if s.strip()]
        motors = [job.motor(section, one) for one in given] or job.motors
        job.put_value((*path, "follows_motors"), section, "stepper", [*motors])
        written = [h.strip() for h in section.text("heater", "extruder").split(",")]
        heaters = [job.heaters[one] for one in written if one in job.heaters]
        job.put_value((*path, "follows_targets"), section, "heater", [*heaters] or None)
    elif kind == "temperature_fan":
        job.put("temperature_fan", section, name=name)
        section.used.update(("control", "pid_deriv_time"))
        job.put_value((*path, "max_power"), section, "max_speed", section.number("max_speed"))
        job.draft.put((*path, "thermostat", "sensor"), name, section.place)
    elif kind == "fan_generic":
        job.fan_numbers += 1
        put((*path, "number"), job.fan_numbers, section.place)
        text = f"M106 P{job.fan_numbers} sets it"
        job.draft.changed(section.place, f"[{section.name}]", text)


def _put_tools(job: Import) -> None:
    """Makes a tool for each extruder, if there are several."""
    extruders = [name for name in job.motors if name.startswith("e")]
    if len(extruders) < 2:
        return
    tools: list[Any] = []
    for name in extruders:
        heater = f"hotend{name[1:]}"
        tools.append(
            {"extruder": name} | ({"heater": heater} if heater in job.heaters.values() else {})
        )
    job.draft.put(("tools",), tools, None)
