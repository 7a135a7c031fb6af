"""The common base of all probes, and the methods of the print head that a probe may use."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Protocol

from pydantic import Field

from passo.config.types import Model, Pair, PartName, Pin, Position, Positive, Speed
from passo.errors import CommandError

HeightOffset = Annotated[float, Field(ge=-30, le=30)]


class Head(Protocol):
    """The print head with its probe. Every method may raise MachineError. After M108 and M410 they
    raise Stopped, unless the probe is being stowed after a failure."""

    def triggered(self) -> bool:
        """Asks the board whether the probe is triggered. Lets time pass."""
        ...

    async def sleep(self, seconds: float) -> None:
        """Lets time pass."""

    async def pulse(self, width_us: float, seconds: float) -> None:
        """Sends pulses of `width_us` to the control pin, 50 times a second for `seconds`."""

    @property
    def z_mm(self) -> float:
        """The Z of the nozzle in machine coordinates, mm."""
        ...

    async def move(
        self,
        speed_mm_s: float,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
    ) -> None:
        """Moves the nozzle in a straight line to machine coordinates, mm; an axis without a value
        stays."""


@dataclass(frozen=True, slots=True)
class Mechanism:
    """The behaviour of a simulated probe, for `passo._core.ProbeMechanism`: pulses of a servo in
    µs, the place of a dock, and the place that the head leaves to without the probe, mm."""

    kind: Literal["fixed", "servo", "bltouch", "dock"] = "fixed"
    deploy_us: float = 0.0
    stow_us: float = 0.0
    stowed_reads: bool = False
    dock_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    leave_mm: tuple[float, float] = (0.0, 0.0)


class Probe(Model):
    """The keys that every probe has, and its deployment, which does nothing for a probe that is
    fixed."""

    # if False, the probe is deployed above the first point
    travels_to_deploy: ClassVar[bool] = False
    offset_mm: Pair = [0.0, 0.0]
    """X and Y from the nozzle to the probe."""
    start_mm: Annotated[float, Field(gt=0, le=100)] = 10.0
    """Z of the nozzle at the start of each descent, and between the points."""
    lift_mm_s: Speed = 10.0
    """The speed of lifts."""
    travel_mm_s: Speed = 100.0
    """The speed between points."""

    @property
    def servo_pin(self) -> str | None:
        """The pin that a servo is on."""
        return None

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism of the simulated probe."""
        return Mechanism()

    def start_pulse(self) -> tuple[float, float] | None:
        """The width, µs, and the duration, s, of the pulses that stow the probe when the boards
        start; None if it needs none."""
        return None

    def width_us(self, degrees: float) -> float:
        """The pulse width for an angle of M280, as in Marlin."""
        return 544 + degrees * 1856 / 180

    async def deploy(self, head: Head) -> None:
        """Deploys the probe before a run. Raises CommandError if that fails."""

    async def arm(self, head: Head) -> None:
        """Prepares the probe before each descent. Raises CommandError if the probe is not ready."""

    async def disarm(self, head: Head) -> None:
        """Called after each successful descent; after a failure, `stow` is called instead."""

    async def stow(self, head: Head) -> None:
        """Stows the probe after a run. Raises CommandError if that fails."""


class Twist(Model):
    """How the measured heights change along an axis whose rail is twisted, so that the probe tilts
    about the nozzle."""

    from_mm: Position
    """The place on the bed, along the axis, for the first of `heights_mm`."""
    to_mm: Position
    """The place for the last."""
    across_mm: Position
    """The place on the other axis, of X and Y, where AXIS_TWIST_COMPENSATION_CALIBRATE measures."""
    heights_mm: Annotated[list[Annotated[float, Field(ge=-5, le=5)]], Field(max_length=100)] = []
    """What is added to the heights that the probe measures, at places at equal distances: none, or
    at least two."""

    def at(self, mm: float) -> float:
        """The correction with the probe at this place, mm: linear between the places, and beyond
        the outer ones on the same lines."""
        heights = self.heights_mm
        if len(heights) < 2:
            return 0.0
        along = (mm - self.from_mm) / (self.to_mm - self.from_mm) * (len(heights) - 1)
        i = min(max(int(along), 0), len(heights) - 2)
        return heights[i] + (along - i) * (heights[i + 1] - heights[i])

    def places(self, count: int) -> list[float]:
        """The places for this number of heights, mm."""
        step = (self.to_mm - self.from_mm) / (count - 1)
        return [round(self.from_mm + i * step, 6) for i in range(count)]


class SensingProbe(Probe):
    """A probe that stops a descent."""

    trigger_height_mm: HeightOffset
    """The height of the nozzle above the bed at which the probe triggers."""
    low_mm: Annotated[float, Field(ge=-40, le=10)] = -2.0
    """The lowest Z of the nozzle during a descent, whatever the probe does."""
    fast_mm_s: Speed = 5.0
    """The speed of the first descent to a point."""
    slow_mm_s: Speed = 2.0
    """The speed of the descents that are measured."""
    retract_mm: Positive = 2.0
    """The lift between two descents to the same point."""
    samples: Annotated[int, Field(ge=1, le=50)] = 1
    """The measured descents to each point."""
    result: Literal["median", "mean"] = "median"
    """How several samples are combined."""
    tolerance_mm: Annotated[float, Field(gt=0, le=10)] = 0.05
    """The maximum difference between the samples of one point."""
    retries: Annotated[int, Field(ge=0, le=20)] = 2
    """How often a point whose samples differ by more is measured again."""
    settle_s: Annotated[float, Field(ge=0, le=10)] = 0.0
    """The pause before each descent."""
    open_within_mm: Annotated[float, Field(gt=0, le=20)] = 3.0
    """The maximum further lift at which a triggered probe must open."""
    arm_gcode: str = ""
    """A template of G-code that runs before each descent, in the language of macros: a nozzle that
    is the probe cools down, or motors get less current. It must not move the axes."""
    disarm_gcode: str = ""
    """A template of G-code that runs after each descent, also after one that failed."""
    twist: dict[Literal["x", "y"], Twist] = {}
    """The correction of measured heights along X or Y for a twisted rail."""
    heaters_off: list[PartName] = []
    """Heaters that are off during each descent, since they disturb the probe; they stay on in a
    descent that may take longer than 20 s."""

    @property
    @abstractmethod
    def wired_at(self) -> str:
        """A pin or a bus that names the board of the probe."""


class SwitchProbe(SensingProbe):
    """A probe with an input."""

    pin: Pin
    """The input of the probe, on any board. `!` inverts it, `^` asks for the pull-up."""

    @property
    def wired_at(self) -> str:
        """The input."""
        return self.pin


def not_deployed(found: str, expected: str) -> CommandError:
    """The error of a probe that cannot be deployed."""
    return CommandError.of("probe.not-deployed", value=found, limit=expected)


def not_stowed(found: str, expected: str) -> CommandError:
    """The error of a probe that cannot be stowed."""
    return CommandError.of("probe.not-stowed", value=found, limit=expected)
