"""Checks the outputs of a machine file, and the sensors without a heater."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from passo.config.findings import Finding, array, did_you_mean, number, table, tables
from passo.config.sensor_names import SHOWN_KINDS

Raw = Mapping[str, Any]

_NO_PIN = SHOWN_KINDS  # of sensors that need no `sensor_pin`


def check_outputs(data: Raw) -> Iterator[Finding]:
    """Checks that outputs have values that their boards can keep, and different numbers and
    uses."""
    owners: dict[tuple[str, object], str] = {}
    for name, output in tables(data, "outputs"):
        path, pwm = ("outputs", name), output.get("pwm", "none")
        start, at_halt = (number(output, key) or 0.0 for key in ("start", "at_halt"))
        if at_halt not in (0, 1) and pwm != "hardware":
            limit = '0 or 1, except with pwm = "hardware"'
            yield Finding("config.value", (*path, "at_halt"), at_halt, limit)
        if start not in (0, 1) and pwm == "none":
            yield Finding("config.value", (*path, "start"), start, "0 or 1 without pwm")
        if number(output, "max_on_s") and start != at_halt:
            limit = "the value of start, with max_on_s"
            yield Finding("config.conflict", (*path, "at_halt"), at_halt, limit)
        if "pwm_hz" in output and pwm == "none":
            limit = 'no such key without pwm = "software" or "hardware"'
            yield Finding("config.conflict", (*path, "pwm_hz"), output["pwm_hz"], limit)
        for key in ("number", "use"):
            value = output.get(key)
            owner = name if value is None else owners.setdefault((key, value), name)
            if owner != name:
                limit = f"a {key} of its own: it belongs to outputs.{owner}"
                yield Finding("config.conflict", (*path, key), value, limit)


def check_shown_sensors(data: Raw) -> Iterator[Finding]:
    """Checks that sensors without a heater have a pin if they need one, a range, and a letter of
    their own."""
    letters = dict.fromkeys("TB", "the heaters")
    if any(heater.get("kind") == "chamber" for _, heater in tables(data, "heaters")):
        letters["C"] = "the chamber"
    for name, shown in tables(data, "sensors"):
        path, sensor = ("sensors", name), table(shown, "sensor")
        kind, board = sensor.get("kind"), sensor.get("board")
        if kind in _NO_PIN and "sensor_pin" in shown:
            limit = f"no such key: a sensor of the kind {kind} has no pin"
            yield Finding("config.conflict", (*path, "sensor_pin"), shown["sensor_pin"], limit)
        elif kind not in _NO_PIN and "sensor_pin" not in shown:
            yield Finding("config.missing-key", (*path, "sensor_pin"), None, "a pin in quotes")
        if isinstance(board, str) and board not in table(data, "boards"):
            hint, limit = did_you_mean(board, table(data, "boards")), "the name of a further board"
            yield Finding("config.value", (*path, "sensor", "board"), board, limit, hint)
        for index, one in enumerate(array(sensor, "of") if kind == "combined" else ()):
            of = table(table(data, "sensors"), str(one), "sensor").get("kind")
            if one not in (*table(data, "heaters"), *table(data, "sensors")) or of == "combined":
                limit = "the name of a heater, or of a sensor that is not combined"
                hint = did_you_mean(one, (*table(data, "heaters"), *table(data, "sensors")))
                yield Finding("config.value", (*path, "sensor", "of", index), one, limit, hint)
        low, high = number(shown, "min_c"), number(shown, "max_c")
        if low is not None and high is not None and high <= low:
            yield Finding("config.value", (*path, "max_c"), high, "a temperature above min_c")
        letter = shown.get("letter")
        owner = letters.setdefault(letter, name) if isinstance(letter, str) else name
        if owner != name:
            limit = f"a letter of its own: it belongs to {owner}"
            yield Finding("config.conflict", (*path, "letter"), letter, limit)


def check_names(data: Raw) -> Iterator[Finding]:
    """Checks that no sensor has the name of a heater: commands, charts and faults find them by
    their names."""
    heaters = table(data, "heaters")
    for name in table(data, "sensors"):
        if name in heaters:
            limit = f"another name: heaters.{name} has this one"
            yield Finding("config.conflict", ("sensors", name), name, limit)
