"""The correction of the bed, and the bed and the probe of a simulated printer."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.calibration import DeltaCalibration, Screws, SimulatedDelta, ZMotors
from passo.config.types import Model, Name, NotNegative, Pair, Position, Positive
from passo.probes.base import HeightOffset

PROBE = "probe"
"""The name of the input of the probe among the endstops."""
SERVO = "probe-servo"
"""The name of the output of its servo."""
SERVO_CYCLE_S = 0.02
"""Of the signal of a servo."""
UNKNOWNS = {"linear": 3, "quadratic": 6}
"""How many points each surface needs at least."""
MIN_DISTANCE_MM = 1.0
"""Points closer together than this count as one; points that deviate less from a line are on it."""

Area = Annotated[list[Position], Field(min_length=4, max_length=4)]


class ProbePoint(Model):
    """A point of the bed, as the probe gets to it."""

    x: Position
    """X of the probe, in mm."""
    y: Position
    """Y of the probe, in mm."""
    offset: HeightOffset = 0.0
    """What is added to the height that is measured here, in mm."""
    enabled: bool = True
    """Whether G32 measures this point."""


class Levelling(Model):
    """How the bed is measured and corrected."""

    method: Literal["none", "linear", "quadratic", "mesh"] = "none"
    """What is made of the measured points: nothing, a plane, a second-degree surface, or a mesh."""
    points: Annotated[list[ProbePoint], Field(max_length=100)] = []
    """The points that G32 measures, in this order; their numbers begin at 1."""
    area: Area | None = None
    """The rectangle of a mesh: X and Y of its first corner, then of the opposite one, in mm."""
    count: Annotated[
        list[Annotated[int, Field(ge=2, le=41)]], Field(min_length=2, max_length=2)
    ] = [
        5,
        5,
    ]
    """The points of a mesh in X and in Y."""
    interpolation: Literal["bicubic", "bilinear"] = "bicubic"
    """The surface between the points of a mesh."""
    margin_mm: Annotated[float, Field(ge=0, le=100)] = 5.0
    """How much further than the objects of a print an adaptive mesh goes."""
    reference: Pair | None = None
    """X and Y of the place where a mesh is 0, so that Z 0 is there as the endstop has it. If not
    given, a mesh has the heights that the probe finds."""
    avoid: list[Area] = []
    """Rectangles where the probe measures nothing useful: X and Y of two corners, in mm. A point
    of a mesh in one gets the mean of what is measured around it."""
    max_correction_mm: Positive = 2.0
    """A larger correction is refused."""
    max_slope: Positive = 0.02
    """A steeper correction is refused; in mm of height for each mm of bed."""
    dialect: Literal["marlin", "rrf"] = "marlin"
    """Whose meaning the words have that differ between Marlin and RepRapFirmware: the signs of
    M666, and `G29 S`, which in RepRapFirmware is S0 measure, S1 load, S2 forget, S3 store."""
    delta: DeltaCalibration = Field(default_factory=DeltaCalibration)
    """How a delta finds its geometry."""
    motors: ZMotors | None = None
    """How the motors of Z level the gantry."""
    screws: Screws | None = None
    """The screws of the bed."""


class SimulatedBed(Model):
    """The shape of a simulated bed, and the noise of the probe on it."""

    height_mm: Position = 0.0
    """The height of the whole bed."""
    tilt_mm: Pair = [0.0, 0.0]
    """The rise over the width and over the depth of the bed; zero in its centre."""
    dome_mm: Position = 0.0
    """The height of the centre above the corners."""
    wave_mm: Position = 0.0
    """The amplitude of waves."""
    wave_length_mm: Annotated[list[Positive], Field(min_length=2, max_length=2)] = [120.0, 160.0]
    """The length of the waves in X and in Y."""
    noise_mm: Annotated[float, Field(ge=0, le=10)] = 0.0
    """The standard deviation of the height at which the probe triggers."""
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 1
    """A number for the noise: the same number makes the same noise."""


class SimulatedProbe(Model):
    """Faults of a simulated probe."""

    hysteresis_mm: NotNegative = 0.0
    """A triggered probe opens this much above the height at which it triggers."""
    jammed: bool = False
    """The pin of a BLTouch, the arm of a servo, or the probe in its dock does not move."""
    stuck: Literal["open", "triggered"] | None = None
    """The probe is open, or triggered, at any height."""
    dead_areas: list[Area] = []
    """Rectangles where the probe does not trigger: X and Y of two corners of the nozzle, in mm."""
    touchy_areas: list[Area] = []
    """Rectangles where the probe is triggered at any height."""


class Simulated(Model):
    """What surrounds the simulated boards."""

    bed: SimulatedBed = Field(default_factory=SimulatedBed)
    """The simulated bed."""
    probe: SimulatedProbe = Field(default_factory=SimulatedProbe)
    """Faults of the simulated probe."""
    endstops_mm: dict[Name, Position] = {}
    """How much higher than `homing.z.position` the endstop of a motor really triggers."""
    delta: SimulatedDelta | None = None
    """The true geometry of a simulated delta."""
