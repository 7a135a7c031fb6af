"""The correction of the bed, and the bed and the probe of a simulated printer."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from passo.config.calibration import DeltaCalibration, Screws, SimulatedDelta, ZMotors
from passo.config.simulated_motion import SimulatedMass
from passo.config.types import (
    Model,
    Name,
    NotNegative,
    Pair,
    PartName,
    Position,
    Positive,
    ShapedAxis,
)
from passo.probes.base import HeightOffset

PROBE = "probe"
"""The name of the input of the probe among the endstops."""
SERVO = "probe-servo"
"""The name of the output of its servo."""
UNKNOWNS = {"linear": 3, "quadratic": 6}
"""The minimum number of points for each kind of surface."""
MIN_DISTANCE_MM = 1.0
"""Points that are closer together count as one; points that deviate less from a line count as on
it."""

Area = Annotated[list[Position], Field(min_length=4, max_length=4)]


class ProbePoint(Model):
    """A point of the bed that the probe measures."""

    x: Position
    """X of the probe, in mm."""
    y: Position
    """Y of the probe, in mm."""
    offset: HeightOffset = 0.0
    """A correction that is added to the measured height, in mm."""
    enabled: bool = True
    """Whether G32 measures this point."""


class Levelling(Model):
    """The measurement and correction of the bed."""

    method: Literal["none", "linear", "quadratic", "mesh"] = "none"
    """The correction that is made from the measured points: none, a plane, a second-degree surface,
    or a mesh."""
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
    """The interpolation between the points of a mesh."""
    margin_mm: Annotated[float, Field(ge=0, le=100)] = 5.0
    """The margin of an adaptive mesh around the objects of a print."""
    reference: Pair | None = None
    """X and Y of the place where the mesh is 0, so that Z 0 there is that of the endstop. If not
    given, the mesh has the heights that the probe measures."""
    fade_mm: Annotated[float, Field(ge=0, le=1000)] = 0.0
    """The height at which the correction has faded out (M420 Z); with 0 it does not fade."""
    avoid: list[Area] = []
    """Rectangles in which the probe cannot measure: X and Y of two corners, in mm. A mesh point in
    such a rectangle gets the mean of heights measured around it."""
    max_correction_mm: Positive = 2.0
    """A larger correction is refused."""
    max_slope: Positive = 0.02
    """A steeper correction is refused; in mm of height for each mm of bed."""
    dialect: Literal["marlin", "rrf"] = "marlin"
    """The dialect of words that differ between Marlin and RepRapFirmware: the signs of M666, and
    `G29 S`, which in RepRapFirmware is S0 measure, S1 load, S2 forget, S3 store."""
    delta: DeltaCalibration = Field(default_factory=DeltaCalibration)
    """The calibration of a delta."""
    motors: ZMotors | None = None
    """The levelling of the gantry by Z motors."""
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
    """The seed of the noise: equal seeds give equal noise."""


class SimulatedProbe(Model):
    """Faults of a simulated probe."""

    coil_c: Annotated[float, Field(ge=-20, le=150)] = 25.0
    """The temperature of the coil of an eddy current probe. Its frequency falls by 2 ppm for each
    °C above 25 °C."""
    hysteresis_mm: NotNegative = 0.0
    """A triggered probe opens this much above the height at which it triggers."""
    jammed: bool = False
    """Whether the pin of a BLTouch, the arm of a servo, or a probe in its dock is stuck."""
    stuck: Literal["open", "triggered"] | None = None
    """A constant state of the probe: open or triggered at any height."""
    dead_areas: list[Area] = []
    """Rectangles where the probe does not trigger: X and Y of two corners of the nozzle, in mm."""
    touchy_areas: list[Area] = []
    """Rectangles where the probe is triggered at any height."""


class Simulated(Model):
    """The mechanics around the simulated boards."""

    bed: SimulatedBed = Field(default_factory=SimulatedBed)
    """The simulated bed."""
    probe: SimulatedProbe = Field(default_factory=SimulatedProbe)
    """Faults of the simulated probe."""
    endstops_mm: dict[Name, Position] = {}
    """The true height above the home position at which the endstop of a Z motor triggers."""
    delta: SimulatedDelta | None = None
    """The true geometry of a simulated delta."""
    filament_mm: dict[PartName, Positive] = {}
    """The length of the filament behind each filament sensor. Without a length it does not end."""
    masses: dict[ShapedAxis, SimulatedMass] = {}
    """What vibrates in X, Y and Z. An axis without this table has the typical frequency of its
    geometry, such as 55 Hz in X and 35 Hz in Y of a cartesian printer, and a damping ratio of
    0.1."""
    nozzle_pressure_s: Annotated[float, Field(ge=0.001, le=2)] = 0.05
    """The time constant with which the flow of each nozzle follows its extruder: the advance_s that
    compensates it. A filament motor on the head has 0.02 to 0.06 s, one with a long tube 0.3 to
    1 s."""
