"""What surrounds a simulated board, as plain data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Actuator:
    """What a stepper moves: a position (mm or degrees) that starts at `start`."""

    stepper: str
    steps_per_unit: float
    start: float = 0.0


@dataclass(frozen=True, slots=True)
class Switch:
    """The endstop `endstop` is pressed while the weighted sum of some steppers' actuator positions
    is at or beyond `position`: above it if `at_maximum`, else below. A pressed switch reads 1 (0 if
    the pin is inverted)."""

    endstop: str
    weights: tuple[tuple[str, float], ...]
    position: float
    at_maximum: bool = False


@dataclass(frozen=True, slots=True)
class Body:
    """What a heater heats: it tends to `ambient_c` + `rise_c` · power with `time_constant_s`; its
    sensor follows with `sensor_time_constant_s`. With the output `fan` at full speed it loses 1 +
    `fan_loss` times as much heat."""

    heater: str
    rise_c: float
    time_constant_s: float
    sensor_time_constant_s: float = 2.0
    ambient_c: float = 25.0
    fan: str | None = None
    fan_loss: float = 0.0


@dataclass(frozen=True, slots=True)
class PlantDescription:
    """Mechanics and heat of one simulated printer."""

    actuators: tuple[Actuator, ...] = ()
    switches: tuple[Switch, ...] = ()
    bodies: tuple[Body, ...] = ()
