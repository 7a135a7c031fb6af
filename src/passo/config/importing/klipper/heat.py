"""Heaters, their sensors and protections, and fans."""

from __future__ import annotations

from math import exp, log
from typing import TYPE_CHECKING, Any

from passo.config.importing.draft import MOTORS_ALONE, bad
from passo.config.importing.klipper.buses import wires_of_bus
from passo.config.importing.klipper.cfg import Section
from passo.config.importing.klipper.pins import JOINED
from passo.config.part_names import part_name
from passo.config.pin_names import named_on, placed
from passo.config.sensor_names import values_of
from passo.config.thermistor import ZERO_C, Ntc
from passo.errors import ConfigError

if TYPE_CHECKING:
    from passo.config.importing.draft import KeyPath
    from passo.config.importing.klipper.conversion import Import

_PT100_AMPLIFIER, _FULL_SCALE_V = "PT100 INA826", 5.0
_PLATINUM = {"pt1000": "pt1000", "pt100": "pt100"}
_AMPLIFIERS = {"AD595": "ad595", "AD8494": None, "AD8495": "ad8495", "AD8496": None, "AD8497": None}
_CONVERTERS = {
    "MAX6675": "max6675",
    "MAX31855": "max31855",
    "MAX31856": "max31856",
    "MAX31865": "max31865",
}
_FAN_S, _HEATER_S = 0.01, 0.1  # Klipper's cycles
_SPI = {
    "spi_software_sclk_pin": "clock_pin",
    "spi_software_miso_pin": "miso_pin",
    "spi_software_mosi_pin": "mosi_pin",
}
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
    path, put = ("heaters", name), job.draft.put
    chamber = section.kind == "heater_generic"
    kind = "chamber" if chamber else "bed" if name == "bed" else "hotend"
    put((*path, "kind"), kind, section.place)
    if chamber:
        job.draft.changed(section.place, f"[{section.name}]", "M141 and M191 set it, as a chamber")
    for option, key in (("heater_pin", "pin"), ("sensor_pin", "sensor_pin")):
        pin, found = job.pins.of(section, option), section.options.get(option)
        if found is None:
            raise _needed(section, option)
        if pin is None:
            limit = "a pin of a board"
            if found.text.startswith(JOINED):
                limit = "one pin of a board: Passo does not switch several outputs together"
            raise bad(found.place, f"{option} in [{section.name}]", found.text, limit)
        put((*path, key), pin, found.place)
    _put_sensor(job, section, path)
    for option, key in (("min_temp", "min_c"), ("max_temp", "max_c")):
        value = section.number(option)
        if value is None:
            raise _needed(section, option)
        put((*path, key), value, section.at(option))
    power = section.number("max_power")
    put((*path, "max_power"), power, section.at("max_power"))
    _put_frequency(job, section, path, "pwm_cycle_time", _HEATER_S)
    _put_control(job, section, path)
    _put_protection(job, section, path)


def _put_control(job: Import, section: Section, path: KeyPath) -> None:
    put, control = job.draft.put, section.text("control")
    place = section.at("control")
    if control == "watermark":
        put((*path, "control", "kind"), "bang-bang", place)
        put(
            (*path, "control", "hysteresis_c"),
            section.number("max_delta", 2.0),
            section.at("max_delta"),
        )
        return
    put((*path, "control", "kind"), "pid", place)
    if control == "pid":
        for gain in ("kp", "ki", "kd"):
            put((*path, "control", gain), section.number(f"pid_{gain}"), section.at(f"pid_{gain}"))
        return
    text = "run an autotune of the heater (M303), and store it with M500"
    job.draft.decide(place, f"[{section.name}] control {control}", text)


def _put_protection(job: Import, heater: Section, path: KeyPath) -> None:
    section = job.config.get(f"verify_heater {heater.name}")
    if section is None:
        return
    job.used.add(section.name)
    put, keys = job.draft.put, (*path, "protection")
    put((*keys, "watch_s"), section.number("check_gain_time"), section.at("check_gain_time"))
    put((*keys, "watch_rise_c"), section.number("heating_gain"), section.at("heating_gain"))
    put((*keys, "runaway_c"), section.number("hysteresis"), section.at("hysteresis"))
    if "max_error" in section.options:
        text = "Passo has a time in its place: a heater below its target for 40 s is a fault"
        job.draft.changed(section.at("max_error"), f"[{section.name}] max_error", text)
        section.used.add("max_error")


def _put_sensor(job: Import, section: Section, path: KeyPath) -> None:
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
        keys = {"kind": _PLATINUM[written.lower()], "pullup_ohm": pullup}
    elif _AMPLIFIERS.get(written):
        keys = {"kind": _AMPLIFIERS[written], **_full_scale(section)}
    elif written in _CONVERTERS:
        keys = {"kind": _CONVERTERS[written], **_converter_wires(job, section)}
        for option, (key, usual) in _RTD.items() if written == "MAX31865" else ():
            keys[key] = type(usual)(section.number(option) or usual)
    elif written == _PT100_AMPLIFIER:
        keys = {"kind": written, **_full_scale(section)}
    elif values_of(written) is not None:
        keys = {"kind": written} | ({"pullup_ohm": pullup} if pullup != 4700.0 else {})
    else:
        key = f"sensor_type in [{section.name}]"
        limit = "a sensor that Passo has; docs/reference/sensors.md lists them"
        raise bad(place, key, written, limit)
    if keys.keys() == {"kind"} and values_of(written) is not None:
        job.draft.put((*path, "sensor"), written, place)
        return
    for key, value in keys.items():
        job.draft.put((*path, "sensor", key), value, place)


