"""Stores the settings that commands have changed in a file."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isclose
from pathlib import Path
from typing import Any, NamedTuple, cast

from passo.errors import CommandError
from passo.gcode.command import Command
from passo.job.durable_files import load_json, store_json

VERSION = 2  # version 1 contained the commands of all settings, changed or not
# Words that select the target of a command, by its code: a tool, a heater, a motor, a material.
_NAMING = {
    "G29": "IJ",
    "M92": "T",
    "M145": "S",
    "M200": "T",
    "M201": "T",
    "M203": "T",
    "M205": "T",
    "M218": "T",
    "M301": "H",
    "M302": "T",
    "M305": "H",
    "M306": "H",
    "M307": "H",
    "M569": "IT",
    "M603": "T",
    "M666": "S",
    "M906": "IT",
    "M913": "IT",
    "M917": "IT",
    "SET_FILAMENT_SENSOR": "SENSOR=",
    "SET_MOVE": "NAME=",
    "SET_PROBE_POINT": "N=",
    "SKEW_PROFILE": "SET=",
    "SET_PRESSURE_ADVANCE": "EXTRUDER=",
}


class Setting(NamedTuple):
    """One value of a command: the command with the words that select its target, the word of the
    value (with the `=` of an extended command), and the value as text."""

    head: str
    word: str
    value: str

    @property
    def key(self) -> tuple[str, str]:
        """The command and its target, without the value."""
        return self.head, self.word

    def call(self) -> Command:
        """The command that sets only this value."""
        code, *words = f"{self.head} {self.word}{self.value}".split()
        pairs = (word.split("=", 1) if "=" in word else (word[0], word[1:]) for word in words)
        return Command.call(code, **{name: _value(text) for name, text in pairs})

    def __str__(self) -> str:
        """The command that sets only this value, as text."""
        return f"{self.head} {self.word}{self.value}"


def _value(text: str) -> float | str | bool:
    """A value as a number, if it is one; a letter alone is True."""
    try:
        return float(text) if text else True
    except ValueError:
        return text


def settings_in(lines: Iterable[str]) -> Iterator[Setting]:
    """The single values of commands in the form of M503."""
    for line in lines:
        code, *words = line.split()
        pairs = [_pair(word) for word in words]
        naming = _NAMING.get(code, "")
        named = [word + value for word, value in pairs if word in naming or not value]
        head = " ".join([code, *named])
        for word, value in pairs:
            if word not in naming and value:
                yield Setting(head, word, value)


def same(one: str | None, other: str | None) -> bool:
    """Whether two values as text are the same number, to the digits that are stored."""
    if one is None or other is None:
        return one == other
    try:
        return isclose(float(one), float(other), rel_tol=1e-8)
    except ValueError:
        return one == other


def commands_of(settings: Iterable[Setting]) -> list[str]:
    """Commands that set these values, one for each target."""
    words: dict[str, list[str]] = {}
    for setting in settings:
        words.setdefault(setting.head, []).append(setting.word + setting.value)
    return [" ".join([head, *values]) for head, values in words.items()]


def _pair(word: str) -> tuple[str, str]:
    name, equals, value = word.partition("=")
    return (name + equals, value) if equals else (word[0], word[1:])


class Override(NamedTuple):
    """A stored value. `file` is the value of the machine file when it was stored; None if it is
    unknown, or if the file had none."""

    setting: Setting
    file: str | None = None


@dataclass(frozen=True, slots=True)
class Store:
    """The settings file of one machine. A damaged file, or one of another machine or version, is
    refused with the reason."""

    path: Path
    uuid: str

    def save(self, overrides: list[Override]) -> int:
        """Stores values; returns their checksum. When this returns, the values survive a power cut.
        Raises CommandError; then the file is unchanged."""
        rows = [{"set": str(setting), "file": file} for setting, file in overrides]
        crc = _crc(_texts(rows))
        content = {"version": VERSION, "machine": self.uuid, "crc": crc, "settings": rows}
        try:
            store_json(self.path, content)
        except OSError as error:
            raise _refused("settings.unwritable", self.path, str(error.strerror)) from None
        return crc

    def load(self) -> list[Override] | None:
        """The stored values, also from a file of version 1; None if there is no file. Raises
        CommandError with the reason if the file must not be used."""
        try:
            table = load_json(self.path)
        except OSError as error:
            raise _refused("settings.unreadable", self.path, str(error.strerror)) from None
        except ValueError:
            reason = "it is torn, or not a settings file"
            raise _refused("settings.unreadable", self.path, reason) from None
        if table is None:
            return None
        version, found = table.get("version"), table.get("settings")
        rows = cast("list[object]", found) if isinstance(found, list) else None
        if version not in (1, VERSION):
            reason = f"it has version {version}, not {VERSION}"
        elif table.get("machine") != self.uuid:
            reason = "it belongs to another machine"
        elif rows is None or (overrides := _overrides(rows, version)) is None:
            reason = "it holds no commands"
        elif _crc(_texts(rows)) != table.get("crc"):
            reason = "its checksum is wrong"
        else:
            return overrides
        raise _refused("settings.unreadable", self.path, reason)


def _overrides(rows: list[object], version: int) -> list[Override] | None:
    """The values in the rows of a file of this version; None if the rows are invalid."""
    found: list[Override] = []
    for row in rows:
        match row:
            case str() if version == 1 and row.strip():
                found += [Override(setting) for setting in settings_in([row])]
            case {"set": str(text), "file": str() | None as file} if version == VERSION:
                settings = list(settings_in([text])) if text.strip() else []
                if len(settings) != 1:
                    return None
                found.append(Override(settings[0], file))
            case _:
                return None
    return found


def _texts(rows: Iterable[Any]) -> list[str]:
    return [row if isinstance(row, str) else f"{row['set']};{row['file']}" for row in rows]


def _crc(lines: list[str]) -> int:
    return zlib.crc32("\n".join(lines).encode(errors="surrogatepass"))


def _refused(code: str, path: Path, reason: str) -> CommandError:
    return CommandError.of(code, str(path), value=reason)
