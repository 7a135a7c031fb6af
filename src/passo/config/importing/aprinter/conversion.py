"""A conversion in progress, which the parts of a configuration share."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.importing.aprinter.document import missing
from passo.config.importing.draft import bad
from passo.config.importing.numbers import plain
from passo.config.importing.table import Source, number_in, table_of

if TYPE_CHECKING:
    from passo.config.importing.aprinter.boards import Pins
    from passo.config.importing.aprinter.document import Node, Stored
    from passo.config.importing.draft import Draft, KeyPath, Place, Value
    from passo.config.importing.numbers import Read
    from passo.errors import ConfigError

TABLE = table_of(Path(__file__).with_name("table.toml"))


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
            self.draft.put(path, plain(found.value * scale), found.place)

    def rows(self, group: str, node: Node | None, prefix: str | None = "", **names: str) -> None:
        """Sets the keys of a group of the table from a node, if there is one. `prefix` begins the
        names of its stored options; None if it has none. Raises ConfigError."""
        if node is not None:
            TABLE.put(self.draft, group, _Source(node, self.stored, prefix), names)

    def transform_steppers(self, transform: Node, motors: str) -> list[Node]:
        """The steppers of a transform, which get these names. Raises ConfigError."""
        steppers: list[Node] = []
        for index, motor in enumerate(motors):
            name = transform.get("Steppers", f"TransformStepper{index}", "StepperName")
            steppers.append(self.stepper(name))
            self.motors[steppers[-1].text("Name")] = motor
        return steppers

    def stepper(self, name: Node | None) -> Node:
        """The stepper of this name. Raises ConfigError."""
        for one in self.config.each("steppers"):
            if name is not None and one.text("Name") == name.scalar:
                return one
        place = name.place if name else self.config.place
        raise bad(place, "StepperName", str(name.scalar)[:40] if name else "", "a stepper")


class _Source(Source):
    """A node as a source of rows, with its stored options."""

    def __init__(self, node: Node, stored: Stored, prefix: str | None) -> None:
        self._node, self._stored, self._prefix = node, stored, prefix

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of an option and its place; None without it. Raises ConfigError."""
        *path, word = option.split("/")
        node, stored = self._node.get(*path), self._stored
        name = "" if self._prefix is None else f"{self._prefix}{word}"
        if node is None:
            return None
        if unit == "flag":
            return stored.flag(node, word, name), (node.get(word) or node).place
        found = stored.number(node, word, name)
        return None if found is None else (number_in(found, unit), found.place)

    def at(self, option: str) -> Place | None:
        """No place: no row has a default."""
        return None

    def lacks(self, option: str, why: str) -> ConfigError:
        """The error of a missing value."""
        *path, word = option.split("/")
        return missing((self._node.get(*path) or self._node).place, word)
