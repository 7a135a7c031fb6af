"""A machine file under construction from another firmware's configuration, and the report of the
import."""

from __future__ import annotations

import re
import uuid
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

from passo.config.machine_text import toml_key, toml_value
from passo.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

Value = str | float | int | bool | list["Value"] | dict[str, "Value"]
KeyPath = tuple[str, ...]
Fate = Literal["changed", "dropped", "decide"]
_SIMULATED = "simulated"
_LONGEST = 60  # characters of a value in a sentence
_NAMES = uuid.UUID("6d6a3f0e-5a0c-5a5d-8f3e-3a4d1f6c2b11")


class Place(NamedTuple):
    """A line of the imported file. A `default` is a value of the other firmware that is not in the
    file; its line is that of the section."""

    file: str
    line: int
    default: bool = False

    def __str__(self) -> str:
        """The place in the form for comments and reports: `printer.cfg:12`."""
        return f"{self.file}:{self.line}{', default' if self.default else ''}"


class Remark(NamedTuple):
    """A remark about a value that was not simply copied: it was changed or dropped, or the user has
    to decide. `what` names the section or the value; `text` explains the reason and the effect."""

    fate: Fate
    place: Place
    what: str
    text: str


def bad(place: Place, key: str, value: str, limit: str) -> ConfigError:
    """The error of a value in the imported file that is outside its limit."""
    value = value if len(value) <= _LONGEST else f"{value[:_LONGEST]}…"
    return ConfigError.of("config.value", place.file, place.line, key=key, value=value, limit=limit)


def plain_name(name: str) -> str:
    """A name of lower-case letters, digits, - and _."""
    plain = re.sub(r"[^a-z0-9_-]+", "_", name.lower()).strip("_") or "part"
    return plain if plain[0].isalpha() else f"n{plain}"


UNSAFE = "a value, without which the heater is not safe"
UNKNOWN_SENSOR = "a sensor that Passo has; docs/reference/sensors.md lists them"
NO_BUS = "three pins for the converter's bus: Passo does not use the chip's SPI unit"
NO_ENDSTOP = "Passo does not have this endstop"
NO_STALLS = "Passo does not detect stalls with this driver"
NO_STALL_PIN = "its driver has no pin that shows stalls"
NO_THRESHOLD = "its threshold is not in the file: STALL_CALIBRATE finds it"
MOTORS_ALONE = "the fan runs with the motors alone, not with heaters"
TWO_APPROACHES = "an axis approaches its endstop twice: it goes back by 3 mm between"  # the default
PROBE_SPEEDS = "the probe homes Z with its own speeds, probe.fast_mm_s and slow_mm_s"


class StoredHeights(NamedTuple):
    """A mesh that the other firmware has stored: its name, the first and last X and Y in mm, the
    heights by row of Y, in mm, and whether its surface is bicubic."""

    name: str
    x_mm: tuple[float, float]
    y_mm: tuple[float, float]
    heights_mm: list[list[float]]
    bicubic: bool


