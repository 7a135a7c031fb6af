"""Motor drivers with registers: their keys in a machine file, and the currents that they
support."""

from __future__ import annotations

from math import ceil, floor, sqrt
from typing import Annotated, Literal, NamedTuple, TypeAlias

from pydantic import Field

from passo.config.types import Model, NotNegative, Pin, Positive

ChipName: TypeAlias = Literal["TMC2208", "TMC2209", "TMC2130", "TMC5160"]


class ChipFacts(NamedTuple):
    """The bus of a chip, and the source of its current: full scale of the voltage over the sense
    resistor in its ranges, the minimum fraction of a range, the resistance inside the chip, and the
    resistor of most modules."""

    wire: Literal["uart", "spi"]
    full_scale_v: tuple[float, ...]
    least_share: float
    inner_ohm: float
    resistor_ohm: float


# The TMC5160's range is scaled by at least 32/256, and IRUN takes a 32nd of that.
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
    """The maximum current (A, effective value) in a range of the chip: the data sheets' I = V / (R
    + R inside) / √2."""
    return full_scale_v / (resistor_ohm + CHIPS[chip].inner_ohm) / sqrt(2)


def largest_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The maximum current (mA, effective value) that the chip can be set to, rounded down."""
    return floor(1000 * full_scale_a(chip, resistor_ohm, max(CHIPS[chip].full_scale_v)))


def least_current_ma(chip: ChipName, resistor_ohm: float) -> int:
    """The minimum current (mA, effective value) that the chip can be set to, rounded up."""
    facts = CHIPS[chip]
    return ceil(
        1000 * facts.least_share * full_scale_a(chip, resistor_ohm, min(facts.full_scale_v))
    )


class Tmc(Model):
    """A driver with registers, which Passo sets: docs/how-to/set-up-drivers.md."""

    run_current_a: Positive
    """The current while the motor moves, as effective value."""
    hold_current_a: Positive | None = None
    """The current at standstill, as effective value. If not given, `run_current_a`."""
    sense_resistor_ohm: Positive | None = None
    """The sense resistor of the module. If not given, 0.11 Ω, and 0.075 Ω for a TMC5160."""
    stealthchop_below_mm_s: NotNegative | None = None
    """The driver is silent (stealthChop) below this speed of the motor. If not given, never."""
    stealthchop_below_deg_s: NotNegative | None = None
    """The same for an arm."""
    interpolate: bool = True
    """Whether the driver makes 256 steps of each full step."""
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
        """The sense resistor, that of most modules unless given."""
        return self.sense_resistor_ohm or CHIPS[chip].resistor_ohm
