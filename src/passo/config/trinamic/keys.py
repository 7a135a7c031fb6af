"""The keys of motor drivers with registers in a machine file."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.trinamic.chips import CHIPS, ChipName
from passo.config.trinamic.motor import MotorConstants
from passo.config.types import Model, NotNegative, Pin, Positive

STALL_PINS = ("diag_pin", "diag0_pin", "diag1_pin")


_BUS = r"^([A-Za-z0-9_][A-Za-z0-9_-]*:)?[A-Za-z0-9_.]+$"


class Tmc(Model):
    """The settings of a driver with registers: docs/how-to/set-up-drivers.md."""

    run_current_a: Positive
    """The RMS current while the motor moves."""
    hold_current_a: Positive | None = None
    """The RMS current at standstill. If not given, `run_current_a`."""
    sense_resistor_ohm: Positive | None = None
    """The sense resistor of the module. If not given, 0.11 Ω, 0.075 Ω for a TMC5160, and 0.051 Ω
    for a TMC2660."""
    reference_resistor_ohm: Positive | None = None
    """The resistor at the pin IREF of a TMC2240. If not given, 12000 Ω."""
    stealthchop_below_mm_s: NotNegative | None = None
    """The driver is silent (stealthChop) below this speed of the motor. If not given, never."""
    stealthchop_below_deg_s: NotNegative | None = None
    """The same speed for an arm."""
    coolstep_above_mm_s: Positive | None = None
    """CoolStep adapts the current to the load above this speed of the motor; set `semin` and
    `semax` in `registers`. If not given, never."""
    coolstep_above_deg_s: Positive | None = None
    """The same speed for an arm."""
    high_speed_above_mm_s: Positive | None = None
    """Fields `vhighfs` and `vhighchm` in `registers` apply above this speed of the motor. If not
    given, never."""
    high_speed_above_deg_s: Positive | None = None
    """The same speed for an arm."""
    motor: MotorConstants | None = None
    """The data sheet of the motor, from which Passo computes registers of its driver."""
    registers: dict[str, int] = Field(default_factory=dict)
    """Fields of the driver's registers by their names in the data sheet, in lower case. They
    replace the values of Passo and those of `motor`."""
    interpolate: bool = True
    """Whether the driver interpolates to 256 microsteps per full step."""
    uart_pin: Pin | None = None
    """The pin of the UART of a driver. If not given, that of the socket."""
    tx_pin: Pin | None = None
    """The pin that sends, on boards with a pin for each direction. If not given, `uart_pin`."""
    address: Annotated[int, Field(ge=0, le=7)] = 0
    """The address of a TMC2209 or TMC2226, 0 to 3, set by its pins MS1 and MS2, or of a TMC2240, 0
    to 7. With the UART of the socket, that of the socket if not given."""
    cs_pin: Pin | None = None
    """The chip select of a driver on SPI. If not given, that of the socket."""
    clock_pin: Pin | None = None
    """The clock of the SPI bus."""
    mosi_pin: Pin | None = None
    """The data to the driver."""
    miso_pin: Pin | None = None
    """The data from the driver."""
    spi_bus: Annotated[str, Field(pattern=_BUS)] | None = None
    """The SPI bus of a board with Klipper's firmware, by its name there, instead of the three pins;
    with the name of the board before it, as of pins."""
    diag_pin: Pin | None = None
    """The input of the stall detection (DIAG) of a TMC2209 or TMC2226, for homing without
    switches."""
    diag0_pin: Pin | None = None
    """The same input at DIAG0 of a driver on SPI. It is low during a stall: `^!`."""
    diag1_pin: Pin | None = None
    """The same input at DIAG1."""

    @property
    def stall_key(self) -> str:
        """The key of the input of the stall detection; empty without one."""
        return next((key for key in STALL_PINS if getattr(self, key)), "")

    @property
    def stall_pin(self) -> Pin | None:
        """The input of the stall detection."""
        return getattr(self, self.stall_key) if self.stall_key else None

    def resistor_ohm(self, chip: ChipName) -> float:
        """The resistor that sets the current, ohm; the usual one of modules if not given."""
        given = self.sense_resistor_ohm or self.reference_resistor_ohm
        return given or CHIPS[chip].currents.resistor_ohm
