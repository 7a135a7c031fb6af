"""Stepper drivers, and the minimum times of their inputs."""

from __future__ import annotations

from typing import Literal, NamedTuple


class DriverTimes(NamedTuple):
    """The minimum step pulse, the minimum times between a step and a direction change before or
    after it, and the maximum step rate."""

    pulse_us: float
    direction_us: float
    max_rate_hz: float


DriverName = Literal[
    "A4988",
    "A5984",
    "DRV8825",
    "LV8729",
    "TB6600",
    "TB6560",
    "TMC2100",
    "TMC2130",
    "TMC2208",
    "TMC2209",
    "TMC2225",
    "TMC2226",
    "TMC2240",
    "TMC2660",
    "TMC5160",
]

# The TMC data sheets require 100 ns high and low; firmware for slow boards needs no wait for that.
_TMC = DriverTimes(pulse_us=0.1, direction_us=0.05, max_rate_hz=400_000)

DRIVERS: dict[DriverName, DriverTimes] = {
    "A4988": DriverTimes(1, 0.2, 500_000),
    "A5984": DriverTimes(1, 0.4, 500_000),
    "DRV8825": DriverTimes(2, 0.65, 250_000),
    "LV8729": DriverTimes(1, 0.5, 130_000),
    "TB6600": DriverTimes(3, 1.5, 150_000),
    "TB6560": DriverTimes(30, 15, 15_000),
    "TMC2100": _TMC,
    "TMC2130": _TMC,
    "TMC2208": _TMC,
    "TMC2209": _TMC,
    "TMC2225": _TMC,
    "TMC2226": _TMC,
    "TMC2240": _TMC,
    "TMC2660": _TMC,
    "TMC5160": _TMC,
}
