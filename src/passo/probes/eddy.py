"""An eddy current probe: an LDC1612 measures the frequency of a coil, which rises near the bed."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise, takewhile
from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, PartName, Pin, Positive
from passo.probes.base import SensingProbe

LEAST_POINTS = 3  # of a calibration
_BUS = r"^([A-Za-z0-9_][A-Za-z0-9_-]*:)?[A-Za-z0-9_.]+$"


class EddyPoint(Model):
    """A height of the nozzle above the bed, and the frequency there."""

    mm: Annotated[float, Field(ge=-2, le=20)]
    """The height, in mm."""
    hz: Annotated[float, Field(gt=0, le=40e6)]
    """The frequency of the coil, in Hz."""


class EddyProbe(SensingProbe):
    """An eddy current probe with an LDC1612, on a board with Klipper's firmware, over I2C: of two
    pins, or of `i2c_bus`. A descent stops at `trigger_height_mm`; the probe then measures the
    height at standstill. It can also measure while it moves over the bed (METHOD=scan or
    rapid_scan of BED_MESH_CALIBRATE)."""

    kind: Literal["eddy"]
    """An eddy current probe."""
    name: PartName = "eddy"
    """The name that CHIP= of commands gives it."""
    scl_pin: Pin | None = None
    """The clock of the I2C bus. Its board is the board of the probe."""
    sda_pin: Pin | None = None
    """The data of the I2C bus."""
    i2c_bus: Annotated[str, Field(pattern=_BUS)] | None = None
    """The bus in the words of Klipper's firmware, such as `eddy:i2c0f`, in place of the two
    pins."""
    i2c_address: Literal[0x2A, 0x2B] = 0x2A
    """The address on I2C: 0x2A (42) if the pin ADDR of the chip is low, 0x2B (43) if it is high."""
    i2c_hz: Annotated[int, Field(ge=100_000, le=400_000)] = 400_000
    """The clock of the I2C bus, in Hz."""
    intb_pin: Pin | None = None
    """The pin INTB of the chip, if it is connected: the board then reads the chip only when it has
    a new value."""
    drive_current: Annotated[int, Field(ge=0, le=31)] = 15
    """The current of the coil, in the unit of the chip. LDC_CALIBRATE_DRIVE_CURRENT finds it."""
    chip_hz: Annotated[int, Field(ge=2_000_000, le=40_000_000)] = 12_000_000
    """The clock of the chip, in Hz."""
    max_coil_hz: Annotated[float, Field(ge=3e6, le=20e6)] = 5e6
    """A frequency that the coil does not exceed, in Hz."""
    calibration: Annotated[list[EddyPoint], Field(max_length=400)] = []
    """The frequencies at heights of the nozzle. PROBE_EDDY_CURRENT_CALIBRATE measures them."""
    scan_mm: Positive = 2.0
    """The height of the nozzle while the probe measures without descents."""
    start_mm: Annotated[float, Field(gt=0, le=100)] = 10.0
    """Z of the nozzle at the start of each descent, and between the points."""

    @property
    def wired_at(self) -> str:
        """The clock pin, or the bus."""
        return self.scl_pin or self.i2c_bus or ""

    @property
    def divider(self) -> int:
        """The divider of the frequency: the chip measures up to a quarter of its own clock."""
        return max(1, int(-(-4 * self.max_coil_hz // self.chip_hz)))


class EddyCurve:
    """The relation of height and frequency, straight between the points of a calibration, of which
    there are at least `LEAST_POINTS`. The frequency falls with the height."""

    def __init__(self, points: Sequence[EddyPoint]) -> None:
        rows = sorted((p.hz, p.mm) for p in points)
        self._hz = [hz for hz, _ in rows]
        self._mm = [mm for _, mm in rows]

    @property
    def range_mm(self) -> tuple[float, float]:
        """The lowest and the highest height."""
        return self._mm[-1], self._mm[0]

    def height_mm(self, hz: float) -> float | None:
        """The height at a frequency; None if it is outside of the calibration."""
        if not self._hz[0] <= hz <= self._hz[-1]:
            return None
        return _between(self._hz, self._mm, hz)

    def frequency_hz(self, mm: float) -> float:
        """The frequency at a height within the calibration."""
        return _between(self._mm[::-1], self._hz[::-1], mm)


def falling(points: Sequence[EddyPoint]) -> list[EddyPoint]:
    """The points by their height, from the lowest on, as far as the frequency falls."""
    rows = sorted(points, key=lambda p: p.mm)
    fit = takewhile(lambda ab: ab[0].mm < ab[1].mm and ab[0].hz > ab[1].hz, pairwise(rows))
    return [*rows[:1], *(b for _, b in fit)]


def falls(points: Sequence[EddyPoint]) -> bool:
    """Whether each higher point has a lower frequency."""
    return len(falling(points)) == len(points)


def _between(xs: Sequence[float], ys: Sequence[float], x: float) -> float:
    i = min(max(bisect_left(xs, x), 1), len(xs) - 1)
    share = (x - xs[i - 1]) / (xs[i] - xs[i - 1])
    return ys[i - 1] + share * (ys[i] - ys[i - 1])
