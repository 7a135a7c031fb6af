"""The samples of an accelerometer, as boards send them."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

AccelerometerChip = Literal["adxl345", "lis2dw"]
Axes = Sequence[tuple[int, int]]
"""For X, Y and Z of the machine, the axis of the chip (0 to 2) and its sign."""
Acceleration = tuple[float, float, float]

SAMPLE_BYTES: dict[AccelerometerChip, int] = {"adxl345": 5, "lis2dw": 6}
_GRAVITY_MM_S2 = 9806.65
_ADXL_XY, _ADXL_Z = 0.003774 * _GRAVITY_MM_S2, 0.003906 * _GRAVITY_MM_S2  # at 3.3 V
_LIS = 0.001952 / 4 * _GRAVITY_MM_S2  # of 16 bits, of which the chip fills the upper 14
# mm/s² in a unit of each axis; data sheets of the chips.
_UNITS: dict[AccelerometerChip, Acceleration] = {
    "adxl345": (_ADXL_XY, _ADXL_XY, _ADXL_Z),
    "lis2dw": (_LIS, _LIS, _LIS),
}


@dataclass(frozen=True, slots=True)
class Measurement:
    """Samples as the board has sent them, decoded by `decoded`. The first one was taken at
    `start_s` of print time, and there are `rate_hz` in a second of print time."""

    chip: AccelerometerChip
    axes: Axes
    data: bytes
    start_s: float
    rate_hz: float

    @property
    def count(self) -> int:
        """The number of samples."""
        return len(self.data) // SAMPLE_BYTES[self.chip]

    def samples(self) -> list[Acceleration]:
        """All samples, mm/s²."""
        return decoded(self.chip, self.data, self.axes)

    def between(self, start_s: float, end_s: float) -> Measurement:
        """The samples within a span of print time."""
        first = max(0, round((start_s - self.start_s) * self.rate_hz))
        last = max(first, round((end_s - self.start_s) * self.rate_hz))
        size = SAMPLE_BYTES[self.chip]
        data = self.data[first * size : last * size]
        start_s = self.start_s + first / self.rate_hz
        return Measurement(self.chip, self.axes, data, start_s, self.rate_hz)


def decoded(chip: AccelerometerChip, data: bytes, axes: Axes) -> list[Acceleration]:
    """The samples in `data`, mm/s² along X, Y and Z of the machine; those that the board has marked
    as disturbed repeat the one before them."""
    (x, sx), (y, sy), (z, sz) = ((i, sign * _UNITS[chip][i]) for i, sign in axes)
    found: list[Acceleration] = []
    last = (0.0, 0.0, 0.0)
    if chip == "lis2dw":
        for raw in struct.iter_unpack("<hhh", data):
            found.append((raw[x] * sx, raw[y] * sy, raw[z] * sz))
        return found
    for low_x, low_y, low_z, xz, yz in struct.iter_unpack("5B", data):
        if not yz & 0x80:
            raw = (
                (low_x | (xz & 0x1F) << 8) - ((xz & 0x10) << 9),
                (low_y | (yz & 0x1F) << 8) - ((yz & 0x10) << 9),
                (low_z | (xz & 0xE0) << 3 | (yz & 0x60) << 6) - ((yz & 0x40) << 7),
            )
            last = raw[x] * sx, raw[y] * sy, raw[z] * sz
        found.append(last)
    return found
