"""The temperature sensors in microcontrollers, by the typical values of their data sheets."""

from __future__ import annotations

from typing import NamedTuple

from passo.config.sensor_tables import Table

PIN = "ADC_TEMPERATURE"  # the name of the sensor in the dictionaries of Klipper's firmware
_FULL_SCALE_V = 3.3
_RANGE_C = (-40.0, 150.0)


class _Line(NamedTuple):
    """A sensor that gives `volt` at `celsius`, and `volt_per_c` more for each °C."""

    volt: float
    celsius: float
    volt_per_c: float

    def share(self, celsius: float) -> float:
        """The fraction of the ADC's full scale at a temperature."""
        return (self.volt + (celsius - self.celsius) * self.volt_per_c) / _FULL_SCALE_V


# By the beginning of the chip's name.
_CHIPS = {
    "klipper": _Line(0.76, 25.0, 0.0025),  # any chip, while its board is simulated
    "rp2": _Line(0.706, 27.0, -0.001721),
    "sam3x": _Line(0.8, 27.0, 0.00265),
    "sam4e": _Line(1.44, 27.0, 0.0047),
    "stm32f0": _Line(1.43, 30.0, -0.0043),
    "stm32f1": _Line(1.43, 25.0, -0.0043),
    "stm32f2": _Line(0.76, 25.0, 0.0025),
    "stm32f4": _Line(0.76, 25.0, 0.0025),
    "stm32g": _Line(0.76, 30.0, 0.0025),
    "stm32h7": _Line(0.62, 30.0, 0.002),
    "stm32l4": _Line(0.76, 30.0, 0.0025),
}


def chip_sensor_table(mcu: str) -> Table | None:
    """The table of the sensor in a microcontroller: see `sensor_table`. None for one without a
    sensor, or with one that needs calibration."""
    line = next((line for name, line in _CHIPS.items() if mcu.startswith(name)), None)
    return None if line is None else tuple((c, round(line.share(c), 9)) for c in _RANGE_C)
