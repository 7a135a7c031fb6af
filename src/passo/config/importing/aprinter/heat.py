"""Heaters and fans of APrinter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad

if TYPE_CHECKING:
    from passo.config.importing.aprinter.conversion import Job
    from passo.config.importing.aprinter.document import Node

_KINDS = {"Extruder": "hotend", "Bed": "bed", "Chamber": "chamber"}


def put_heat(job: Job) -> None:
    """Converts all heaters and fans. Raises ConfigError for a sensor that Passo does not
    support."""
    for heater in job.config.each("heaters"):
        _put_heater(job, heater)
    for fan in job.config.each("fans"):
        number = job.stored.needed(fan, "Number").whole(0, 99)
        path, output = ("fans", f"fan{number or ''}"), fan.within("pwm_output")
        job.draft.put((*path, "pin"), job.pins.output(output), output.place)
        job.draft.put((*path, "number"), number or None, fan.within("Number").place)


def heater_name(heater: Node) -> str:
    """The name of a heater in the machine file. Raises ConfigError for an unknown kind."""
    kind, number = heater.within("Type"), heater.within("Type", "Number").scalar
    if kind.kind not in _KINDS or not isinstance(number, int) or not 0 <= number <= 99:
        raise bad(kind.place, "Type", kind.kind[:40], f"{', '.join(_KINDS)}, with a number")
    return f"{_KINDS[kind.kind]}{number or ''}"


def _put_heater(job: Job, heater: Node) -> None:
    name, kind = heater_name(heater), heater.within("Type")
    path, put, stored = ("heaters", name), job.draft.put, job.stored
    prefix = f"{kind.kind}Heater{heater.within('Type', 'Number').scalar}"
    output, sensor = heater.within("pwm_output"), heater.within("ThermistorInput")
    put((*path, "kind"), _KINDS[kind.kind], kind.place)
    put((*path, "pin"), job.pins.output(output), output.place)
    put((*path, "sensor_pin"), job.pins.sensor(sensor), sensor.place)
    _put_sensor(job, heater.within("conversion"), prefix, name)
    control = heater.within("control")
    put((*path, "control", "kind"), "pid", control.place)
    job.rows("heater", heater, prefix, name=name)
    history = stored.number(control, "PidDHistory", f"{prefix}PidDHistory")
    interval = stored.number(control, "ControlInterval", f"{prefix}ControlInterval")
    if history and interval and 0 < history.value < 1 and interval.value > 0:
        # The filter keeps this share of its value in each interval.
        seconds = interval.value * history.value / (1 - history.value)
        put((*path, "control", "filter_s"), float(f"{seconds:.6g}"), history.place)


def _put_sensor(job: Job, conversion: Node, prefix: str, name: str) -> None:
    """Converts a thermistor with R0 and β, or a platinum resistor with R0. For other sensors, the
    document lacks data on pins and amplifiers that Passo needs."""
    kind, prefix = ("heaters", name, "sensor", "kind"), f"{prefix}Temp"
    if conversion.kind == "PtRtdFormula":
        r0 = job.stored.needed(conversion, "PtR0", f"{prefix}PtR0")
        if r0.value not in (100, 1000):
            raise bad(r0.place, "PtR0", f"{r0.value:g}", "100 or 1000")
        job.draft.put(kind, f"pt{r0.value:g}", r0.place)
    elif conversion.kind == "conversion":
        job.draft.put(kind, "thermistor", conversion.place)
        job.rows("thermistor", conversion, prefix, name=name)
    else:
        limit = "a thermistor or a PT100 or PT1000: give the sensor by hand, from sensors.md"
        raise bad(conversion.place, "conversion", conversion.kind[:40], limit)
    job.rows("sensor", conversion, prefix, name=name)
