"""Calibration of a machine: the geometry of a delta, the tilt of a gantry, and bed screws."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.types import Model, Name, Pair, Position, Positive

Thread = Literal["M3 cw", "M3 ccw", "M4 cw", "M4 ccw", "M5 cw", "M5 ccw", "M6 cw", "M6 ccw"]


class DeltaCalibration(Model):
    """The settings of G33 for a delta: where it probes, and the maximum changes."""

    radius_mm: Positive | None = None
    """The distance of the outermost points from the middle. If not given, the maximum that nozzle
    and probe reach."""
    max_radius_mm: Positive = 5.0
    """The maximum change of the radius."""
    max_angle_deg: Positive = 3.0
    """The maximum change of the angle of a tower."""
    max_endstop_mm: Positive = 5.0
    """The maximum change of the position of an endstop."""
    max_rod_mm: Positive = 3.0
    """The maximum change of the length of a rod, by DELTA_ANALYZE."""


class Place(Model):
    """A place of the probe."""

    x: Position
    """X of the probe, in mm."""
    y: Position
    """Y of the probe, in mm."""


class ZMotors(Model):
    """The settings of G34, which levels the gantry or the bed with independent Z motors."""

    pivots: Annotated[dict[Name, Pair], Field(min_length=2, max_length=4)]
    """X and Y of the point at which each Z motor carries the gantry, in mm. Four motors: front
    left, back left, back right, front right."""
    points: Annotated[list[Place], Field(min_length=2, max_length=100)]
    """The points that G34 measures. For four motors: four points in the order of the motors."""
    max_adjust_mm: Positive = 2.0
    """The maximum distance that a motor moves against another one in a round."""
    tolerance_mm: Positive = 0.01
    """The tilt between the motors at which G34 is done."""
    retries: Annotated[int, Field(ge=0, le=30)] = 5
    """The number of times that G34 repeats the measurement and the adjustment."""


class BedScrew(Model):
    """A screw of the bed."""

    name: Annotated[str, Field(min_length=1, max_length=40)]
    """The name of the screw in reports."""
    x: Position
    """X of the probe above the screw, in mm."""
    y: Position
    """Y of the probe above the screw, in mm."""


class Screws(Model):
    """The screws that level the bed by hand (G35)."""

    thread: Thread = "M4 cw"
    """The size of the screws, which gives their pitch: 0.5, 0.7, 0.8 or 1 mm. `cw`: clockwise lifts
    the bed; `ccw`: it lowers it."""
    places: Annotated[list[BedScrew], Field(min_length=2, max_length=20)]
    """The screws. The first one stays as it is."""


_Three = Annotated[list[Position], Field(min_length=3, max_length=3)]
_Rods = Annotated[list[Positive], Field(min_length=3, max_length=3)]


class SimulatedDelta(Model):
    """The true dimensions of a simulated delta, where they differ from the machine file."""

    radius: Positive | None = None
    """The distance from a tower to the middle, in mm."""
    rods: _Rods | None = None
    """The lengths of the three rods, in mm."""
    angles: _Three | None = None
    """The directions of the towers, in degrees."""
    endstops: _Three | None = None
    """The positions of the carriages at their endstops, in mm."""
