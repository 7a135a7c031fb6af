"""Motor drivers with registers: their keys in a machine file, and the currents that they
support."""

from __future__ import annotations

from math import ceil, floor, sqrt
from typing import Annotated, Literal, NamedTuple, TypeAlias

from pydantic import Field

from passo.config.types import Model, NotNegative, Pin, Positive

ChipName: TypeAlias = Literal["TMC2208", "TMC2209", "TMC2130", "TMC5160"]


class ChipFacts(NamedTuple):
    """The bus of a chip, and the values that determine its current: the full-scale voltages over
    the sense resistor, the minimum fraction of a range, the internal resistance, and the usual
    sense resistor of modules."""

    wire: Literal["uart", "spi"]
    full_scale_v: tuple[float, ...]
    least_share: float
    inner_ohm: float
    resistor_ohm: float


# GLOBALSCALER of the TMC5160 is at least 32/256, and IRUN at least 1/32.
CHIPS: dict[ChipName, ChipFacts] = {
    "TMC2208": ChipFacts("uart", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC2209": ChipFacts("uart", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC2130": ChipFacts("spi", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC5160": ChipFacts("spi", (0.325,), 1 / 256, 0.0, 0.075),
}


def chip_of(driver: object) -> ChipName | None:
    """The facts about a motor's `driver`; None if it is not a supported chip with registers."""
    return next((chip for chip in CHIPS if chip == driver), None)


def full_scale_a(chip: ChipName, resistor_ohm: float, full_scale_v: float) -> float:
    """The maximum RMS current, A, in a range of the chip: I = V / (R + R inside) / √2 of the data
    sheets."""
    return full_scale_v / (resistor_ohm + CHIPS[chip].inner_ohm) / sqrt(2)


def largest_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The maximum RMS current of the chip, mA, rounded down."""
    return floor(1000 * full_scale_a(chip, resistor_ohm, max(CHIPS[chip].full_scale_v)))


def least_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The minimum RMS current of the chip, mA, rounded up."""
    facts = CHIPS[chip]
    return ceil(
        1000 * facts.least_share * full_scale_a(chip, resistor_ohm, min(facts.full_scale_v))
    )


class Tmc(Model):
    """The settings of a driver with registers: docs/how-to/set-up-drivers.md."""

    run_current_a: Positive
    """The RMS current while the motor moves."""
    hold_current_a: Positive | None = None
    """The RMS current at standstill. If not given, `run_current_a`."""
    sense_resistor_ohm: Positive | None = None
    """The sense resistor of the module. If not given, 0.11 Ω, and 0.075 Ω for a TMC5160."""
    stealthchop_below_mm_s: NotNegative | None = None
    """The driver is silent (stealthChop) below this speed of the motor. If not given, never."""
    stealthchop_below_deg_s: NotNegative | None = None
    """The same speed for an arm."""
    interpolate: bool = True
    """Whether the driver interpolates to 256 microsteps per full step."""
    uart_pin: Pin | None = None
    """The pin of the UART of a TMC2208 or TMC2209. If not given, that of the socket."""
    tx_pin: Pin | None = None
    """The pin that sends, on boards with a pin for each direction. If not given, `uart_pin`."""
    address: Annotated[int, Field(ge=0, le=3)] = 0
    """The address of a TMC2209, set by its pins MS1 and MS2. With the UART of the socket, that of
    the socket if not given."""
    cs_pin: Pin | None = None
    """The chip select of a TMC2130 or TMC5160. If not given, that of the socket."""
    clock_pin: Pin | None = None
    """The clock of the SPI bus."""
    mosi_pin: Pin | None = None
    """The data to the driver."""
    miso_pin: Pin | None = None
    """The data from the driver."""

    def resistor_ohm(self, chip: ChipName) -> float:
        """The sense resistor, ohm; the usual one of modules if not given."""
        return self.sense_resistor_ohm or CHIPS[chip].resistor_ohm
