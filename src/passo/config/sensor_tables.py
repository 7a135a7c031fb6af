"""Computes the readings of sensors: tables for the ADC, and settings of converters."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeAlias

from passo import _core
from passo.config import platinum
from passo.config.sensors import (
    AnySensor,
    Converter,
    Platinum,
    PlatinumAmplifier,
    PlatinumConverter,
    SensorTable,
    Thermistor,
    ThermocoupleAmplifier,
    UniversalConverter,
)
from passo.config.thermistor import Divider, Ntc

Table: TypeAlias = tuple[tuple[float, float], ...]

_NTC_C = range(-20, 401, 5)
_PLATINUM_C = range(-50, 851, 5)
# Readings outside of this range mean that the cable is open or shorted.
_MIN_SHARE = 0.002
_MAX_SHARE = 0.998
_CONVERTER_C = {"max31855": (-270.0, 1800.0), "max6675": (0.0, 1023.75)}
# The range of each type of thermocouple of a MAX31856, and its number (Maxim 19-7534, Table 2).
_THERMOCOUPLE_C = {
    "B": (0, 250.0, 1820.0),
    "E": (1, -200.0, 1000.0),
    "J": (2, -210.0, 1200.0),
    "K": (3, -200.0, 1372.0),
    "N": (4, -200.0, 1300.0),
    "R": (5, -50.0, 1768.0),
    "S": (6, -50.0, 1768.0),
    "T": (7, -200.0, 400.0),
}
_VOLTS_BY_C = {"ad595": 0.010, "ad8495": 0.005}


def sensor_table(sensor: AnySensor) -> Table:
    """The table of a sensor: (°C, fraction of the ADC's full scale) by ascending °C; the fraction
    strictly rises or falls. Beyond the ends of the table the sensor is broken. Rounded to 1e-9, so
    that the table is the same on every computer. Empty if no temperature gives a valid reading with
    the resistors.
    """
    if isinstance(sensor, Thermistor):
        ntc = Ntc(sensor.r25_ohm, sensor.beta_k, sensor.c_per_k)
        divider = Divider(sensor.pullup_ohm, sensor.adc_offset_low, sensor.adc_offset_high)
        return _rows(_NTC_C, lambda t: divider.share(ntc.ohm(t)))
    if isinstance(sensor, Platinum):
        r0 = sensor.r0_ohm
        pullup = Divider(sensor.pullup_ohm)
        return _rows(_PLATINUM_C, lambda t: pullup.share(platinum.ohm(t, r0)))
    if isinstance(sensor, PlatinumAmplifier):
        r0 = sensor.r0_ohm
        bridge = Divider(sensor.pullup_ohm)
        factor = sensor.supply_v * sensor.gain / sensor.full_scale_v
        return _rows(_PLATINUM_C, lambda t: factor * bridge.share(platinum.ohm(t, r0)))
    if isinstance(sensor, ThermocoupleAmplifier):
        full_c = sensor.full_scale_v / _VOLTS_BY_C[sensor.kind] * sensor.scale
        ends = (_MIN_SHARE, _MAX_SHARE)
        return tuple((round(share * full_c + sensor.offset_c, 9), share) for share in ends)
    if isinstance(sensor, PlatinumConverter):
        r0, reference = sensor.r0_ohm, sensor.reference_ohm
        return _rows(_PLATINUM_C, lambda t: platinum.ohm(t, r0) / reference)
    if isinstance(sensor, Converter):
        one = converter_of(sensor)
        ends = (
            _THERMOCOUPLE_C[sensor.thermocouple][1:]
            if isinstance(sensor, UniversalConverter)
            else _CONVERTER_C[sensor.kind]
        )
        return tuple((t, _core.converter_share(one, t)) for t in ends)
    return tuple(sorted((t, share) for t, share in sensor.points))


def converter_of(sensor: AnySensor) -> _core.Converter:
    """The converter of a sensor; None if it is connected to the ADC."""
    if isinstance(sensor, Converter):
        return getattr(_core.Converter, sensor.kind.upper())
    return _core.Converter.NONE


@dataclass(frozen=True, slots=True)
class ConverterSetup:
    """The settings of a converter with registers: `words` are sent before the first reading, and
    `clears_faults` after a fault, because the converter keeps a fault until then."""

    words: tuple[bytes, ...] = ()
    clears_faults: bytes = b""


def converter_setup(sensor: AnySensor) -> ConverterSetup:
    """The setup of the converter of a sensor; empty for a sensor without one.

    The frequency of the power grid may be set only while the chip does not measure. MAX31856: Maxim
    19-7534, registers 0 and 1; MAX31865: Maxim 19-6478, register 0.
    """
    if isinstance(sensor, UniversalConverter):
        kind, *_ = _THERMOCOUPLE_C[sensor.thermocouple]
        hz = int(sensor.mains_hz == 50)
        find_open_wires = 0x10
        words = (
            bytes([0x81, kind]),
            bytes([0x80, find_open_wires | hz]),
            bytes([0x80, 0x80 | find_open_wires | hz]),
        )
        return ConverterSetup(words)
    if isinstance(sensor, PlatinumConverter):
        hz, three_wires = int(sensor.mains_hz == 50), 0x10 * (sensor.wires == 3)
        supplied_and_measuring, clear = 0xC0, 0x02
        last = bytes([0x80, supplied_and_measuring | three_wires | clear | hz])
        return ConverterSetup((bytes([0x80, hz]), last), last)
    return ConverterSetup()


def open_is_high(sensor: AnySensor) -> bool:
    """Whether the ADC reads high when the sensor's cable is open. This is so for a resistor between
    the input and ground with a pull-up resistor, and for the amplifiers, whose inputs drift to the
    supply."""
    return not isinstance(sensor, SensorTable) or sensor.open_reads == "high"


def _rows(celsius: Iterable[int], share: Callable[[float], float]) -> Table:
    """The rows whose readings are distinct from those of an open or a shorted cable."""
    rows = [(float(t), round(share(t), 9)) for t in celsius]
    return tuple(row for row in rows if _MIN_SHARE <= row[1] <= _MAX_SHARE)


def reads_within(table: Table, min_c: float, max_c: float) -> bool:
    """Whether a sensor with this table gives distinct readings over this range, °C."""
    apart = all(a[1] != b[1] for a, b in itertools.pairwise(table))
    return len(table) > 1 and table[0][0] < max_c and min_c < table[-1][0] and apart


def share_at(table: Table, celsius: float) -> float:
    """The fraction at a temperature, linear between the rows of the table, constant beyond its
    ends."""
    if celsius <= table[0][0]:
        return table[0][1]
    for (c0, r0), (c1, r1) in itertools.pairwise(table):
        if celsius <= c1:
            return r0 + (r1 - r0) * (celsius - c0) / (c1 - c0)
    return table[-1][1]


def step_c(table: Table, celsius: float, steps: int) -> float:
    """How much the temperature changes from one reading to the next, °C, of a converter or ADC with
    this number of steps at full scale."""
    near = min(max(celsius, table[0][0] + 0.5), table[-1][0] - 0.5)
    return 1 / (steps * abs(share_at(table, near + 0.5) - share_at(table, near - 0.5)))
