"""A conversion in progress, which the parts of a configuration share."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from passo.config.importing.draft import Place, Value
from passo.config.importing.numbers import plain
from passo.config.importing.table import Source, number_in, table_of
from passo.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from passo.config.importing.draft import Draft, KeyPath
    from passo.config.importing.marlin.boards import Pins
    from passo.config.importing.marlin.defines import Defines
    from passo.config.importing.numbers import Read

TABLE = table_of(Path(__file__).with_name("table.toml"))


@dataclass
class Job:
    """The input and the output of the conversion, and results that its steps share. With `mk4duo`,
    sensors have the numbers of MK4duo and StuFW, which differ from Marlin's."""

    defines: Defines
    draft: Draft
    pins: Pins
    mk4duo: bool
    kind: str = "cartesian"
    extruders: int = 1
    hotends: dict[int, str] = field(default_factory=dict[int, str])
    trigger_mm: float | None = None

    def needed(self, *names: str) -> Read:
        """A number that every machine needs. Raises ConfigError if it is missing."""
        found = self.defines.number(*names)
        if found is None:
            raise self.lacks(names[0])
        return found

    def needed_list(self, *names: str) -> list[Read]:
        """Numbers that every machine needs, at least four. Raises ConfigError if they are
        missing."""
        found = self.defines.numbers(*names)
        if found is None or len(found) < 4:
            raise self.lacks(names[0])
        return found

    def lacks(self, name: str) -> ConfigError:
        """The error of a missing define."""
        return ConfigError.of("import.define", str(self.defines.files[0]), value=name)

    def rows(self, group: str, place: Place | None = None, **names: str) -> None:
        """Sets the keys of a group of the table. `place` is that of the part. Raises
        ConfigError."""
        TABLE.put(self.draft, group, _Source(self, place), names)

    def put(self, path: KeyPath, found: Read | None, scale: float = 1.0) -> None:
        """Sets a key to a number that was read, times `scale`."""
        if found is not None:
            self.draft.put(path, plain(found.value * scale), found.place)

    def part(self, name: str, convert: Callable[[], None]) -> bool:
        """Converts a part by the define that asks for it. If that is not possible, the part is left
        out, which is reported, and the result is False."""
        found = self.defines.found.get(name)
        place = found[1] if found else Place(self.defines.files[0].name, 1)
        return self.draft.attempt(place, name, convert, "the part")

    def place(self, *names: str) -> Place:
        """The place of the first of these that is defined; at least one is."""
        name = self.defines.first(*names)
        assert name is not None
        return self.defines.place(name)

    def decide(self, name: str, text: str) -> None:
        """Reports a define that the user has to decide about."""
        self.draft.decide(self.place(name), name, text)

    def changed(self, name: str, text: str) -> None:
        """Reports a define that the machine file has in another form."""
        self.draft.changed(self.place(name), name, text)

    def dropped(self, name: str, text: str) -> None:
        """Reports a define that the machine file does not have."""
        self.draft.dropped(self.place(name), name, text)


class _Source(Source):
    """The defines as a source of rows. `NAME#1` is the second number of an array, or its last one.
    A missing define is an error of the place, if there is one, else of the file."""

    def __init__(self, job: Job, place: Place | None) -> None:
        self._job, self._defines, self._place = job, job.defines, place

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of a define and its place; None without it. Raises ConfigError."""
        name, _, index = option.partition("#")
        value: Value | None
        if self._defines.first(name) is None:
            return None
        match re.split("[ ,]", unit)[0]:
            case "flag":
                value = self._defines.on(name)
            case "text":
                value = self._defines.text(name)
            case "pin":
                value = self._job.pins.given(name, analog="analog" in unit)
            case _:
                found = self._defines.numbers(name) if index else [self._defines.number(name)]
                read = found[min(int(index or 0), len(found) - 1)] if found else None
                value = None if read is None else number_in(read, unit)
        return None if value is None else (value, self._defines.place(name))

    def at(self, option: str) -> Place | None:
        """The place of a define; None without it."""
        name = option.partition("#")[0]
        return self._defines.place(name) if self._defines.first(name) else None

    def lacks(self, option: str, why: str) -> ConfigError:
        """The error of a missing define."""
        key, place = self.what(option), self._place
        if place is None:
            return self._job.lacks(key)
        return ConfigError.of("config.missing-key", place.file, place.line, key=key, limit=why)
