"""The table of an importer: one row for each option of another firmware, with its unit, its key in
the machine file, and a note for the owner. Code is left for what is not one option and one key.

To import another option, add one line to the rows of its group in `FIRMWARE/table.toml`, for
example `{ option = "lift_speed", unit = "mm/s", default = 5.0, key = "lift_mm_s" }`. To import
another kind of section, add a group with `of`, `to`, `alone = true` and its rows, and take its line
out of the group `sections`. Both are in the report, and on the reference page after
`make reference`."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

from pydantic import BaseModel, ConfigDict

from passo.config.importing.draft import Value
from passo.config.importing.numbers import plain
from passo.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from passo.config.importing.draft import Draft, KeyPath, Place
    from passo.config.importing.numbers import Read

# Units whose numbers get a factor. A number of any other unit is the same in the machine file.
FACTORS = {
    "mm/min": 1 / 60,
    "mA": 1e-3,
    "ms": 1e-3,
    "of 255": 1 / 255,
    "s, as µs": 1e6,
    "min": 60.0,
    "per full power": 255.0,
}
INVERSE = "s, as Hz"
# Units of values that are not numbers, or not only one; an importer may have more.
OTHER_UNITS = ("text", "flag", "count", "pin")
Fate = Literal["changed", "decide", "dropped", "built-in"]


class Row(BaseModel):
    """One option. `option` may have several names: the first one in the file counts. Without the
    option, the key gets `default`, or the value of the option `same_as`; `needed` says why there
    must be one. A value that is `omit` gives no key, nor does a number that is not between `above`
    and `below`. A row with `when` counts only if one of these options is on. An option that is on
    `gives` another value. `by_code`: the module of the part reads the option, and the row is for
    the reference page."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    option: str
    key: str = ""
    unit: str = ""
    default: bool | int | float | str | None = None
    same_as: str = ""
    needed: str = ""
    omit: bool | int | float | str | None = None
    above: float | None = None
    below: float | None = None
    when: str = ""
    gives: bool | int | float | str | None = None
    by_code: bool = False
    fate: Fate | None = None
    note: str = ""


class Group(BaseModel):
    """The rows of one kind of part. `of` are its names in the other firmware, `to` is the table of
    the keys; a key that begins with a dot is a whole path. `{name}` in options and keys is filled
    in by the importer. A group with `alone` needs no code: each part of its kind gets its rows.
    A group with `when` counts only if one of these options is on."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    of: str = ""
    to: str = ""
    note: str = ""
    alone: bool = False
    when: str = ""
    rows: tuple[Row, ...] = ()


class Source(Protocol):
    """The part of a configuration from which rows are read."""

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of an option and its place, which marks it as read; None without the option.
        Raises ConfigError."""
        ...

    def at(self, option: str) -> Place | None:
        """The place of an option, or of its default. The option counts as read."""
        found = self.value(option, "text")
        return found[1] if found else None

    def what(self, option: str) -> str:
        """The name of an option in a report."""
        return option.partition("#")[0].replace("/", " ")

    def lacks(self, option: str, why: str) -> ConfigError:
        """The error of a missing option."""
        place, key = self.at(option), self.what(option)
        file, line = (place.file, place.line) if place else ("", None)
        return ConfigError.of("config.missing-key", file, line, key=key, limit=why)


class Table:
    """All groups of an importer by their names, from a TOML file."""

    def __init__(self, groups: Mapping[str, Group]) -> None:
        self.groups = groups

    def put(
        self, draft: Draft, group: str, source: Source, names: Mapping[str, str] | None = None
    ) -> None:
        """Sets the keys of a group, and reports what its rows say. Raises ConfigError."""
        found, names = self.groups[group], names or {}
        for row in found.rows if _holds(found.when, source, names) else ():
            if not row.by_code and _holds(row.when, source, names):
                _put(draft, row, found.to, source, names)

    def notes(self, group: str) -> dict[str, Row]:
        """The rows of a group by option."""
        return {row.option: row for row in self.groups[group].rows}


def path_of(to: str, key: str, names: Mapping[str, str]) -> KeyPath:
    """The path of a key within the table `to`."""
    text = key[1:] if key.startswith(".") else f"{to}.{key}" if to else key
    return tuple(part.format_map(names) for part in text.split("."))


def _put(draft: Draft, row: Row, to: str, source: Source, names: Mapping[str, str]) -> None:
    options = row.option.format_map(names).split()
    option, found = options[0], None
    for name in options:
        if found is None and (found := source.value(name, row.unit if row.key else "text")):
            option = name
        else:
            source.at(name)
    if row.fate is not None and found is not None:
        report(draft, row, found[1], source.what(option))
    if not row.key:
        return
    place = found[1] if found else source.at(option)
    value = found[0] if found else row.default
    if found is None and row.same_as:
        same = source.value(row.same_as, row.unit)
        value = same[0] if same else value
    if value is None:
        if row.needed:
            raise source.lacks(option, row.needed)
        return
    if _counts(row, value):
        gives = row.gives if found else None
        value = converted(value, row.unit) if gives is None else gives
        draft.put(path_of(to, row.key, names), value, place)


def _holds(when: str, source: Source, names: Mapping[str, str]) -> bool:
    """Whether one of these options is on; True without one."""
    found = [source.value(option, "flag") for option in when.format_map(names).split()]
    return not when or any(one is not None and one[0] is True for one in found)


def _counts(row: Row, value: Value) -> bool:
    """Whether a value of the file gives a key."""
    if row.gives is not None and value is False:
        return False
    if isinstance(value, int | float) and not isinstance(value, bool):
        if row.above is not None and value <= row.above:
            return False
        if row.below is not None and value >= row.below:
            return False
    value = converted(value, row.unit)
    return value != row.omit or isinstance(value, bool) != isinstance(row.omit, bool)


def converted(value: Value, unit: str) -> Value:
    """A value with its unit in the unit of the machine file."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        if unit in FACTORS:
            return plain(value * FACTORS[unit])
        if unit == INVERSE:
            return float(f"{1 / value:.6g}") if value else None or 0.0
    return value


def number_in(read: Read, unit: str) -> float | int:
    """A number in a unit; in `count 1 to 256` a whole number within limits. Raises ConfigError."""
    if unit.startswith("count"):
        return read.whole(*(int(part) for part in unit.split() if part.isdigit()))
    return float(read.value) if unit in FACTORS else plain(read.value)


def report(draft: Draft, row: Row, place: Place, what: str) -> None:
    """Reports an option with the note of its row."""
    reports = {
        "decide": draft.decide,
        "dropped": draft.dropped,
        "changed": draft.changed,
        "built-in": draft.changed,
    }
    if row.fate is not None:
        reports[row.fate](place, what, row.note)


@cache
def table_of(file: Path) -> Table:
    """The table in a TOML file."""
    data = tomllib.loads(file.read_text(encoding="utf-8"))
    return Table({name: Group.model_validate(group) for name, group in data.items()})
