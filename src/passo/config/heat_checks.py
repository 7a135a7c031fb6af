"""Checks the heaters and fans of a machine file."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from passo.config.chip_sensors import chip_sensor_table
from passo.config.findings import Finding, array, did_you_mean, number, table, tables
from passo.config.i2c_sensors import I2cSensor
from passo.config.pin_names import MAIN, placed, section
from passo.config.sensor_tables import reads_within, sensor_table
from passo.config.shown_sensors import ChipSensor, CombinedSensor, HostSensor

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

Raw = Mapping[str, Any]

# The shortest cycle of pulses, so that its two interrupts do not delay steps: 250 Hz at 16 MHz.
_MIN_CYCLE_TICKS = 64_000


def check_heaters(data: Raw) -> Iterator[Finding]:
    """Checks that minima are below maxima, that fans exist, and that tables of sensors are
    monotonic."""
    for name, heater in tables(data, "heaters"):
        path = ("heaters", name)
        low, high = number(heater, "min_c"), number(heater, "max_c")
        if high is not None and high <= (5.0 if low is None else low):
            yield Finding("config.value", (*path, "max_c"), high, "a temperature above min_c")
        fan, fans = heater.get("fan"), table(data, "fans")
        if isinstance(fan, str) and fan not in fans:
            hint = did_you_mean(fan, fans)
            yield Finding("config.value", (*path, "fan"), fan, "the name of one of the fans", hint)
        control = table(heater, "control")
        least, most = number(control, "drive_min"), number(control, "drive_max")
        if least is not None and least >= (1.0 if most is None else most):
            limit = "a share of power below drive_max"
            yield Finding("config.value", (*path, "control", "drive_min"), least, limit)
        arrival = table(heater, "arrival")
        window, leaves = number(arrival, "window_c"), number(arrival, "leaves_c")
        if (3.0 if leaves is None else leaves) < (1.0 if window is None else window):
            value = window if leaves is None else leaves
            key = "window_c" if leaves is None else "leaves_c"
            limit = "at most leaves_c, 3" if leaves is None else "at least window_c"
            yield Finding("config.value", (*path, "arrival", key), value, limit)
        yield from _check_points((*path, "sensor"), table(heater, "sensor"))


def check_fans(data: Raw) -> Iterator[Finding]:
    """Checks that fans for commands have different numbers, and that other fans follow existing
    heaters and motors."""
    owners: dict[float, str] = {}
    heaters, steppers = table(data, "heaters"), table(data, "steppers")
    for name, fan in tables(data, "fans"):
        path = ("fans", name)
        least, most = number(fan, "min_power"), number(fan, "max_power")
        if least is not None and most is not None and least > most:
            yield Finding("config.value", (*path, "min_power"), least, "at most max_power")
        heater = fan.get("follows")
        if isinstance(heater, str) and heater not in heaters:
            hint, limit = did_you_mean(heater, heaters), "the name of one of the heaters"
            yield Finding("config.value", (*path, "follows"), heater, limit, hint)
        for one in array(fan, "follows_heaters"):
            if isinstance(one, str) and one not in heaters:
                hint, limit = did_you_mean(one, heaters), "names of heaters"
                yield Finding("config.value", (*path, "follows_heaters"), one, limit, hint)
        motors = array(fan, "follows_motors")
        for motor in motors:
            if isinstance(motor, str) and motor not in steppers:
                hint, limit = did_you_mean(motor, steppers), "names of motors"
                yield Finding("config.value", (*path, "follows_motors"), motor, limit, hint)
        followed = array(fan, "follows_targets")
        for one in followed:
            if isinstance(one, str) and one not in heaters:
                hint, limit = did_you_mean(one, heaters), "names of heaters"
                yield Finding("config.value", (*path, "follows_targets"), one, limit, hint)
        thermostat, sensors = table(fan, "thermostat"), table(data, "sensors")
        sensor = thermostat.get("sensor")
        if isinstance(sensor, str) and sensor not in sensors:
            hint, limit = did_you_mean(sensor, sensors), "the name of one of the sensors"
            yield Finding("config.value", (*path, "thermostat", "sensor"), sensor, limit, hint)
        if 0 < sum(gain in thermostat for gain in ("kp", "ki", "kd")) < 3:
            limit = "kp, ki and kd, or none of them"
            yield Finding("config.conflict", (*path, "thermostat"), "one gain", limit)
        if motors or followed or thermostat or isinstance(heater, str):
            kick_s = number(fan, "kick_start_s")
            if kick_s:
                limit = "0 where a fan follows something: it starts with max_power anyway"
                yield Finding("config.conflict", (*path, "kick_start_s"), kick_s, limit)
            continue
        own = number(fan, "number") or 0
        owner = owners.setdefault(own, name)
        if owner != name:
            limit = f"a number of its own: it belongs to fans.{owner}"
            yield Finding("config.conflict", (*path, "number"), own, limit)


def check_pulses(data: Raw) -> Iterator[Finding]:
    """Checks that the boards can pulse their outputs at the configured frequency in software."""
    for part in ("heaters", "fans", "outputs"):
        for name, content in tables(data, part):
            if content.get("pwm") == "hardware":
                continue
            pin, wanted = content.get("pin"), number(content, "pwm_hz")
            if not isinstance(pin, str) or wanted is None:
                continue
            clock_hz = number(table(data, *section(placed(pin)[0])), "clock_hz")
            if clock_hz is not None and wanted * _MIN_CYCLE_TICKS > clock_hz:
                most = clock_hz / _MIN_CYCLE_TICKS
                limit = f"at most {most:g} Hz at this board's clock"
                path = (part, name, "pwm_hz")
                yield Finding("config.value", path, wanted, limit, nearest=most)


def check_sensors(machine: MachineConfig) -> Iterator[Finding]:
    """Checks that each heater's sensor, with its resistors, gives readings over the range of the
    heater."""
    for name, heater in machine.heaters.items():
        rows = sensor_table(heater.sensor)
        if not reads_within(rows, heater.min_c, heater.max_c):
            limit = f"values with distinct readings from {heater.min_c:g} to {heater.max_c:g} °C"
            yield Finding("config.value", ("heaters", name, "sensor"), heater.sensor.kind, limit)
        elif heater.max_c > rows[-1][0]:
            most = rows[-1][0]
            limit = f"at most {most:g} °C, where what the sensor can measure ends"
            path = ("heaters", name, "max_c")
            yield Finding("config.value", path, heater.max_c, limit, nearest=most)
    for name, shown in machine.sensors.items():
        if isinstance(shown.sensor, HostSensor | CombinedSensor | I2cSensor):
            continue
        if isinstance(shown.sensor, ChipSensor):
            mcu = machine.all_boards[shown.sensor.board or MAIN].mcu
            if chip_sensor_table(mcu) is None:
                limit = f"another sensor: Passo knows no sensor in a {mcu}"
                yield Finding("config.value", ("sensors", name, "sensor"), "chip", limit)
            continue
        if not reads_within(sensor_table(shown.sensor), shown.min_c, shown.max_c):
            limit = f"values with distinct readings from {shown.min_c:g} to {shown.max_c:g} °C"
            yield Finding("config.value", ("sensors", name, "sensor"), shown.sensor.kind, limit)


def _check_points(path: tuple[str, ...], sensor: Raw) -> Iterator[Finding]:
    key = "file" if "file" in sensor else "points"
    points = sorted(point for raw in array(sensor, "points") for point in _pairs(raw))
    shares = [share for _, share in points]
    steps = [b - a for a, b in itertools.pairwise(shares)]
    if any(not 0 <= share <= 1 for share in shares):
        yield Finding("config.value", (*path, key), sensor[key], "shares from 0 to 1")
    elif not (all(step < 0 for step in steps) or all(step > 0 for step in steps)):
        limit = "shares that only rise or only fall with the temperature"
        yield Finding("config.value", (*path, key), sensor[key], limit)


def _pairs(raw: object) -> Iterator[tuple[float, float]]:
    """The valid points of a table; the models report the others."""
    match raw:
        case [int() | float() as celsius, int() | float() as share]:
            yield float(celsius), float(share)
        case _:
            pass
