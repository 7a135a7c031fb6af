"""Parameters of commands that the printer handles, out of their text."""

from __future__ import annotations

import re
from typing import NamedTuple

_WORD = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+\.?\d*|\.\d+))?")
_PAIR = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)\s*=\s*(\"[^\"]*\"|\S+)")


class Command(NamedTuple):
    """One command: `letter` and `number` (with `minor` as in M862.3), or a `name` of its own."""

    line: int
    letter: str
    number: int
    minor: int
    name: str
    text: str

    @property
    def code(self) -> str:
        """As people write it: M104, M862.3, SET_VELOCITY_LIMIT."""
        if self.name:
            return self.name
        return f"{self.letter}{self.number}" + (f".{self.minor}" if self.minor else "")

    def words(self) -> dict[str, float]:
        """Letters with their numbers; a letter without a number is left out."""
        return {
            match[1].upper(): float(match[2])
            for match in _WORD.finditer(self.text)
            if match[2] is not None
        }

    def pairs(self) -> dict[str, str]:
        """KEY=VALUE parameters of an extended command, keys in upper case."""
        return {match[1].upper(): match[2].strip('"') for match in _PAIR.finditer(self.text)}


def words_of(text: str) -> list[tuple[str, float]]:
    """All words of a line with a number, in order: (letter, number)."""
    return [(m[1].upper(), float(m[2])) for m in _WORD.finditer(text) if m[2] is not None]