@dataclass
class Draft:
    """The keys of the machine file in the order of writing, each with its value and the place of
    its source (None without one), and the remarks of the report. `meshes`, and settings as
    `commands`, belong in the folder of `--state`."""

    keys: dict[KeyPath, tuple[Value, Place | None]] = field(
        default_factory=dict[KeyPath, tuple[Value, Place | None]]
    )
    remarks: list[Remark] = field(default_factory=list[Remark])
    meshes: list[StoredHeights] = field(default_factory=list[StoredHeights])
    commands: list[str] = field(default_factory=list[str])

    def put(self, path: KeyPath, value: Value | None, place: Place | None) -> None:
        """Sets a key; None leaves it to the default."""
        if value is not None:
            self.keys[path] = (value, place)

    def put_head(self, path: Path, name: str) -> None:
        """Sets the name and the other keys at the head of a machine file, for the configuration in
        a file."""
        self.put(("name",), plain_name(name), None)
        self.put(("uuid",), str(uuid.uuid5(_NAMES, str(path.resolve()))), None)
        self.put(("author",), "passo import", None)
        self.put(("description",), f"From {path.name}", None)

    def simulate(self, until: str) -> None:
        """Makes all boards of the draft simulated, so that nothing moves or heats until the owner
        has decided. `until` completes the sentence of the report."""
        for key, (value, place) in self.keys.items():
            if key[0] in ("board", "boards") and key[-1] == "link" and value != _SIMULATED:
                self.keys[key] = _SIMULATED, place
                if place is not None:
                    name = ".".join(key)
                    self.decide(place, name, f"it is {_SIMULATED} until {until}: then {value!r}")

    def attempt(self, place: Place, what: str, convert: Callable[[], None], part: str) -> bool:
        """Converts a part without which the machine works too. If that is not possible, `part` is
        left out, which is reported, and the result is False."""
        keys = dict(self.keys)
        try:
            convert()
        except ConfigError as error:
            self.keys = keys
            problem = error.problems[0]
            if problem.line is not None:
                place = Place(problem.file, problem.line)
            self.decide(place, what, f"{part} is left out: {problem.sentence}")
            return False
        return True

    def table(self, name: str) -> dict[str, Value]:
        """The values of a table without tables in it, by key."""
        return {path[1]: value for path, (value, _) in self.keys.items() if path[0] == name}

    def number(self, path: KeyPath) -> float:
        """The numeric value of a key. Raises KeyError if the key was not set."""
        value, _ = self.keys[path]
        assert isinstance(value, int | float)
        return value

    def numbers(self, path: KeyPath) -> list[float]:
        """The numbers in the list of a key; empty without the key."""
        value, _ = self.keys.get(path, (None, None))
        items = value if isinstance(value, list) else []
        return [one for one in items if isinstance(one, int | float)]

    def put_no_homing(
        self, axis: str, end: tuple[float, Place] | None, place: Place, what: str, why: str
    ) -> None:
        """Reports an axis or a tower that does not home. An axis has its position after G28 from
        its end, within its limits, which must be in the draft."""
        text = f"{why}: G28 does not move this axis"
        path = ("axes", axis)
        if (*path, "max_mm") in self.keys and end is not None:
            low, high = (self.number((*path, key)) for key in ("min_mm", "max_mm"))
            at = min(max(end[0], low), high)
            self.put((*path, "home_mm"), at, end[1])
            text += f", and takes it to be at {at:g} mm: move it there by hand before"
        self.decide(place, what, text)

    def changed(self, place: Place, what: str, text: str) -> None:
        """Reports a value that has another form in the machine file."""
        self.remarks.append(Remark("changed", place, what, text))

    def dropped(self, place: Place, what: str, text: str) -> None:
        """Reports a section or a value that is not in the machine file."""
        self.remarks.append(Remark("dropped", place, what, text))

    def decide(self, place: Place, what: str, text: str) -> None:
        """Reports a decision that only the owner of the printer can make."""
        self.remarks.append(Remark("decide", place, what, text))

    def text(self, head: str) -> str:
        """The machine file: `head` as comments, then the keys by table. A comment in each line
        names the source of its value."""
        lines = [f"# {line}".rstrip() for line in head.splitlines()]
        tables: dict[KeyPath, list[str]] = {(): []}
        for path, (value, place) in self.keys.items():
            origin = f"  # {place}" if place else ""
            written = _multiline(value) if isinstance(value, str) and "\n" in value else None
            line = f"{toml_key(path[-1])} = {written or toml_value(value)}{origin}"
            tables.setdefault(path[:-1], []).append(line)
        for path, keys in tables.items():
            lines += ["", f"[{'.'.join(map(toml_key, path))}]"] if path else [""]
            lines += keys
        return "\n".join(lines) + "\n"


def _multiline(text: str) -> str:
    """A text over several lines as TOML."""
    if "'''" in text or any(ord(c) < 32 and c not in "\n\t" for c in text):
        return toml_value(text)
    return f"'''\n{text}'''"
