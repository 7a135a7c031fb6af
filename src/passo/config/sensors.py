"""Temperature sensors on an analog input or an SPI bus, as a machine file describes them."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from passo.config.types import Model, Pair, Pin, Positive

_Offset = Annotated[float, Field(ge=-64, le=64)]
_Ohm = Annotated[float, Field(ge=1, le=1e9)]


class Thermistor(Model):
    """An NTC resistor to ground under a pull-up resistor: 1/T = A + B·ln R + C·(ln R)³ where B =
    1/β, C = `c_per_k`, and A such that it has `r25_ohm` at 25 °C. The offsets are errors at the two
    ends of the ADC, in pairs of steps of 1/1024 of full scale (L and O of M305)."""

    kind: Literal["thermistor"] = "thermistor"
    r25_ohm: _Ohm = 100_000.0
    beta_k: Annotated[float, Field(ge=100, le=20_000)] = 3950.0
    c_per_k: Annotated[float, Field(ge=0, le=1e-5)] = 0.0
    pullup_ohm: _Ohm = 4700.0
    adc_offset_low: _Offset = 0.0
    adc_offset_high: _Offset = 0.0


class Platinum(Model):
    """A PT100 or PT1000 (IEC 60751) to ground under a pull-up resistor."""

    kind: Literal["pt100", "pt1000"]
    pullup_ohm: Positive = 4700.0

    @property
    def r0_ohm(self) -> float:
        """At 0 °C."""
        return _at_0_c(self.kind)


class PlatinumAmplifier(Model):
    """A PT100 or PT1000 to ground under `pullup_ohm`, and an amplifier behind them: its output is
    `supply_v` · `gain` · R / (R + `pullup_ohm`); the ADC's full scale is `full_scale_v`."""

    kind: Literal["pt100-amplifier", "pt1000-amplifier"]
    gain: Positive = 10.0
    pullup_ohm: Positive = 4400.0
    supply_v: Positive = 5.0
    full_scale_v: Positive = 5.0

    @property
    def r0_ohm(self) -> float:
        """At 0 °C."""
        return _at_0_c(self.kind)


def _at_0_c(kind: str) -> float:
    return 1000.0 if kind.startswith("pt1000") else 100.0


class ThermocoupleAmplifier(Model):
    """A thermocouple behind an AD595 (10 mV/°C) or an AD8495 (5 mV/°C); what it says is multiplied
    by `scale`, then `offset_c` is added."""

    kind: Literal["ad595", "ad8495"]
    full_scale_v: Positive = 5.0
    scale: Positive = 1.0
    offset_c: Annotated[float, Field(ge=-100, le=100)] = 0.0


class SensorTable(Model):
    """A sensor by points `[°C, share of the ADC's full scale]` with straight lines between them.

    They stand here or, as lines `°C, share`, in `file`, whose path begins at the machine file.
    `open_reads` says on which side of the table the ADC ends when the sensor's cable is open.
    """

    kind: Literal["table"]
    file: str | None = None
    points: Annotated[list[Pair], Field(min_length=2, max_length=1000)]
    open_reads: Literal["high", "low"] = "high"


class Converter(Model):
    """What converts a sensor on an SPI bus, which it may share; the heater's `sensor_pin` selects
    it."""

    clock_pin: Pin
    miso_pin: Pin
    mosi_pin: Pin


class ThermocoupleConverter(Converter):
    """A thermocouple behind a converter that hears nothing, but the board wants a pin to send
    on."""

    kind: Literal["max31855", "max6675"]


class UniversalConverter(Converter):
    """A thermocouple of any type behind a MAX31856, which leaves out what the mains put into its
    wires."""

    kind: Literal["max31856"]
    thermocouple: Literal["B", "E", "J", "K", "N", "R", "S", "T"] = "K"
    mains_hz: Literal[50, 60] = 50


class PlatinumConverter(Converter):
    """A PT100 or PT1000 (`r0_ohm`, IEC 60751) on two, three or four `wires` behind a MAX31865,
    which measures it against the resistor `reference_ohm`."""

    kind: Literal["max31865"]
    r0_ohm: Literal[100, 1000] = 100
    reference_ohm: Positive = 430.0
    wires: Literal[2, 3, 4] = 2
    mains_hz: Literal[50, 60] = 50


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
