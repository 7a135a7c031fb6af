"""A conversion in progress, which the parts of a configuration share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from passo.config.importing.draft import bad

if TYPE_CHECKING:
    from passo.config.importing.aprinter.boards import Pins
    from passo.config.importing.aprinter.document import Node, Stored
    from passo.config.importing.draft import Draft, KeyPath
    from passo.config.importing.numbers import Read


@dataclass
class Job:
    """The input and the output of the conversion. `motors` maps steppers to their names in the
    machine file; those of `arms` turn, so that their unit is a degree."""

    config: Node
    pins: Pins
    stored: Stored
    draft: Draft
    motors: dict[str, str] = field(default_factory=dict[str, str])
    arms: set[str] = field(default_factory=set[str])

    def put(self, path: KeyPath, found: Read | None, scale: float = 1.0) -> None:
        """Sets a key to a number that was read."""
        if found is not None:
            self.draft.put(path, float(f"{found.value * scale:.10g}"), found.place)

    def put_number(self, path: KeyPath, node: Node, key: str, option: str = "") -> None:
        """Sets a key to a number of the document or its stored option, if there is one. Raises
        ConfigError."""
        self.put(path, self.stored.number(node, key, option))

    def put_axis_limits(self, path: KeyPath, axis: Node) -> None:
        """Sets the limits and the speed of an axis that several motors move. Raises ConfigError."""
        name = axis.text("Name")
        for key, word in (("min_mm", "MinPos"), ("max_mm", "MaxPos"), ("speed_mm_s", "MaxSpeed")):
            self.put((*path, key), self.stored.needed(axis, word, f"{name}{word}"))

    def stepper(self, name: Node | None) -> Node:
        """The stepper of this name. Raises ConfigError."""
        for one in self.config.each("steppers"):
            if name is not None and one.text("Name") == name.scalar:
                return one
        place = name.place if name else self.config.place
        raise bad(place, "StepperName", str(name.scalar)[:40] if name else "", "a stepper")
