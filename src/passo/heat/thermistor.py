"""Thermistors: from temperature to the share of the ADC's full scale that its divider gives."""

from __future__ import annotations

import itertools
from math import exp

ZERO_C = 273.15
TABLE_C = range(-20, 401, 5)


def resistance_ohm(celsius: float, r25_ohm: float, beta_k: float) -> float:
    """R(T) = R25 · exp(β (1/T - 1/298.15 K)), T in kelvin: the β equation of an NTC resistor."""
    return r25_ohm * exp(beta_k * (1 / (celsius + ZERO_C) - 1 / (25 + ZERO_C)))


def ratio_table(
    r25_ohm: float, beta_k: float, pullup_ohm: float
) -> tuple[tuple[float, float], ...]:
    """(°C, share of full scale) every 5 °C from -20 to 400, the thermistor to ground.

    Rounded to 1e-9, so that the table is the same on every computer.
    """
    rows: list[tuple[float, float]] = []
    for celsius in TABLE_C:
        ohm = resistance_ohm(celsius, r25_ohm, beta_k)
        rows.append((float(celsius), round(ohm / (ohm + pullup_ohm), 9)))
    return tuple(rows)


def ratio_at(table: tuple[tuple[float, float], ...], celsius: float) -> float:
    """The table's value at a temperature, straight between its rows, constant beyond its ends."""
    if celsius <= table[0][0]:
        return table[0][1]
    for (c0, r0), (c1, r1) in itertools.pairwise(table):
        if celsius <= c1:
            return r0 + (r1 - r0) * (celsius - c0) / (c1 - c0)
    return table[-1][1]
