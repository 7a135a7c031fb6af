"""Temperature sensors without a heater, which are shown, awaited, and followed by fans."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.i2c_sensors import I2cSensor
from passo.config.sensors import AnySensor, Thermistor
from passo.config.types import Letter, Model, PartName, Pin

_Celsius = Annotated[float, Field(ge=-274, le=1200)]


class HostSensor(Model):
    """The temperature of the computer that Passo runs on."""

    kind: Literal["host"]
    """The computer that Passo runs on."""
    path: str = "/sys/class/thermal/thermal_zone0/temp"
    """The file with the temperature, in 1/1000 °C."""


class ChipSensor(Model):
    """The sensor in the microcontroller of a board. It needs Klipper's firmware; with Passo's
    firmware it shows nothing. Without the calibration of the maker it is some 10 °C off."""

    kind: Literal["chip"]
    """The sensor in the microcontroller."""
    board: PartName | None = None
    """The board. If not given, the main one."""


class CombinedSensor(Model):
    """A temperature that follows from others, which heaters or `sensors` have. It is unknown while
    one of them is unknown or broken."""

    kind: Literal["combined"]
    """A temperature that follows from others."""
    of: Annotated[list[PartName], Field(min_length=1, max_length=20)]
    """The names of heaters and of other `sensors`."""
    by: Literal["mean", "min", "max"] = "mean"
    """Whether it is the mean, the lowest or the highest of them."""
    max_deviation_c: Annotated[float, Field(gt=0, le=1000)] | None = None
    """If they read further apart than this, the sensor is broken. If not given, they may differ."""


class ShownSensor(Model):
    """A temperature sensor without a heater."""

    sensor: Annotated[
        AnySensor | HostSensor | ChipSensor | CombinedSensor | I2cSensor,
        Field(discriminator="kind"),
    ] = Field(default_factory=Thermistor)
    """The sensor: a [name](sensors.md), `"host"`, `"chip"`, or a table. If not given, a thermistor
    of 100 kΩ."""
    sensor_pin: Pin | None = None
    """The analog input of the sensor, or the chip select of a converter."""
    min_c: _Celsius = -274.0
    """The minimum temperature. A reading below it is a fault."""
    max_c: _Celsius = 1200.0
    """The maximum temperature. A reading above it is a fault."""
    on_fault: Literal["machine", "report"] = "report"
    """Whether a broken sensor, or a reading beyond `min_c` or `max_c`, halts the printer or is only
    reported. A chip on I2C that gives no reading is only reported."""
    letter: Letter | None = None
    """The letter of this temperature in M105, such as C for a chamber."""
    ambient_c: Annotated[float, Field(ge=-50, le=300)] = 25.0
    """The temperature at this sensor on the simulated printer."""

    @property
    def on_board(self) -> bool:
        """Whether a board reads the sensor: it is not one of this computer, nor follows from
        others."""
        return not isinstance(self.sensor, HostSensor | CombinedSensor)


ShownSensors = dict[PartName, ShownSensor]