def _converter_wires(job: Import, section: Section) -> dict[str, str]:
    """The pins of a converter's bus: those in the section, or those of a unit of the chip, which
    Passo drives in software. Raises ConfigError if they are not known."""
    section.used.add("spi_speed")
    pins = {key: job.pins.of(section, option) for option, key in _SPI.items()}
    given = {key: pin for key, pin in pins.items() if pin is not None}
    if len(given) == len(pins):
        section.used.add("spi_bus")
        return given
    bus = section.text("spi_bus")
    wires = wires_of_bus(bus)
    if wires is None:
        place = section.at("spi_bus")
        missing = next(option for option, key in _SPI.items() if key not in given)
        limit = "three pins for the converter's bus: Passo does not use the chip's SPI unit"
        key = f"{missing} in [{section.name}]"
        raise ConfigError.of("config.missing-key", place.file, place.line, key=key, limit=limit)
    board = placed(job.pins.of(section, "sensor_pin") or "")[0]
    keys = ("miso_pin", "mosi_pin", "clock_pin")
    found = {key: named_on(board, pin) for key, pin in zip(keys, wires, strict=True)}
    text = f"its pins are {', '.join(found.values())}, which Passo drives in software"
    job.draft.changed(section.at("spi_bus"), f"[{section.name}] spi_bus {bus}", text)
    return found


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
            raise _needed(section, "resistance1")
        try:
            return _with_beta(celsius, ohm, beta)
        except (ZeroDivisionError, OverflowError):
            key = f"beta in [{section.name}]"
            raise bad(section.at("beta"), key, f"{beta:g}", "a value in kelvin") from None
    points: list[tuple[float, float]] = []
    for index in "123":
        celsius, ohm = (section.number(f"{what}{index}") for what in ("temperature", "resistance"))
        if celsius is None or ohm is None or ohm <= 0:
            raise _needed(section, f"resistance{index}")
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
        job.left_out.add(section.name)
        section.used.update(section.options)
        return
    put((*path, "pin"), pin, section.at("pin"))
    power, option = section.number("max_power", 1.0) or 1.0, "max_power"
    if kind in ("heater_fan", "controller_fan") and "fan_speed" in section.options:
        power, option = power * (section.number("fan_speed") or 1.0), "fan_speed"
    put((*path, "max_power"), power if power < 1.0 else None, section.at(option))
    off = section.number("off_below", 0.0)
    put((*path, "off_below"), off or None, section.at("off_below"))
    kick = section.number("kick_start_time", 0.1)
    if kind not in ("heater_fan", "controller_fan"):  # these fans always start with full power
        put((*path, "kick_start_s"), kick, section.at("kick_start_time"))
    _put_frequency(job, section, path, "cycle_time", _FAN_S)
    if kind == "heater_fan":
        heaters = [h.strip() for h in section.text("heater", "extruder").split(",")]
        put((*path, "follows"), job.heater(section, "heater", heaters[0]), section.at("heater"))
        put((*path, "above_c"), section.number("heater_temp", 50.0), section.at("heater_temp"))
        if heaters[1:]:
            text = f"a fan follows one heater: it follows {heaters[0]} alone"
            job.draft.changed(section.at("heater"), f"[{section.name}] heater", text)
    elif kind == "controller_fan":
        given = [s.strip() for s in section.text("stepper").split(",") if s.strip()]
        motors = [job.motor(section, one) for one in given] or job.motors
        put((*path, "follows_motors"), [*motors], section.at("stepper"))
        stays = section.number("idle_timeout", 30.0)
        put((*path, "stays_on_s"), stays, section.at("idle_timeout"))
        section.used.add("heater")
        job.draft.changed(section.at("heater"), f"[{section.name}] heater", MOTORS_ALONE)
    elif kind in ("fan_generic", "temperature_fan"):
        job.fan_numbers += 1
        put((*path, "number"), job.fan_numbers, section.place)
        text = f"M106 P{job.fan_numbers} sets it"
        if kind == "fan_generic":
            job.draft.changed(section.place, f"[{section.name}]", text)
        else:
            text = f"it is off until {text}: Passo does not control a fan by a temperature"
            job.draft.decide(section.place, f"[{section.name}]", text)
            section.used.update(section.options)


def _put_frequency(
    job: Import, section: Section, path: KeyPath, option: str, usual_s: float
) -> None:
    """Converts the cycle of an output, from the option or Klipper's value without it, to pulses per
    second."""
    hz = 1 / (section.number(option) or usual_s)
    job.draft.put((*path, "pwm_hz"), float(f"{hz:.6g}"), section.at(option))


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


def _needed(section: Section, name: str) -> ConfigError:
    place, key = section.place, f"{name} in [{section.name}]"
    limit = "a value, without which the heater is not safe"
    return ConfigError.of("config.missing-key", place.file, place.line, key=key, limit=limit)
