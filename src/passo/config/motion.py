"""Axes, steppers, extruders, tools, and the limits of motion."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import Field, model_validator

from passo.config.drivers import DRIVERS, DriverName, DriverTimes
from passo.config.jerk import MAX_JERK
from passo.config.shapers import (
    DEFAULT_DAMPING,
    DEFAULT_TYPE,
    MAX_HZ,
    MIN_HZ,
)
from passo.config.trinamic import Tmc
from passo.config.types import (
    Acceleration,
    Fraction,
    Jerk,
    Model,
    Name,
    NotNegative,
    Pair,
    PartName,
    Pin,
    Point,
    Position,
    Positive,
    Scale,
    ShaperForm,
    Speed,
)

MICROSTEPS = 16
MAX_ADVANCE_S = 10.0
MIN_SMOOTH_S, MAX_SMOOTH_S = 0.001, 0.2  # of the advance; a shorter one counts as the minimum
Advance = Annotated[float, Field(ge=0, le=MAX_ADVANCE_S)]
SmoothTime = Annotated[float, Field(ge=0, le=MAX_SMOOTH_S)]
Knee = Annotated[list[NotNegative], Field(min_length=2, max_length=2)]
Knees = Annotated[list[Knee], Field(max_length=4)]
JerkLimit = Annotated[float, Field(gt=0, le=MAX_JERK)]
MAX_GAP_MM, SMOOTH_MM, SMOOTHS_MM = 2.0, 3.0, (0.1, 100.0)  # of backlash
GapMm = Annotated[float, Field(ge=0, le=MAX_GAP_MM)]
SmoothMm = Annotated[float, Field(ge=SMOOTHS_MM[0], le=SMOOTHS_MM[1])]
Damping = Annotated[float, Field(ge=0, le=0.99)]


class Axis(Model):
    """An axis of the machine. X, Y and Z are directions of the nozzle. A further axis is linear and
    has its own motors; it may be an `extruder`, as in APrinter."""

    extruder: bool = False
    """Whether a further axis moves filament. Then it has no limits and no home, and M82 and M83
    apply to it."""
    heater: str | None = None
    """Of an `extruder`: the heater below whose minimum temperature it does not move. If not given,
    the first hotend."""
    min_mm: Position = 0.0
    """The lower soft limit."""
    max_mm: Position
    """The upper soft limit. Not needed for an `extruder`."""
    home_mm: Position | None = None
    """The position after G28 of an axis without an endstop. If not given, `min_mm`."""
    speed_mm_s: Speed
    """The maximum speed."""
    accel_mm_s2: Acceleration
    """The maximum acceleration."""
    jerk_mm_s: Jerk = 10.0
    """The maximum instant change of speed at a corner with the law `jerk`. With `deviation` it
    applies to the axes after Z."""
    cornering_distance_steps: Positive = 40.0
    """The distance of the law `limits.junction = "cornering_distance"`, in steps."""

    @model_validator(mode="before")
    @classmethod
    def _extruder_without_limits(cls, values: Any) -> Any:
        if not isinstance(values, dict):
            return values
        table = cast("dict[str, Any]", values)
        return {"max_mm": 0.0} | table if table.get("extruder") is True else table


class Extruder(Model):
    """A filament motor."""

    speed_mm_s: Speed
    """The maximum speed of the filament."""
    accel_mm_s2: Acceleration
    """The maximum acceleration of the filament."""
    jerk_mm_s: Jerk = 1.0
    """The maximum instant change of speed at a corner."""
    advance_s: Advance | None = None
    """Pressure advance (M900, M572): the distance by which the filament leads its position, in mm
    for each mm/s of its speed. If neither this nor `advance_smooth_s` is given, the first M900 of a
    print waits until the moves before it are done."""
    advance_smooth_s: SmoothTime | None = None
    """The time over which the advance is smoothed, as Klipper's smooth time: the width of a
    triangle. If not given, 0.02 s where `accel_mm_s2` allows it, otherwise as little as it allows,
    at most 0.04 s; `passo check` says which. Below 0.001 s it is 0.001 s. A short time makes lines
    more even, and costs acceleration: `passo check` says how much."""
    shaped: bool = False
    """Whether the filament follows the input shapers of X and Y. The head follows the plan more
    closely than its motors do, so that lines are more even without it. If X and Y have different
    shapers, each move is divided by its direction squared."""

    advance_knees: Knees = []
    """Less advance at high flow: from each speed of the filament (mm/s) on, a further mm/s leads by
    this many s, as in `[[2.0, 0.03], [5.0, 0.01]]`. The speeds rise, and the values fall from
    `advance_s` on. M900 scales the values."""


class Shaping(Model):
    """The input shaper of an axis, which cancels vibration of the moved parts (M593)."""

    type: ShaperForm = DEFAULT_TYPE
    """The type: zv, mzv, zvd, ei, 2hump_ei or 3hump_ei. A longer one tolerates a wrong frequency
    better, and rounds corners more. `ei(v_tol=0.02)` is ei with at most this fraction of vibration
    at its frequency, 0.05 if it is not given, as in Klipper."""
    frequency_hz: Annotated[float, Field(ge=MIN_HZ, le=MAX_HZ)]
    """The frequency of the vibration."""
    damping: Damping = DEFAULT_DAMPING
    """The damping ratio of the vibration."""


class Backlash(Model):
    """The gaps in the drives of axes that have their own motors (M425). After a turn, the motor
    moves further by the gap, before the carriage follows."""

    x_mm: GapMm = 0.0
    """The gap of X."""
    y_mm: GapMm = 0.0
    """The gap of Y."""
    z_mm: GapMm = 0.0
    """The gap of Z."""
    smooth_mm: SmoothMm = SMOOTH_MM
    """The distance over which the motor takes up a gap after each turn. Within it the motor is
    faster than the axis by gap / distance, and stays within the limits of the axis."""


class Tool(Model):
    """A tool of T0, T1, …. Several tools may share an extruder. The machine subtracts `offset_mm`,
    so that the nozzle of this tool is at the position of the program."""

    extruder: str | None = None
    """The extruder of this tool. A laser or a spindle has none."""
    offset_mm: Point = [0.0, 0.0, 0.0]
    """X, Y and Z of this nozzle, relative to the nozzle of the first tool."""
    heater: str | None = None
    """The hotend of this tool."""
    fans: Annotated[list[PartName], Field(max_length=8)] = []
    """The fans that M106 and M107 without P set while this tool is active. A change of the tool
    switches those of other tools off. If not given, the fan with number 0."""
    fan_factor: Annotated[float, Field(ge=0, le=10)] = 1.0
    """The speed of M106 without P is multiplied by this, up to full speed."""


_PulseUs = Annotated[float, Field(ge=0, le=30)]  # the longest pulse of any board
_DirectionUs = Annotated[float, Field(ge=0, le=10_000)]
_RateHz = Annotated[float, Field(ge=1)]  # so that the step interval fits in a board's clock


class Stepper(Model):
    """A motor with its driver. Its scale is `steps_per_mm` (`steps_per_degree` on arms), or follows
    from rotation distance, full steps, microsteps and gear ratio. Limits apply to the position of
    the motor itself: the carriage of a tower, the angle of an arm."""

    drives: str | None = None
    """The actuator, axis or extruder that this motor moves. If not given, the one with the name of
    the motor, without its number: `z1` moves z."""
    steps_per_mm: Scale | None = None
    """Microsteps per mm of travel."""
    steps_per_degree: Scale | None = None
    """Microsteps per degree of an arm."""
    rotation_distance_mm: Positive | None = None
    """Travel per rotation, in place of `steps_per_mm`: full steps × microsteps × gear ratio /
    rotation distance."""
    full_steps_per_rotation: Annotated[int, Field(gt=0)] = 200
    """Full steps per rotation: 200 for a motor of 1.8°, 400 for 0.9°."""
    microsteps: Literal[1, 2, 4, 8, 16, 32, 64, 128, 256] = MICROSTEPS
    """Microsteps per full step. Passo sets them where board or driver allow it."""
    gear_ratio: Positive = 1.0
    """Rotations of the motor per rotation of the shaft."""
    invert: bool = False
    """Whether the motor turns the other way."""
    driver: DriverName = "A4988"
    """The kind of driver, which sets the times of pulses and directions and the maximum step
    rate."""
    tmc: Tmc | None = None
    """Registers of a TMC driver. Without this table Passo does not configure the driver."""
    peak_current_a: Positive | None = None
    """The maximum current of each phase, on boards that set the currents of their drivers."""
    pulse_us: _PulseUs | None = None
    """The minimum length of a step pulse, in place of the value of the driver."""
    direction_setup_us: _DirectionUs | None = None
    """The minimum time from a change of direction to the next step, in place of the value of the
    driver."""
    direction_hold_us: _DirectionUs | None = None
    """The minimum time from a step to a change of direction, in place of the value of the
    driver."""
    max_rate_hz: _RateHz | None = None
    """The maximum step rate, in place of the value of the driver."""
    socket: str | None = None
    """The socket of the driver on the board."""
    step_pin: Pin | None = None
    """The step pin of a motor without a `socket`."""
    direction_pin: Pin | None = None
    """The direction pin of a motor without a `socket`."""
    enable_pin: Pin | None = None
    """The enable pin of a motor without a `socket`."""
    speed_mm_s: Speed | None = None
    """The maximum speed of this motor: a carriage or a belt."""
    accel_mm_s2: Acceleration | None = None
    """The maximum acceleration of this motor."""
    min_mm: Position | None = None
    """The minimum position of this motor."""
    max_mm: Position | None = None
    """The maximum position of this motor."""
    speed_deg_s: Speed | None = None
    """The maximum speed of this arm."""
    accel_deg_s2: Acceleration | None = None
    """The maximum acceleration of this arm."""
    min_deg: Position | None = None
    """The minimum angle of this arm."""
    max_deg: Position | None = None
    """The maximum angle of this arm."""

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
        """The minimum step pulse, µs: the value of the file, or else of the driver."""
        return self.times.pulse_us if self.pulse_us is None else self.pulse_us

    @property
    def times(self) -> DriverTimes:
        """The times of the driver; single values of this motor may override them."""
        return DRIVERS[self.driver]


_PushedMm = Annotated[float, Field(ge=0, le=1000)]  # filament in one move


class Park(Model):
    """The parking of the nozzle while a print is paused: it rises by `raise_mm` and moves to X and
    Y of `position_mm`, with the filament retracted."""

    position_mm: Pair | None = None
    """X and Y of the nozzle during a pause. If not given, the nozzle stays above the print."""
    raise_mm: NotNegative = 10.0
    """The rise of Z before the nozzle moves to X and Y."""
    speed_mm_s: Speed = 100.0
    """The speed in X, Y and Z."""
    retract_mm: _PushedMm = 2.0
    """The retracted filament."""
    retract_mm_s: Speed = 30.0
    """The speed of this retraction."""
    prime_mm: _PushedMm = 5.0
    """The filament that M1000 extrudes before a print resumes."""
    prime_mm_s: Speed = 5.0
    """The speed of this filament."""


class Retraction(Model):
    """The retraction of G10 and G11, until M207 and M208 set another one."""

    length_mm: _PushedMm = 3.0
    """The filament that G10 retracts (M207 S)."""
    speed_mm_s: Speed = 45.0
    """The speed of G10 (M207 F)."""
    hop_mm: NotNegative = 0.0
    """The rise of Z after G10 (M207 Z)."""
    extra_mm: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    """The filament that G11 returns in addition (M208 S)."""
    return_mm_s: Speed | None = None
    """The speed of G11 (M208 F). If not given, that of G10."""


class Idle(Model):
    """Timeouts of an idle machine. Motors stay on while a heater has a target."""

    motors_off_s: NotNegative = 600.0
    """The motors are switched off after this time without a move or a command; never with 0, or
    while a heater has a target."""
    heaters_off_s: NotNegative = 1800.0
    """The heaters are switched off after this time without a move or a command; never with 0."""


Junction = Literal["deviation", "square_corner", "cornering_distance", "jerk"]
JUNCTIONS: tuple[Junction, ...] = ("deviation", "square_corner", "cornering_distance", "jerk")


class Limits(Model):
    """Limits of the path, and the law of the speed at corners: docs/explanation/planning.md."""

    print_accel_mm_s2: Acceleration | None = None
    """The acceleration of moves that extrude (M204 P). If not given, the smaller one of X and Y."""
    travel_accel_mm_s2: Acceleration | None = None
    """The acceleration of moves without filament (M204 T). If not given, the smaller one of X and
    Y."""
    retract_accel_mm_s2: Acceleration | None = None
    """The acceleration of moves of filament alone (M204 R). If not given, that of the fastest
    extruder."""
    speed_mm_s: Speed | None = None
    """The maximum speed of the path in X, Y and Z."""
    jerk_mm_s3: JerkLimit | None = None
    """The maximum change of the acceleration of X, Y and Z in a second, between corners
    (SET_JERK_LIMIT). All positions are then averaged over twice the largest acceleration of X, Y
    and Z divided by this, 0.15 s at most. Corners are cut by this: `passo check` prints by how
    much. If not given, acceleration changes at once."""
    junction: Junction = "deviation"
    """The law of corners: a deviation from the corner (grbl), a speed at right angles (Klipper), a
    distance in steps (APrinter), or an instant change of speed for each axis (Marlin)."""
    junction_deviation_mm: Positive = 0.02
    """The maximum distance between the corner and the arc of the law `deviation`."""
    square_corner_mm_s: Speed = 5.0
    """The speed at a right angle of the law `square_corner`. Unlike the speed of the law
    `deviation`, it does not depend on the acceleration that M204 sets."""
    minimum_cruise_ratio: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """At least this fraction of a move is at constant speed, as in Klipper. A move of Z or of the
    extruder that accelerates with less than the rest of `print_accel_mm_s2` need not be."""
    min_extrude_c: Annotated[float, Field(ge=0, le=1000)] = 170.0
    """Filament does not move while its hotend is colder than this (M302 S); with 0 it always
    moves."""
    least_speed_gain: Fraction = 0.0
    """A move that could exceed the speed at its ends by less than this fraction keeps that
    speed."""


Steppers = Annotated[dict[Name, Stepper], Field(min_length=1)]
