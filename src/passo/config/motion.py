"""What moves: axes, steppers, extruders, tools and the limits of motion."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import Field, model_validator

from passo.config.drivers import DRIVERS, DriverName, DriverTimes
from passo.config.trinamic import Tmc
from passo.config.types import (
    Acceleration,
    Fraction,
    Jerk,
    Model,
    Name,
    NotNegative,
    Pair,
    Pin,
    Point,
    Position,
    Positive,
    Scale,
    Speed,
)

MICROSTEPS = 16


class Axis(Model):
    """A direction of the nozzle, X, Y or Z, or a further linear axis with motors of its own.

    `min_mm` and `max_mm` are the soft limits; `home_mm` is the position after homing where no
    switch has it (`min_mm` if not given). `jerk_mm_s` and `cornering_distance_steps` belong to the
    junction laws of those names.

    A further axis may be an `extruder`, as APrinter has them: then it has no limits and no home,
    M82 and M83 say how its words count, and it does not move while `heater` is cold (the first
    hotend if not given).
    """

    extruder: bool = False
    heater: str | None = None
    min_mm: Position = 0.0
    max_mm: Position
    home_mm: Position | None = None
    speed_mm_s: Speed
    accel_mm_s2: Acceleration
    jerk_mm_s: Jerk = 10.0
    cornering_distance_steps: Positive = 40.0

    @model_validator(mode="before")
    @classmethod
    def _extruder_without_limits(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        table = cast("dict[str, Any]", values)
        return {"max_mm": 0.0} | table if table.get("extruder") is True else table


class Extruder(Model):
    """A filament motor. `jerk_mm_s` is the speed change that it may make at once at a junction."""

    speed_mm_s: Speed
    accel_mm_s2: Acceleration
    jerk_mm_s: Jerk = 1.0


class Tool(Model):
    """What T0, T1, … select, in order. Several tools may share an extruder, and a spindle's or a
    laser's tool has none. `offset_mm` is the nozzle's place relative to the first tool's: the
    machine stands so much the other way."""

    extruder: str | None = None
    offset_mm: Point = [0.0, 0.0, 0.0]
    heater: str | None = None


_PulseUs = Annotated[float, Field(ge=0, le=30)]  # no board makes longer ones
_DirectionUs = Annotated[float, Field(ge=0, le=10_000)]
_RateHz = Annotated[float, Field(ge=1)]  # so that a board's clocks hold its interval


class Stepper(Model):
    """A motor with its driver.

    It drives the actuator, axis or extruder called `drives`; without that key, the one that has the
    motor's own name, or the name without its number (`z1` is a second motor of `z`). The scale is
    given as `steps_per_mm` (`steps_per_degree` on arms), or by the parts it comes from:
    full steps per rotation × microsteps × gear ratio / rotation distance (or / 360°).
    Limits hold for the motor's own position: a tower's carriage, an arm's angle.
    A driver with the table `tmc` is set up by Passo, to these microsteps too. On a board that sets
    its drivers' currents `peak_current_a` is the limit of each phase.
    """

    drives: str | None = None
    steps_per_mm: Scale | None = None
    steps_per_degree: Scale | None = None
    rotation_distance_mm: Positive | None = None
    full_steps_per_rotation: Annotated[int, Field(gt=0)] = 200
    microsteps: Literal[1, 2, 4, 8, 16, 32, 64, 128, 256] = MICROSTEPS
    gear_ratio: Positive = 1.0
    invert: bool = False
    driver: DriverName = "A4988"
    tmc: Tmc | None = None
    peak_current_a: Positive | None = None
    pulse_us: _PulseUs | None = None
    direction_setup_us: _DirectionUs | None = None
    direction_hold_us: _DirectionUs | None = None
    max_rate_hz: _RateHz | None = None
    socket: str | None = None
    step_pin: Pin | None = None
    direction_pin: Pin | None = None
    enable_pin: Pin | None = None
    speed_mm_s: Speed | None = None
    accel_mm_s2: Acceleration | None = None
    min_mm: Position | None = None
    max_mm: Position | None = None
    speed_deg_s: Speed | None = None
    accel_deg_s2: Acceleration | None = None
    min_deg: Position | None = None
    max_deg: Position | None = None

    @property
    def steps_per_unit(self) -> float:
        """Microsteps per mm, or per degree of an arm."""
        if self.steps_per_mm is not None:
            return self.steps_per_mm
        if self.steps_per_degree is not None:
            return self.steps_per_degree
        per_rotation = self.full_steps_per_rotation * self.microsteps * self.gear_ratio
        return per_rotation / (self.rotation_distance_mm or 360.0)

    @property
    def shortest_pulse_us(self) -> float:
        """What the driver asks for, or what the file says instead."""
        return self.times.pulse_us if self.pulse_us is None else self.pulse_us

    @property
    def times(self) -> DriverTimes:
        """The driver's own times; single values of this motor may override them."""
        return DRIVERS[self.driver]


_PushedMm = Annotated[float, Field(ge=0, le=1000)]  # of filament, at once


class Park(Model):
    """Where the nozzle waits while a print is paused: `raise_mm` above the print, then at X and Y
    of `position_mm` (stays over the print if not given), with the filament drawn back.
    After an interruption the nozzle is filled with `prime_mm` of filament over the print."""

    position_mm: Pair | None = None
    raise_mm: NotNegative = 10.0
    speed_mm_s: Speed = 100.0
    retract_mm: _PushedMm = 2.0
    retract_mm_s: Speed = 30.0
    prime_mm: _PushedMm = 5.0
    prime_mm_s: Speed = 5.0


class Idle(Model):
    """What goes off when nothing has moved and nobody has commanded for so long; 0: nothing. Motors
    stay on while a heater has a target."""

    motors_off_s: NotNegative = 600.0
    heaters_off_s: NotNegative = 1800.0


class Limits(Model):
    """Limits along the path, and the law of the speed at a junction.

    The accelerations are those of M204 (P, T, R); without a value the slower of X and Y counts for
    prints and travels, and the fastest extruder for retractions. Laws: `deviation` is grbl's circle
    that leaves the corner by at most `junction_deviation_mm`; `cornering_distance` is APrinter's,
    in steps of each axis; `jerk` is the classic instant speed change of each axis. A move that
    could speed up for less than `least_speed_gain`, a share of the faster of its ends, does not.
    """

    print_accel_mm_s2: Acceleration | None = None
    travel_accel_mm_s2: Acceleration | None = None
    retract_accel_mm_s2: Acceleration | None = None
    speed_mm_s: Speed | None = None
    junction: Literal["deviation", "cornering_distance", "jerk"] = "deviation"
    junction_deviation_mm: Positive = 0.02
    minimum_cruise_ratio: Annotated[float, Field(ge=0, lt=1)] = 0.0
    least_speed_gain: Fraction = 0.0


Steppers = Annotated[dict[Name, Stepper], Field(min_length=1)]
