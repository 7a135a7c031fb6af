"""The accelerometer that measures resonances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal, get_args

from pydantic import Field

from passo.config.buses import BUS, I2C_WIRES, SPI_WIRES, check_bus
from passo.config.chips import chip, chip_names
from passo.config.findings import Finding, array, table
from passo.config.klippers_firmware import runs_klippers
from passo.config.pin_names import placed, section
from passo.config.types import Model, Pin, Point, Positive

Direction = Literal["x", "y", "z", "-x", "-y", "-z"]
_Rate = Literal[800, 1600, 3200]
RATES_HZ: tuple[int, ...] = get_args(_Rate)
FASTEST_HZ = {"adxl345": 3200, "lis2dw": 1600}  # samples a second, by chip
_HEIGHT_MM = 20.0  # of the nozzle above the bed, unless the file gives a point
_SPI_KEYS = ("cs_pin", *SPI_WIRES, "spi_bus")
_I2C_KEYS = ("i2c_address", "i2c_hz")


class Accelerometer(Model):
    """An accelerometer on the head or on the bed, for TEST_RESONANCES and SHAPER_CALIBRATE. It is
    on an SPI bus: of three pins, or of `spi_bus` on a board with Klipper's firmware. A LIS2DW may
    be on I2C: of two pins, or of `i2c_bus`."""

    chip: Literal["adxl345", "lis2dw"] = "adxl345"
    """The chip. An ADXL345 measures up to 3200 times a second, a LIS2DW 1600 times."""
    rate_hz: _Rate | None = None
    """Samples a second. If not given, as many as the chip can; a serial line of 250 000 baud
    carries 1600."""
    cs_pin: Pin | None = None
    """The chip select. Its board is the board of the chip. Only a bus with one device, as that of a
    Raspberry Pi, needs none."""
    clock_pin: Pin | None = None
    """The clock of the SPI bus."""
    mosi_pin: Pin | None = None
    """The data to the chip (SDA of the chip)."""
    miso_pin: Pin | None = None
    """The data from the chip (SDO of the chip)."""
    spi_bus: Annotated[str, Field(pattern=BUS)] | None = None
    """The bus in the words of Klipper's firmware, such as `spi1` or `rpi:spidev0.0`, in place of
    the three pins."""
    scl_pin: Pin | None = None
    """The clock of the I2C bus. Its board is the board of the chip."""
    sda_pin: Pin | None = None
    """The data of the I2C bus."""
    i2c_bus: Annotated[str, Field(pattern=BUS)] | None = None
    """The bus in the words of Klipper's firmware, such as `i2c1` or `rpi:i2c.1`, in place of the
    two pins."""
    i2c_address: Literal[0x18, 0x19] = 0x19
    """The address on I2C: 0x18 (24) if the pin SA0 of the chip is low, 0x19 (25) if it is high or
    open."""
    i2c_hz: Annotated[int, Field(ge=100_000, le=400_000)] = 400_000
    """The clock of the I2C bus, in Hz. A lower one allows longer wires. 1600 samples a second need
    200 000 Hz, 800 need 100 000 Hz."""
    axes_map: Annotated[list[Direction], Field(min_length=3, max_length=3)] = ["x", "y", "z"]
    """The direction of the chip along X, Y and Z of the machine, as in Klipper."""
    point_mm: Point | None = None
    """X, Y and Z of the nozzle during a measurement. If not given, 20 mm above the middle of the
    bed."""
    accel_per_hz: Annotated[float, Field(gt=0, le=500)] = 60.0
    """The acceleration of the vibration for each Hz of its frequency, in mm/s."""
    max_smoothing_mm: Positive | None = None
    """A shaper may cut at most this much off a corner at 5000 mm/s². If not given, there is no
    limit."""

    @property
    def written_board(self) -> str:
        """The name of the board of the chip."""
        return placed(self.cs_pin or self.spi_bus or self.scl_pin or self.i2c_bus or "")[0]

    @property
    def on_i2c(self) -> bool:
        """Whether the chip is on I2C."""
        return self.scl_pin is not None or self.i2c_bus is not None

    def point_of(
        self, bed_mm: tuple[float, float, float, float], top_mm: float
    ) -> tuple[float, float, float]:
        """X, Y and Z of the nozzle during a measurement above this bed, mm; Z reaches up to
        `top_mm`."""
        if self.point_mm is not None:
            x, y, z = self.point_mm
            return x, y, z
        x0, y0, x1, y1 = bed_mm
        return (x0 + x1) / 2, (y0 + y1) / 2, min(_HEIGHT_MM, top_mm)


def check_accelerometer(data: Mapping[str, Any]) -> Iterator[Finding]:
    """Checks that the accelerometer has a bus, all of it on one board, and that each axis has one
    direction of the chip."""
    part, path = table(data, "accelerometer"), ("accelerometer",)
    if "accelerometer" not in data:
        return
    rate = part.get("rate_hz")
    if part.get("chip") == "lis2dw" and rate in RATES_HZ and rate > FASTEST_HZ["lis2dw"]:
        yield Finding("config.conflict", (*path, "rate_hz"), rate, "800 or 1600, as of a LIS2DW")
    i2c = any(key in part for key in (*I2C_WIRES, "i2c_bus"))
    yield from check_bus(data, path, part, "i2c_bus" if i2c else "spi_bus")
    yield from _check_speed(data, part, "scl_pin" if i2c else "cs_pin")
    for key in _SPI_KEYS if i2c else _I2C_KEYS:
        if key in part:
            limit = f"no such key: the accelerometer is on {'I2C' if i2c else 'SPI'}"
            yield Finding("config.conflict", (*path, key), part[key], limit)
    if i2c and part.get("chip", "adxl345") != "lis2dw":
        limit = "lis2dw, because it is on I2C"
        yield Finding("config.conflict", (*path, "chip"), part.get("chip", "adxl345"), limit)
    directions = array(part, "axes_map")
    if len({str(d).removeprefix("-") for d in directions}) < len(directions):
        shown = ", ".join(map(str, directions))
        yield Finding("config.value", (*path, "axes_map"), shown, "x, y and z once each")


def _check_speed(data: Mapping[str, Any], part: Mapping[str, Any], first: str) -> Iterator[Finding]:
    """Checks that the chip of the board on which the pin `first` is can read the accelerometer."""
    owner = table(data, *section(placed(str(part.get(first)))[0]))
    simulated = owner.get("link", "simulated") == "simulated"
    mcu = owner.get("mcu")
    real = first in part and not (simulated or runs_klippers(owner))
    if real and mcu in chip_names() and chip(str(mcu)).core == "avr":
        limit = f"a pin of another board: an {chip(str(mcu)).name} is too slow for this chip"
        yield Finding("config.conflict", ("accelerometer", first), part[first], limit)
