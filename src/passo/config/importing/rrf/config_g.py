"""The commands of a config.g: the words of each, with the place of the last one that set them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from passo.config.importing.draft import Place, Value, bad
from passo.config.importing.numbers import NUMBER, number_of
from passo.config.importing.table import Source
from passo.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterator

_CODE = re.compile(r"\s*([GMT]\d+(?:\.\d+)?)(?=\D|$)")
_WORD = re.compile(r'([A-Z])((?:"(?:[^"]|"")*"|\{[^}]*\}|[^\sA-Z";]|(?<=[:!^])[A-Z])*)')
_TEXT = re.compile(r'"(?:[^"]|"")*"|(;)')
# The word that names the part which a command sets, and its number without that word.
_NAMING = {
    "M106": ("P", "0"),
    "M143": ("H", "1"),
    "M208": ("S", "0"),
    "M307": ("H", ""),
    "M308": ("S", ""),
    "M305": ("P", ""),
    "M569": ("P", ""),
    "M563": ("P", ""),
    "G10": ("P", "0"),
    "M572": ("D", "0"),
}
_PARTS_OF_950 = "HFJPSED"


class Command(NamedTuple):
    """A command with its words as they are written."""

    code: str
    words: dict[str, str]
    place: Place


class ConfigG(Source):
    """A file as a source of rows. The option `M308/S1/P` is the word P of the last M308 S1."""

    def __init__(self, text: str, file: str) -> None:
        self.commands: list[Command] = []
        self.skipped: list[Place] = []  # lines of the language of expressions
        self.used: set[str] = set()
        self.words: dict[str, tuple[str, Place]] = {}
        self._end = Place(file, 1, default=True)
        for number, line in enumerate(text.splitlines(), 1):
            self._take(_without_comment(line), Place(file, number))

    def _take(self, line: str, place: Place) -> None:
        code = _CODE.match(line)
        if code is None or line[0].isspace():
            if line.strip():
                self.skipped.append(place)
            return
        words = {letter: value.strip('"') for letter, value in _WORD.findall(line[code.end() :])}
        command = Command(code[1], words, place)
        self.commands.append(command)
        for letter, value in words.items():
            self.words[f"{_head(command)}/{letter}"] = value, place
            if command.code == "M574" and "P" in words and letter in "XYZ":
                self.words[f"M574/{letter}/P"] = words["P"], place
            low, colon, high = value.partition(":")
            if command.code == "M208" and colon:
                self.words[f"M208/S1/{letter}"] = low, place
                self.words[f"M208/S0/{letter}"] = high, place

    def numbers(self, option: str) -> list[float]:
        """The numbers of a word, separated by colons; empty without it. Raises ConfigError."""
        self.used.add(option.partition("/")[0])
        text, place = self.words.get(option, ("", self._end))
        try:
            return [number_of(part) for part in text.split(":")] if text else []
        except ValueError:
            raise bad(place, option, text[:40], NUMBER) from None

    def text(self, option: str) -> str:
        """The text of a word; empty without it."""
        self.used.add(option.partition("/")[0])
        return self.words.get(option, ("", self._end))[0]

    def number(self, option: str, default: float) -> float:
        """The first number of a word."""
        return next(iter(self.numbers(option)), default)

    def value(self, option: str, unit: str) -> tuple[Value, Place] | None:
        """The value of a word; `M203/E#1` is the second number of E, or its last one."""
        word, _, index = option.partition("#")
        found = self.numbers(word)
        if not found:
            return None
        value = found[min(int(index or 0), len(found) - 1)]
        if unit == "backwards":
            return value == 0, self.at(word)
        return int(value) if unit == "count" else value, self.at(word)

    def at(self, option: str) -> Place:
        """The place of a word; the start of the file without it."""
        return self.words.get(option.partition("#")[0], ("", self._end))[1]

    def lacks(self, option: str, why: str) -> ConfigError:
        """The error of a missing word."""
        key = self.what(option)
        return ConfigError.of("config.missing-key", self._end.file, None, key=key, limit=why)

    def named(self, code: str, letter: str) -> Iterator[int]:
        """The numbers of the parts that a command sets: those of heaters of M950 H."""
        heads = dict.fromkeys(option.rpartition("/")[0] for option in self.words)
        for head in heads:
            found = re.fullmatch(rf"{re.escape(code)}/{letter}(\d+)", head)
            if found:
                yield int(found[1])


def _head(command: Command) -> str:
    """The part of an option before its word."""
    letter, usual = _NAMING.get(command.code, ("", ""))
    if command.code == "M950":
        letter = next((one for one in command.words if one in _PARTS_OF_950), "")
    number = command.words.get(letter, usual).partition(":")[0]
    return f"{command.code}/{letter}{number}" if letter and number else command.code


def _without_comment(line: str) -> str:
    mark = next((found for found in _TEXT.finditer(line) if found[1]), None)
    return line[: mark.start()] if mark else line
