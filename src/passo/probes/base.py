"""What every probe has in common, and what a kind may do with the head that carries it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Protocol

from pydantic import Field

from passo.config.types import Model, Name, Pair, Pin, Positive, Speed
from passo.errors import CommandError

HeightOffset = Annotated[float, Field(ge=-30, le=30)]


class Head(Protocol):
    """The head with its probe. Methods raise Stopped after M108 and M410, unless the probe is being
    stowed after a failure, and MachineError."""

    def triggered(self) -> bool:
        """Asks the board. Lets time pass."""
        ...

    async def sleep(self, seconds: float) -> None:
        """Lets time pass."""

    async def pulse(self, width_us: float, seconds: float) -> None:
        """Pulses the control pin 50 times a second, for a while."""

    @property
    def z_mm(self) -> float:
        """The height of the nozzle, mm of the machine."""
        ...

    async def move(
        self,
        speed_mm_s: float,
        *,
        x: float | None = None,
        y: float | None = None,
        z: float | None = None,
    ) -> None:
        """The nozzle straight to a place, mm of the machine; axes that are not given stay."""


@dataclass(frozen=True, slots=True)
class Mechanism:
    """What a simulated probe does with its head, as `passo._core.ProbeMechanism` has it: pulses of
    a servo in µs, the place of a dock, and where the head leaves to without the probe, mm."""

    kind: Literal["fixed", "servo", "bltouch", "dock"] = "fixed"
    deploy_us: float = 0.0
    stow_us: float = 0.0
    stowed_reads: bool = False
    dock_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    leave_mm: tuple[float, float] = (0.0, 0.0)


class Probe(Model):
    """What every probe has. A probe that does not get to the bed by itself is fixed."""

    travels_to_deploy: ClassVar[bool] = False  # else it is deployed over the first point
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
        """Its simulated counterpart."""
        return Mechanism()

    def start_pulse(self) -> tuple[float, float] | None:
        """Width, µs, and time, s, of the pulses that stow it when the boards start."""
        return None

    def width_us(self, degrees: float) -> float:
        """The pulse of an angle of M280, as Marlin has it."""
        return 544 + degrees * 1856 / 180

    async def deploy(self, head: Head) -> None:
        """Gets it to the bed, before a run. Raises CommandError if it does not get there."""

    async def arm(self, head: Head) -> None:
        """Before each descent. Raises CommandError if the probe is not ready."""

    async def disarm(self, head: Head) -> None:
        """After each descent that has measured; after a failure `stow` follows."""

    async def stow(self, head: Head) -> None:
        """Takes it away from the bed, after a run. Raises CommandError if it is still there."""


class SensingProbe(Probe):
    """A probe with an input."""

    pin: Pin
    """The input of the probe, on any board. `!` inverts it, `^` asks for the pull-up."""
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
    """What counts of several samples."""
    tolerance_mm: Annotated[float, Field(gt=0, le=10)] = 0.05
    """The maximum difference between the samples of one point."""
    retries: Annotated[int, Field(ge=0, le=20)] = 2
    """How often a point whose samples differ by more is measured again."""
    settle_s: Annotated[float, Field(ge=0, le=10)] = 0.0
    """The pause before each descent."""
    open_within_mm: Annotated[float, Field(gt=0, le=20)] = 3.0
    """The maximum further lift at which a triggered probe must open."""
    heaters_off: list[Name] = []
    """Heaters that are off during each descent, since they disturb the probe."""


def not_deployed(found: str, expected: str) -> CommandError:
    """What a probe that does not get to the bed raises."""
    return CommandError.of("probe.not-deployed", value=found, limit=expected)


def not_stowed(found: str, expected: str) -> CommandError:
    """What a probe that does not get away from the bed raises."""
    return CommandError.of("probe.not-stowed", value=found, limit=expected)
