"""Heaters: their sensors, their control and their protections."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.sensors import AnySensor, Thermistor
from passo.config.types import Fraction, Model, NotNegative, PartName, Pin, Positive

_Celsius = Annotated[float, Field(ge=-100, le=1200)]


class PidControl(Model):
    """PID control. Gains that are left out follow from the model of the heater. The derivative is
    that of the temperature, not of the error."""

    kind: Literal["pid"] = "pid"
    """PID control."""
    kp: Positive | None = None
    """Proportional gain, in 1/255 of full power per °C, as in Klipper and Marlin. If not given, it
    follows from the model."""
    ki: NotNegative | None = None
    """Integral gain, in 1/255 of full power per °C·s. If not given, it follows from the model."""
    kd: NotNegative | None = None
    """Derivative gain, in 1/255 of full power per °C/s. If not given, it follows from the model."""
    filter_s: Positive = 1.0
    """Time constant of the filter of the derivative."""
    drive_min: Fraction = 0.0
    """The minimum of the integral, as a fraction of full power."""
    drive_max: Fraction = 1.0
    """The maximum of the integral, as a fraction of full power."""
    range_c: Positive = 10.0
    """Farther than this from the target the heater is fully on or off."""


class BangBangControl(Model):
    """On-off control with a hysteresis."""

    kind: Literal["bang-bang"] = "bang-bang"
    """On-off control."""
    hysteresis_c: NotNegative = 1.0
    """The heater is switched on this far below the target, and off this far above it."""
    interval_s: NotNegative = 5.0
    """The minimum time between two switchings."""


class ModelControl(Model):
    """Model-predictive control."""

    kind: Literal["model"] = "model"
    """Model-predictive control."""
    horizon_s: Positive = 3.0
    """The controller closes the gap to the target within this time."""


AnyControl = Annotated[
    PidControl | BangBangControl | ModelControl,
    Field(discriminator="kind"),
]


class HeatModel(Model):
    """The model of a heater: a first-order body, and a first-order sensor after it."""

    rise_c: Positive
    """The final temperature at full power, above the ambient temperature."""
    time_constant_s: Positive
    """The time in which 63 % of a change happens."""
    sensor_lag_s: Positive = 2.0
    """The time constant of the sensor."""
    fan_loss: NotNegative = 0.0
    """The fraction by which the fan at full speed increases the loss of heat."""
    ambient_c: _Celsius = 25.0
    """The ambient temperature."""


class Protection(Model):
    """Protections that switch a heater off, in addition to `min_c` and `max_c`. The value 0
    disables one. See docs/explanation/heat.md."""

    jump_c: NotNegative = 10.0
    """The sensor is erratic if it jumps by more than this, four times in a few seconds. 0: off."""
    watch_rise_c: NotNegative = 2.0
    """While the heater heats up at full power, its temperature must rise by this in each `watch_s`.
    0: off."""
    watch_s: Positive | None = None
    """The time of `watch_rise_c`. If not given, 20 s, and 90 s for a bed or a chamber."""
    runaway_c: NotNegative = 4.0
    """After it has reached its target, the heater must not stay this far below it for `runaway_s`.
    0: off."""
    runaway_s: Positive = 40.0
    """The time of `runaway_c`."""
    stuck_on_c: NotNegative = 10.0
    """Without power, the temperature of the heater must not rise by this in `stuck_on_s`. 0:
    off."""
    stuck_on_s: Positive = 60.0
    """The time of `stuck_on_c`."""
    deviation: NotNegative = 0.25
    """The maximum fraction of full power by which the heater may deviate from the model for
    `deviation_s`. 0: off."""
    deviation_s: Positive = 30.0
    """The time of `deviation`."""


_HOTEND_WATCH_S = 20.0
_SLOW_WATCH_S = 90.0  # a bed near its maximum temperature gains 2 °C in a minute


class Arrival(Model):
    """The condition under which a command stops waiting for a heater."""

    window_c: Positive = 1.0
    """The heater has arrived when it stays this close to the target for `seconds`."""
    leaves_c: Positive = 3.0
    """The time starts again if the heater leaves the target by more than this."""
    seconds: NotNegative | None = None
    """The time of `window_c`, in s. If not given, 10 s, and 0 for bang-bang control."""


class SimulatedHeat(Model):
    """A heater of a simulated printer: a first-order body, and a first-order sensor after it.
    Without this table, the heater behaves like its `model`; without a model, like a hotend of 40 W,
    a bed of 200 W or a chamber of 300 W, or like a stronger one if `max_c` needs it."""

    full_power_rise_c: Positive
    """The final temperature at full power, above the ambient temperature of 25 °C."""
    time_constant_s: Positive
    """The time in which 63 % of a change happens."""
    sensor_time_constant_s: Positive = 2.0
    """The time constant of the sensor."""
    fan_loss: NotNegative = 0.0
    """The fraction by which the fan at full speed increases the loss of heat."""


# A block of 13 J/K that loses 0.11 W/K; a plate of 730 J/K that loses 1.8 W/K; a chamber whose air
# and walls have 4000 J/K and lose 6 W/K.
_USUAL_HEAT = {
    "hotend": SimulatedHeat(full_power_rise_c=380.0, time_constant_s=120.0, fan_loss=0.3),
    "bed": SimulatedHeat(
        full_power_rise_c=110.0, time_constant_s=400.0, sensor_time_constant_s=4.0
    ),
    "chamber": SimulatedHeat(
        full_power_rise_c=50.0, time_constant_s=700.0, sensor_time_constant_s=10.0
    ),
}


# The smallest final temperature above the ambient one, relative to that of `max_c`.
_HEADROOM = 1.15
AMBIENT_C = 25.0
_LEAST_POWER = 0.05


def _simulated_heat(heater: dict[str, Any]) -> SimulatedHeat:
    """The simulated heater for a heater without a table `simulated`, from its other fields. It can
    reach `max_c` with `max_power`. The size of a bed has no influence: its power and its loss both
    grow with its area."""
    model = heater.get("model")
    if isinstance(model, HeatModel):
        return SimulatedHeat(
            full_power_rise_c=model.rise_c,
            time_constant_s=model.time_constant_s,
            sensor_time_constant_s=model.sensor_lag_s,
            fan_loss=model.fan_loss,
        )
    usual = _USUAL_HEAT[heater.get("kind", "hotend")]
    max_power = max(heater.get("max_power", 1.0), _LEAST_POWER)
    needed_c = _HEADROOM * (heater.get("max_c", AMBIENT_C) - AMBIENT_C) / max_power
    rise_c = max(usual.full_power_rise_c, needed_c)
    return usual.model_copy(update={"full_power_rise_c": rise_c})


class Heater(Model):
    """A heater with its sensor. The board pulses the output in software. A pulse cycle starts with
    each reading of the sensor, every 0.25 s; at 8 Hz, two whole cycles fit in between."""

    kind: Literal["hotend", "bed", "chamber"]
    """The kind, which determines the commands: M104 and M109 for a hotend, M140 and M190 for the
    bed, M141 and M191 for a chamber."""
    pin: Pin
    """The output. If not given, the output that the board has for such a heater."""
    further_pins: Annotated[list[Pin], Field(max_length=8)] = []
    """Further outputs of the same board, which switch together with `pin`."""
    sensor_pin: Pin
    """The analog input of the sensor, or the chip select of a converter. If not given, the input
    that the board has."""
    sensor: AnySensor = Field(default_factory=Thermistor)
    """The sensor: a [name](sensors.md) or a table. If not given, a thermistor of 100 kΩ."""
    fan: PartName | None = None
    """The fan that cools this heater."""
    max_power: Fraction = 1.0
    """The maximum power, as a fraction of full power."""
    pwm_hz: Annotated[float, Field(ge=4, le=1000)] = 8.0
    """Pulses per second of the output."""
    min_c: _Celsius = 5.0
    """The minimum temperature. A reading below it is a fault."""
    max_c: _Celsius
    """The maximum temperature. A reading above it is a fault."""
    control: AnyControl = Field(default_factory=PidControl)
    """How the heater is controlled."""
    model: HeatModel | None = None
    """The thermal model of the heater, which a tune can find."""
    protection: Protection = Field(default_factory=Protection)
    """Protections that switch the heater off, in addition to `min_c` and `max_c`."""
    arrival: Arrival = Field(default_factory=Arrival)
    """The condition under which a command stops waiting for this heater."""
    on_fault: Literal["machine", "job", "heater"] = "machine"
    """The parts that also stop when a protection has switched this heater off."""
    simulated: SimulatedHeat = Field(default_factory=_simulated_heat)
    """The behaviour of the heater on the simulated printer. If not given, that of its `model`, or
    the usual one for its `kind`, with at least the power that `max_c` needs."""

    @property
    def known_model(self) -> bool:
        """Whether the file describes how this heater heats, so that its readings can be compared
        with the model."""
        return bool({"model", "simulated"} & self.model_fields_set)

    @property
    def watch_s(self) -> float:
        """The time of `protection.watch_rise_c`: that of the file, or that of its kind."""
        usual_s = _HOTEND_WATCH_S if self.kind == "hotend" else _SLOW_WATCH_S
        return usual_s if self.protection.watch_s is None else self.protection.watch_s


Heaters = dict[PartName, Heater]
