"""Heaters: their sensors, how they are controlled, and what they are protected from."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from passo.config.sensors import AnySensor, Thermistor
from passo.config.types import Fraction, Model, Name, NotNegative, Pin, Positive

_Celsius = Annotated[float, Field(ge=-100, le=1200)]


class PidControl(Model):
    """PID control. `kp`, `ki` and `kd` have the unit of Klipper, Marlin and M301: 1/255 of full
    power by °C, by °C·s and by °C/s; those left out follow from the heater's model. The derivative
    is of the temperature, filtered with `filter_s`; the integral stays within `drive_min` and
    `drive_max`, fractions of full power; farther than `range_c` from its target the heater is fully
    on or off.
    """

    kind: Literal["pid"] = "pid"
    kp: Positive | None = None
    ki: NotNegative | None = None
    kd: NotNegative | None = None
    filter_s: Positive = 1.0
    drive_min: Fraction = 0.0
    drive_max: Fraction = 1.0
    range_c: Positive = 10.0


class BangBangControl(Model):
    """Fully on below the target by more than the hysteresis, off above it by more; no two
    switchings within `interval_s`."""

    kind: Literal["bang-bang"] = "bang-bang"
    hysteresis_c: NotNegative = 1.0
    interval_s: NotNegative = 5.0


class ModelControl(Model):
    """Model-predictive control: the power that by the heater's model closes the gap within
    `horizon_s`."""

    kind: Literal["model"] = "model"
    horizon_s: Positive = 3.0


AnyControl = Annotated[
    PidControl | BangBangControl | ModelControl,
    Field(discriminator="kind"),
]


class HeatModel(Model):
    """A heater as its controllers see it: a first-order body under a first-order sensor.

    At full power it ends `rise_c` above the room, and it comes 63 % nearer to its end in each
    `time_constant_s`; the sensor follows with `sensor_lag_s`. A fan at full speed makes it lose
    `fan_loss` (a share) more heat.
    """

    rise_c: Positive
    time_constant_s: Positive
    sensor_lag_s: Positive = 2.0
    fan_loss: NotNegative = 0.0
    ambient_c: _Celsius = 25.0


class Protection(Model):
    """What switches a heater off besides `min_c` and `max_c`; 0 switches a protection off.

    `jump_c` between two readings, several times in some seconds: the sensor is erratic. On its way
    up, at full power, it must get `watch_rise_c` warmer in each `watch_s` (default 20 s, 90 s for a
    bed or a chamber). Once there, it must not stay `runaway_c` below its target for `runaway_s`.
    Without power it must not get `stuck_on_c` warmer in `stuck_on_s`. `deviation` is the share of
    full power that its model may leave unexplained for `deviation_s`.
    """

    jump_c: NotNegative = 10.0
    watch_rise_c: NotNegative = 2.0
    watch_s: Positive | None = None
    runaway_c: NotNegative = 4.0
    runaway_s: Positive = 40.0
    stuck_on_c: NotNegative = 10.0
    stuck_on_s: Positive = 60.0
    deviation: NotNegative = 0.25
    deviation_s: Positive = 30.0


class Arrival(Model):
    """Who waits for a target goes on `seconds` after the temperature has come within `window_c` of
    it; when it leaves it by more than `leaves_c`, they begin anew. `seconds` is 10 unless given,
    and 0 for a bang-bang control, which swings."""

    window_c: Positive = 1.0
    leaves_c: Positive = 3.0
    seconds: NotNegative | None = None


class SimulatedHeat(Model):
    """How the heater behaves on a simulated printer: a first-order body under a first-order sensor.

    At full power it ends `full_power_rise_c` above the room, and it comes 63 % nearer to its end in
    each `time_constant_s`; the sensor follows with `sensor_time_constant_s`. The heater's fan at
    full speed makes it lose `fan_loss` (a fraction) more heat.

    Without this table a heater is like its `model`; without that, too, it is a hotend of 40 W, a
    bed of 200 W or a chamber of 300 W.
    """

    full_power_rise_c: Positive
    time_constant_s: Positive
    sensor_time_constant_s: Positive = 2.0
    fan_loss: NotNegative = 0.0


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


def _simulated_heat(heater: dict[str, Any]) -> SimulatedHeat:
    """Of a heater without such a table, whose other fields are these."""
    model = heater.get("model")
    if isinstance(model, HeatModel):
        return SimulatedHeat(
            full_power_rise_c=model.rise_c,
            time_constant_s=model.time_constant_s,
            sensor_time_constant_s=model.sensor_lag_s,
            fan_loss=model.fan_loss,
        )
    return _USUAL_HEAT[heater.get("kind", "hotend")]


class Heater(Model):
    """A heater with its sensor; outside `min_c`…`max_c` it is a fault. `kind` says which commands
    mean it: M104 and M109 a hotend, M140 and M190 the bed, M141 and M191 a chamber.

    `fan` names the fan that cools it. `model` is what a tune has found; without it the figures of
    `simulated` are used. `on_fault` says what else stops when a protection has switched
    it off: the whole `machine`, the `job`, or nothing but this `heater`. The board pulses it in
    software, `pwm_hz` times a second. With each reading of the sensor, every 0.25 s, a cycle begins
    anew: two whole ones fit between them at 8 Hz.
    """

    kind: Literal["hotend", "bed", "chamber"]
    pin: Pin
    sensor_pin: Pin
    sensor: AnySensor = Field(default_factory=Thermistor)
    fan: Name | None = None
    max_power: Fraction = 1.0
    pwm_hz: Annotated[float, Field(ge=4, le=1000)] = 8.0
    min_c: _Celsius = 5.0
    max_c: _Celsius
    control: AnyControl = Field(default_factory=PidControl)
    model: HeatModel | None = None
    protection: Protection = Field(default_factory=Protection)
    arrival: Arrival = Field(default_factory=Arrival)
    on_fault: Literal["machine", "job", "heater"] = "machine"
    simulated: SimulatedHeat = Field(default_factory=_simulated_heat)

    @property
    def known_model(self) -> bool:
        """Whether the file describes how this heater heats, so that its readings can be judged by
        it."""
        return bool({"model", "simulated"} & self.model_fields_set)


Heaters = dict[Name, Heater]
