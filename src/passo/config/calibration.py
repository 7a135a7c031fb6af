"""How a machine finds its geometry: a delta's, the tilt of its gantry, and its bed screws."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.config.types import Model, Position, Positive


class DeltaCalibration(Model):
    """How G33 calibrates a delta: where it probes, and what may change at most."""

    radius_mm: Positive | None = None
    """The distance of the outermost points from the middle. If not given, what nozzle and probe
    reach."""
    max_radius_mm: Positive = 5.0
    """The maximum change of the radius."""
    max_angle_deg: Positive = 3.0
    """The maximum change of the angle of a tower."""
    max_endstop_mm: Positive = 5.0
    """The maximum change of the position of an endstop."""


_Three = Annotated[list[Position], Field(min_length=3, max_length=3)]
_Rods = Annotated[list[Positive], Field(min_length=3, max_length=3)]


class SimulatedDelta(Model):
    """What a simulated delta measures really, where the machine file has it otherwise."""

    radius: Positive | None = None
    """The distance from a tower to the middle, in mm."""
    rods: _Rods | None = None
    """The lengths of the three rods, in mm."""
    angles: _Three | None = None
    """The directions of the towers, in degrees."""
    endstops: _Three | None = None
    """The positions of the carriages at their endstops, in mm."""
