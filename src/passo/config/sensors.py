"""Temperature sensors on an analog input or an SPI bus, as a machine file describes them."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from passo.config.types import Model, Pair, Pin, Positive

_Offset = Annotated[float, Field(ge=-64, le=64)]
_Ohm = Annotated[float, Field(ge=1, le=1e9)]


class Thermistor(Model):
    """An NTC resistor to ground under a pull-up resistor: 1/T = A + B·ln R + C·(ln R)³ where B =
    1/β, and A follows from `r25_ohm` at 25 °C."""

    kind: Literal["thermistor"] = "thermistor"
    """An NTC resistor under a pull-up resistor."""
    r25_ohm: _Ohm = 100_000.0
    """The resistance at 25 °C."""
    beta_k: Annotated[float, Field(ge=100, le=20_000)] = 3950.0
    """β."""
    c_per_k: Annotated[float, Field(ge=0, le=1e-5)] = 0.0
    """C of the equation 1/T = A + B·ln R + C·(ln R)³, in 1/K."""
    pullup_ohm: _Ohm = 4700.0
    """The pull-up resistor. If not given, that of the board, or 4700 Ω."""
    adc_offset_low: _Offset = 0.0
    """The error of the ADC at 0, in pairs of steps of 1/1024 (L of M305)."""
    adc_offset_high: _Offset = 0.0
    """The error of the ADC at full scale, in pairs of steps of 1/1024 (O of M305)."""


class Platinum(Model):
    """A PT100 or PT1000 (IEC 60751) to ground under a pull-up resistor."""

    kind: Literal["pt100", "pt1000"]
    """A PT100 or PT1000 under a pull-up resistor."""
    pullup_ohm: Positive = 4700.0
    """The pull-up resistor. If not given, that of the board, or 4700 Ω."""

    @property
    def r0_ohm(self) -> float:
        """The resistance at 0 °C."""
        return _at_0_c(self.kind)


class PlatinumAmplifier(Model):
    """A PT100 or PT1000 to ground under `pullup_ohm`, with an amplifier whose output is `supply_v`
    · `gain` · R / (R + `pullup_ohm`)."""

    kind: Literal["pt100-amplifier", "pt1000-amplifier"]
    """A PT100 or PT1000 with an amplifier."""
    gain: Positive = 10.0
    """The gain of the amplifier."""
    pullup_ohm: Positive = 4400.0
    """The pull-up resistor of the amplifier."""
    supply_v: Positive = 5.0
    """The supply of the amplifier."""
    full_scale_v: Positive = 5.0
    """The voltage of the full scale of the ADC."""

    @property
    def r0_ohm(self) -> float:
        """The resistance at 0 °C."""
        return _at_0_c(self.kind)


def _at_0_c(kind: str) -> float:
    return 1000.0 if kind.startswith("pt1000") else 100.0


class ThermocoupleAmplifier(Model):
    """A thermocouple with an AD595 or an AD8495."""

    kind: Literal["ad595", "ad8495"]
    """A thermocouple with an amplifier: 10 mV/°C (AD595) or 5 mV/°C (AD8495)."""
    full_scale_v: Positive = 5.0
    """The voltage of the full scale of the ADC."""
    scale: Positive = 1.0
    """The reading is multiplied by this."""
    offset_c: Annotated[float, Field(ge=-100, le=100)] = 0.0
    """This is added to the reading."""


class SensorTable(Model):
    """A sensor by points, with straight lines between them."""

    kind: Literal["table"]
    """A table of points."""
    file: str | None = None
    """A file of lines `°C, fraction` in place of `points`, relative to the machine file."""
    points: Annotated[list[Pair], Field(min_length=2, max_length=1000)]
    """Points `[°C, fraction of the full scale of the ADC]`, with straight lines between them."""
    open_reads: Literal["high", "low"] = "high"
    """The end of the scale at which the ADC is when the cable is broken."""


class Converter(Model):
    """A converter chip on an SPI bus, which other devices may share. The `sensor_pin` of the heater
    is its chip select."""

    clock_pin: Pin
    """The clock of the SPI bus."""
    miso_pin: Pin
    """The data from the converter."""
    mosi_pin: Pin
    """The data to the converter. A MAX31855 or MAX6675 ignores the data, but the board needs a
    pin."""


class ThermocoupleConverter(Converter):
    """A thermocouple with a converter that has no settings."""

    kind: Literal["max31855", "max6675"]
    """A thermocouple interface."""


class UniversalConverter(Converter):
    """A thermocouple of any type with a MAX31856, which filters the frequency of the power grid."""

    kind: Literal["max31856"]
    """A thermocouple interface for all types."""
    thermocouple: Literal["B", "E", "J", "K", "N", "R", "S", "T"] = "K"
    """The type of the thermocouple."""
    mains_hz: Literal[50, 60] = 50
    """The frequency of the power grid, which the converter filters."""


class PlatinumConverter(Converter):
    """A PT100 or PT1000 (IEC 60751) on two, three or four wires with a MAX31865, which compares it
    with a reference resistor."""

    kind: Literal["max31865"]
    """An RTD interface."""
    r0_ohm: Literal[100, 1000] = 100
    """The resistance at 0 °C: 100 Ω for a PT100, 1000 Ω for a PT1000."""
    reference_ohm: Positive = 430.0
    """The reference resistor of the module."""
    wires: Literal[2, 3, 4] = 2
    """The wires of the sensor."""
    mains_hz: Literal[50, 60] = 50
    """The frequency of the power grid, which the converter filters."""


CONVERTERS = tuple(
    kind
    for model in (ThermocoupleConverter, UniversalConverter, PlatinumConverter)
    for kind in get_args(model.model_fields["kind"].annotation)
)

AnySensor = Annotated[
    Thermistor
    | Platinum
    | PlatinumAmplifier
    | ThermocoupleAmplifier
    | ThermocoupleConverter
    | UniversalConverter
    | PlatinumConverter
    | SensorTable,
    Field(discriminator="kind"),
]
