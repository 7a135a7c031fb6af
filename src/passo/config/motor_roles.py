"""The actuator, axis or extruder that each stepper drives; checks and the core use the same
rule."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Drive = Literal["actuator", "axis", "extruder"]


@dataclass(frozen=True, slots=True)
class Driven:
    """The part that a motor drives, and its index among parts of its kind."""

    drive: Drive
    index: int


class Drivable:
    """All parts that a motor of this machine can drive, by name. `actuators` are those of the
    geometry; `axes` are all axes in the order of the core (x, y, z first).
    """

    def __init__(
        self, actuators: Iterable[str], axes: Iterable[str], extruders: Iterable[str]
    ) -> None:
        self.by_name: dict[str, Driven] = {}
        for index, name in enumerate(extruders):
            self.by_name[name] = Driven("extruder", index)
        for index, name in enumerate(axes):
            if index >= 3:
                self.by_name[name] = Driven("axis", index)
        for index, name in enumerate(actuators):
            self.by_name[name] = Driven("actuator", index)

    def of(self, stepper: str, drives: object) -> Driven | None:
        """The part that the motor `stepper` drives; None if neither its `drives` nor its name
        matches a part."""
        if drives is not None:
            return self.by_name.get(drives) if isinstance(drives, str) else None
        return self.by_name.get(stepper) or self.by_name.get(stepper.rstrip("0123456789"))

    def order(self, driven: Driven) -> tuple[int, int]:
        """Sort key: actuators, then further axes, then extruders, each in their own order."""
        return (("actuator", "axis", "extruder").index(driven.drive), driven.index)


def axis_order(names: Iterable[str]) -> list[str]:
    """x, y, z, then the others in the order of the file."""
    first = ["x", "y", "z"]
    return first + [name for name in names if name not in first]
