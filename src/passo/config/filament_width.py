"""How a filament sensor measures the width of the filament, and what follows from it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.types import Model, Pin

FULL_SCALE = 10_000  # the reading of an analog input at its full scale

_Diameter = Annotated[float, Field(gt=0, le=20)]
_Length = Annotated[float, Field(gt=0, le=5000)]


class FilamentWidth(Model):
    """The measurement of a filament sensor of the kind "width". An analog input reads 10000 at full
    scale; with two of them, the reading is their sum. The flow of the extruder is multiplied by
    (`nominal_mm` / diameter)² when the measured filament arrives in the nozzle."""

    second_pin: Pin | None = None
    """The second analog input of a sensor with two."""
    readings: Annotated[list[float], Field(min_length=2, max_length=2)] = [9500.0, 10500.0]
    """Two readings for which the diameter is known."""
    diameters_mm: Annotated[list[float], Field(min_length=2, max_length=2)] = [1.5, 2.0]
    """The diameters at these readings. In between and beyond, the diameter is linear."""
    nominal_mm: _Diameter = 1.75
    """The diameter for which the program was made. M404 sets it, too."""
    distance_mm: _Length
    """The length of filament from the sensor to the nozzle. M405 D sets it, too."""
    interval_mm: _Length = 10.0
    """The mean diameter of each such length of filament is used."""
    max_difference_mm: _Diameter = 0.2
    """The flow does not follow a diameter that differs more from the nominal one."""
    min_mm: Annotated[float, Field(ge=0, le=20)] = 1.0
    """Below this diameter, the filament has ended."""
    max_mm: _Diameter | None = None
    """Above this diameter, too; if not given, more than `max_difference_mm` above the nominal one.
    """
    measures: bool = True
    """Whether the sensor measures after the start. M405 and M406 change it."""
    corrects_flow: bool = True
    """Whether the flow follows the diameter."""
    corrects_at_once: bool = False
    """Until the first measured filament arrives in the nozzle, the flow follows the diameter in the
    sensor, in place of the nominal one."""
    logs: bool = False
    """Whether consoles receive each measured diameter."""

    def diameter_mm(self, reading: float) -> float:
        """The diameter at a reading, at least 0."""
        (a, b), (low, high) = self.readings, self.diameters_mm
        return max(low + (high - low) * (reading - a) / (b - a), 0.0)

    def reading(self, diameter_mm: float) -> float:
        """The reading at a diameter."""
        (a, b), (low, high) = self.readings, self.diameters_mm
        return a + (b - a) * (diameter_mm - low) / (high - low)
