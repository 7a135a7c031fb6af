"""How axes find out where they are: switches, and the way to them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, Name, Pin, Position, Positive, Speed


class Homing(Model):
    """The home of an axis, or of a carriage of a delta, or of an arm. Lengths in mm, of a turning
    arm in degrees; speeds per second.

    The axis moves `fast` towards its switch at the `direction` end, at most `max_travel`; back by
    `retract`, where the switch must be free again; and `slow` to the switch, which is then at
    `position`. That is on the `direction` half of the axis, also a little beyond its limit.
    One switch at `pin` stops all motors of the axis; with `stepper_pins` each motor has a switch of
    its own. In front of a pin `!` says that the switch reads low when pressed, `^` that it needs
    the pull-up. G28 without letters leaves out what is not `by_default`.
    """

    direction: Literal["min", "max"]
    position: Position
    pin: Pin | None = None
    stepper_pins: dict[Name, Pin] = {}
    fast: Speed = 40.0
    retract: Positive = 3.0
    slow: Speed = 4.0
    max_travel: Annotated[float, Field(gt=0, le=10_000)] | None = None
    by_default: bool = True
