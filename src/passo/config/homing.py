"""Homing of axes: endstops, directions, speeds and distances."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, Name, NotNegative, Pair, Pin, Position, Positive, Speed


class Stall(Model):
    """Stall detection of the drivers as the endstop of an axis: it moves at its speed `fast` until
    a motor stalls at the end of the travel, and back by `retract`. The motors of the axis whose
    driver has the pin `diag_pin`, `diag0_pin` or `diag1_pin` are watched."""

    threshold: Annotated[int, Field(ge=-64, le=255)]
    """The threshold of the load: SGTHRS of a TMC2209, 0 to 255, where a high value stops early; SGT
    of other drivers, -64 to 63, where a low value stops early."""
    current_a: Positive | None = None
    """The RMS current of the motors while the axis homes. If not given, that of the driver."""
    min_travel: NotNegative = 2.0
    """A stall within this travel, in mm or degrees, does not count: the axis moves away by twice as
    much, and homes once more."""


class Homing(Model):
    """Homing of an axis, a carriage of a delta, or an arm. It moves fast towards its endstop,
    retracts, and moves slowly to the endstop again. Its position is then `position_mm` or
    `position_deg`, which must be on the `direction` half of the axis, or a little beyond its
    limit."""

    direction: Literal["min", "max"]
    """The end of the axis that has the endstop."""
    position: Position
    """The position at which the endstop triggers, in mm or degrees."""
    pin: Pin | None = None
    """The endstop, which stops all motors of the axis. `!` inverts it, `^` asks for the pull-up."""
    probe: bool = False
    """Whether the probe is the endstop, instead of a `pin`. X and Y must be homed first; then the
    nozzle moves so that the probe is above `probe_at_mm`. The position is the trigger height."""
    probe_at_mm: Pair | None = None
    """X and Y of the probe for homing. If not given, the middle of the bed."""
    stall: Stall | None = None
    """Stall detection in place of a `pin`: docs/how-to/home-without-switches.md."""
    stepper_pins: dict[Name, Pin] = {}
    """An endstop for each motor of the axis, by the name of the motor."""
    offsets_mm: dict[Name, Position] = {}
    """The height above the home position at which the endstop of a motor in `stepper_pins`
    triggers. Homing levels the motors with these offsets, which G34 can measure."""
    fast: Speed = 40.0
    """The speed towards the endstop, in mm/s or degrees/s."""
    retract: Positive = 3.0
    """The distance back from the endstop, in mm or degrees. There it must be open again. An axis
    that was behind its endstop moves back until it opens."""
    slow: Speed = 4.0
    """The speed of the second approach, in mm/s or degrees/s."""
    max_travel: Annotated[float, Field(gt=0, le=10_000)] | None = None
    """The maximum distance towards the endstop, in mm or degrees. If not given, the length of the
    axis and 20 % more."""
    by_default: bool = True
    """Whether G28 without letters homes this axis."""

    @property
    def rest(self) -> float:
        """The position of the axis after homing: at its endstop, or back from a stall."""
        if self.stall is None:
            return self.position
        return self.position + (self.retract if self.direction == "min" else -self.retract)
