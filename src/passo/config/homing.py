"""How axes are homed: endstops, directions, speeds and distances."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, Name, Pair, Pin, Position, Positive, Speed


class Homing(Model):
    """How an axis, a carriage of a delta, or an arm is homed. It moves `fast` towards its endstop,
    back by `retract`, and `slow` to the endstop again, which is then at `position`: on the
    `direction` half of the axis, perhaps a little beyond its limit."""

    direction: Literal["min", "max"]
    """The end of the axis that has the endstop."""
    position: Position
    """The position at which the endstop triggers, in mm or degrees."""
    pin: Pin | None = None
    """The endstop, which stops all motors of the axis. `!` inverts it, `^` asks for the pull-up."""
    probe: bool = False
    """Whether the probe is the endstop, in place of a `pin`. X and Y are homed before that, and the
    nozzle goes to where the probe is above `probe_at_mm`. The position is the trigger height."""
    probe_at_mm: Pair | None = None
    """X and Y of the probe while it homes the axis. If not given, the middle of the bed."""
    stepper_pins: dict[Name, Pin] = {}
    """An endstop for each motor of the axis, by the name of the motor."""
    offsets_mm: dict[Name, Position] = {}
    """How much higher than `position` the endstop of a motor in `stepper_pins` triggers: homing
    levels the motors by it. G34 finds these offsets."""
    fast: Speed = 40.0
    """The speed towards the endstop, in mm/s or degrees/s."""
    retract: Positive = 3.0
    """The distance back from the endstop, in mm or degrees. There it must be open again."""
    slow: Speed = 4.0
    """The speed of the second approach, in mm/s or degrees/s."""
    max_travel: Annotated[float, Field(gt=0, le=10_000)] | None = None
    """The maximum distance towards the endstop, in mm or degrees. If not given, the length of the
    axis and 20 % more."""
    by_default: bool = True
    """Whether G28 without letters homes this axis."""
