"""Simulated sensor chips on I2C buses, according to their data sheets."""

from __future__ import annotations

from passo.simulator.sensor_chips.bosch import BMP180, BoschChip
from passo.simulator.sensor_chips.chip import SensorChip
from passo.simulator.sensor_chips.simple import AhtChip, HtuChip, Lm75, ShtChip

__all__ = ["SensorChip", "sensor_chip"]


def sensor_chip(kind: str, clock_hz: float) -> SensorChip:
    """A chip of this kind, at 25 °C, 40 % and 1000 hPa, on a board with this clock."""
    if kind == "bmp180":
        return BMP180(clock_hz)
    if kind.startswith("bm"):
        return BoschChip(clock_hz, kind)
    if kind.startswith("aht"):
        return AhtChip(clock_hz, kind)
    if kind == "lm75":
        return Lm75(clock_hz)
    return ShtChip(clock_hz) if kind == "sht3x" else HtuChip(clock_hz, kind)
