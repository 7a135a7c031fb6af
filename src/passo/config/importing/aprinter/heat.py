"""Heaters and fans of APrinter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from passo.config.importing.draft import bad

if TYPE_CHECKING:
    from passo.config.importing.aprinter.boards import Pins
    from passo.config.importing.aprinter.document import Node, Stored
    from passo.config.importing.draft import Draft, KeyPath
    from passo.config.importing.numbers import Read

_KINDS = {"Extruder": "hotend", "Bed": "bed", "Chamber": "chamber"}
_FULL = 255.0  # of the gains of Passo; APrinter's are of full power


def put_heat(config: Node, pins: Pins, stored: Stored, draft: Draft) -> None:
    """Converts all heaters and fans. Raises ConfigError for a sensor that Passo does not
    support."""
    for heater in config.each("heaters"):
        _put_heater(heater, pins, stored, draft)
    for fan in config.each("fans"):
        number = stored.needed(fan, "Number").whole(0, 99)
        path, output = ("fans", f"fan{number or ''}"), fan.within("pwm_output")
        draft.put((*path, "pin"), pins.output(output), output.place)
        draft.put((*path, "number"), number or None, fan.within("Number").place)


def heater_name(heater: Node) -> str:
    """The name of a heater in the machine file. Raises ConfigError for an unknown kind."""
    kind, number = heater.within("Type"), heater.within("Type", "Number").scalar
    if kind.kind not in _KINDS or not isinstance(number, int) or not 0 <= number <= 99:
        raise bad(kind.place, "Type", kind.kind[:40], f"{', '.join(_KINDS)}, with a number")
    return f"{_KINDS[kind.kind]}{number or ''}"


def _put_heater(heater: Node, pins: Pins, stored: Stored, draft: Draft) -> None:
    name, kind = heater_name(heater), heater.within("Type")
    path = ("heaters", name)
    prefix = f"{kind.kind}Heater{heater.within('Type', 'Number').scalar}"
    output, sensor = heater.within("pwm_output"), heater.within("ThermistorInput")

    def put(key: KeyPath, found: Read | None, scale: float = 1.0) -> None:
        if found is not None:
            draft.put((*path, *key), float(f"{found.value * scale:.10g}"), found.place)

    draft.put((*path, "kind"), _KINDS[kind.kind], kind.place)
    draft.put((*path, "pin"), pins.output(output), output.place)
    draft.put((*path, "sensor_pin"), pins.sensor(sensor), sensor.place)
    _put_sensor(heater.within("conversion"), prefix, stored, draft, path)
    put(("min_c",), stored.needed(heater, "MinSafeTemp", f"{prefix}MinSafeTemp"))
    put(("max_c",), stored.needed(heater, "MaxSafeTemp", f"{prefix}MaxSafeTemp"))
    control = heater.within("control")
    draft.put((*path, "control", "kind"), "pid", control.place)
    for gain in "PID":
        option = f"{prefix}Pid{gain}"
        put(("control", f"k{gain.lower()}"), stored.needed(control, f"Pid{gain}", option), _FULL)
    for end in ("Min", "Max"):
        option = f"{prefix}PidIState{end}"
        put(("control", f"drive_{end.lower()}"), stored.number(control, f"PidIState{end}", option))
    history = stored.number(control, "PidDHistory", f"{prefix}PidDHistory")
    interval = stored.number(control, "ControlInterval", f"{prefix}ControlInterval")
    if history and interval and 0 < history.value < 1 and interval.value > 0:
        # The filter keeps this share of its value in each interval.
        seconds = interval.value * history.value / (1 - history.value)
        draft.put((*path, "control", "filter_s"), float(f"{seconds:.6g}"), history.place)
    observer = heater.get("observer")
    if observer is not None:
        for key, word in (("window_c", "ObserverTolerance"), ("seconds", "ObserverMinTime")):
            put(("arrival", key), stored.number(observer, word, f"{prefix}{word}"))
        window = stored.number(observer, "ObserverTolerance", f"{prefix}ObserverTolerance")
        if window is not None and window.value > 3:
            put(("arrival", "leaves_c"), window)


def _put_sensor(conversion: Node, prefix: str, stored: Stored, draft: Draft, path: KeyPath) -> None:
    """Converts a thermistor with R0 and β, or a platinum resistor with R0. For other sensors, the
    document lacks data on pins and amplifiers that Passo needs."""
    keys = (*path, "sensor")
    resistor = stored.number(conversion, "ResistorR", f"{prefix}TempResistorR")
    if conversion.kind == "PtRtdFormula":
        r0 = stored.needed(conversion, "PtR0", f"{prefix}TempPtR0")
        if r0.value not in (100, 1000):
            raise bad(r0.place, "PtR0", f"{r0.value:g}", "100 or 1000")
        draft.put((*keys, "kind"), f"pt{r0.value:g}", r0.place)
    elif conversion.kind == "conversion":
        draft.put((*keys, "kind"), "thermistor", conversion.place)
        for key, word, option in (("r25_ohm", "R0", "TempR0"), ("beta_k", "Beta", "TempBeta")):
            found = stored.needed(conversion, word, f"{prefix}{option}")
            draft.put((*keys, key), found.value, found.place)
    else:
        limit = "a thermistor or a PT100 or PT1000: give the sensor by hand, from sensors.md"
        raise bad(conversion.place, "conversion", conversion.kind[:40], limit)
    if resistor is not None:
        draft.put((*keys, "pullup_ohm"), resistor.value, resistor.place)
