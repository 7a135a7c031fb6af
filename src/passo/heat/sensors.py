"""Sensors: from a machine file's description to what the ADC sees, or a converter says."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import TypeAlias

from passo import _core
from passo.config.sensors import (
    AnySensor,
    Platinum,
    PlatinumAmplifier,
    SensorTable,
    Thermistor,
    ThermocoupleAmplifier,
    ThermocoupleConverter,
)
from passo.heat import platinum
from passo.heat.thermistor import Divider, Ntc

Table: TypeAlias = tuple[tuple[float, float], ...]

_NTC_C = range(-20, 401, 5)
_PLATINUM_C = range(-50, 851, 5)
# What the ADC says of a cable that is open or shorted lies outside these.
_LEAST_SHARE = 0.002
_MOST_SHARE = 0.998
_CONVERTER_C = {"max31855": (-270.0, 1800.0), "max6675": (0.0, 1023.75)}
_VOLTS_BY_C = {"ad595": 0.010, "ad8495": 0.005}


def sensor_table(sensor: AnySensor) -> Table:
    """(°C, share of the ADC's full scale) by ascending °C, the share strictly rising or falling.

    Beyond its ends the sensor is broken. Rounded to 1e-9, so that the table is the same on every
    computer.
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
        ends = (_LEAST_SHARE, _MOST_SHARE)
        return tuple((round(share * full_c + sensor.offset_c, 9), share) for share in ends)
    if isinstance(sensor, ThermocoupleConverter):
        # Quarters of a degree around the middle of its full scale.
        full = _core.CONVERTER_FULL
        return tuple((t, (4 * t + full // 2) / full) for t in _CONVERTER_C[sensor.kind])
    return tuple(sorted((t, share) for t, share in sensor.points))


def converter_of(sensor: AnySensor) -> _core.Converter:
    """The converter that the sensor is behind, if any."""
    if isinstance(sensor, ThermocoupleConverter):
        return getattr(_core.Converter, sensor.kind.upper())
    return _core.Converter.NONE


def open_is_high(sensor: AnySensor) -> bool:
    """Whether the ADC reads high when the sensor's cable is open: so do a resistor to ground under
    its pull-up resistor, and the amplifiers, whose inputs drift to the supply."""
    return not isinstance(sensor, SensorTable) or sensor.open_reads == "high"


def _rows(celsius: Iterable[int], share: Callable[[float], float]) -> Table:
    """The rows that an ADC can tell from an open or a shorted cable."""
    rows = [(float(t), round(share(t), 9)) for t in celsius]
    return tuple(row for row in rows if _LEAST_SHARE <= row[1] <= _MOST_SHARE)


def share_at(table: Table, celsius: float) -> float:
    """The table's value at a temperature, straight between its rows, constant beyond its ends."""
    if celsius <= table[0][0]:
        return table[0][1]
    for (c0, r0), (c1, r1) in itertools.pairwise(table):
        if celsius <= c1:
            return r0 + (r1 - r0) * (celsius - c0) / (c1 - c0)
    return table[-1][1]
