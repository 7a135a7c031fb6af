"""Motor drivers with registers: what a machine file says of them, and what currents they can do."""

from __future__ import annotations

from math import ceil, floor, sqrt
from typing import Annotated, Literal, NamedTuple, TypeAlias

from pydantic import Field

from passo.config.types import Model, NotNegative, Pin, Positive

ChipName: TypeAlias = Literal["TMC2208", "TMC2209", "TMC2130", "TMC5160"]


class ChipFacts(NamedTuple):
    """How a chip is spoken to, and how its current comes about: full scale of the voltage over the
    sense resistor in its ranges, the least share of a range that it can be set to, the resistance
    inside the chip, and the resistor of most modules."""

    wire: Literal["uart", "spi"]
    full_scale_v: tuple[float, ...]
    least_share: float
    inner_ohm: float
    resistor_ohm: float


# The TMC5160's range is scaled by 32/256 at least, and IRUN takes a 32nd of that.
CHIPS: dict[ChipName, ChipFacts] = {
    "TMC2208": ChipFacts("uart", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC2209": ChipFacts("uart", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC2130": ChipFacts("spi", (0.18, 0.32), 1 / 32, 0.02, 0.11),
    "TMC5160": ChipFacts("spi", (0.325,), 1 / 256, 0.0, 0.075),
}


def chip_of(driver: object) -> ChipName | None:
    """The chip, if a motor's `driver` is one with registers that Passo knows."""
    return next((chip for chip in CHIPS if chip == driver), None)


def full_scale_a(chip: ChipName, resistor_ohm: float, full_scale_v: float) -> float:
    """The most current (A, effective value) that a range of the chip can do: the data sheets'
    I = V / (R + R inside) / √2."""
    return full_scale_v / (resistor_ohm + CHIPS[chip].inner_ohm) / sqrt(2)


def largest_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The most current (mA, effective value) that the chip can be set to, rounded down."""
    return floor(1000 * full_scale_a(chip, resistor_ohm, max(CHIPS[chip].full_scale_v)))


def least_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The least current (mA, effective value) that the chip can be set to, rounded up."""
    facts = CHIPS[chip]
    return ceil(
        1000 * facts.least_share * full_scale_a(chip, resistor_ohm, min(facts.full_scale_v))
    )


class Tmc(Model):
    """How a driver with registers is reached and set up; which one it is, the motor's `driver`
    says.

    A TMC2208 or TMC2209 hangs on `uart_pin` (with `tx_pin` where the board sends on another one;
    `^` asks for the pull-up); up to four TMC2209 share it by their `address`. A TMC2130 or TMC5160
    is selected by `cs_pin` (the socket's, unless given) on an SPI bus of any three pins, which it
    may share.

    Currents are effective values, as motors are rated; standing still a motor gets
    `hold_current_a`, unless given the run current. Below `stealthchop_below_mm_s` (or
    `stealthchop_below_deg_s`, on arms) the driver is silent (stealthChop), above it strong
    (spreadCycle), without it always strong. With `interpolate` the chip makes 256 steps of each
    full step, whatever the microsteps.
    """

    run_current_a: Positive
    hold_current_a: Positive | None = None
    sense_resistor_ohm: Positive | None = None
    stealthchop_below_mm_s: NotNegative | None = None
    stealthchop_below_deg_s: NotNegative | None = None
    interpolate: bool = True
    uart_pin: Pin | None = None
    tx_pin: Pin | None = None
    address: Annotated[int, Field(ge=0, le=3)] = 0
    cs_pin: Pin | None = None
    clock_pin: Pin | None = None
    mosi_pin: Pin | None = None
    miso_pin: Pin | None = None

    def resistor_ohm(self, chip: ChipName) -> float:
        """The sense resistor, that of most modules unless given."""
        return self.sense_resistor_ohm or CHIPS[chip].resistor_ohm
