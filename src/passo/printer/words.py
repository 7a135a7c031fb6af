"""Parameters of commands that the printer handles, out of their text."""

from __future__ import annotations

import re
from typing import NamedTuple

from passo.errors import CommandError

_WORD = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+\.?\d*|\.\d+))?")
_PAIR = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)\s*=\s*(\"[^\"]*\"|\S+)")
_NAN = re.compile(r"\s*nan\b", re.IGNORECASE)
_LARGEST = 1e9  # as in the words of moves


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
        """Letters with their numbers; one without a number is left out, as most are flags. But S
        without a number (S nan is none: heaters), and a number beyond 1e9, raise CommandError."""
        for match in _WORD.finditer(self.text):
            beyond = match[2] is not None and abs(float(match[2])) > _LARGEST
            if beyond or (match[2] is None and match[1] in "Ss" and not _nan_after(match)):
                given = self.text[match.end(1) :].split()
                raise CommandError.of(
                    "command.value",
                    axis=match[1].upper(),
                    value=given[0] if given else "nothing",
                    limit="a number of at most 1e9",
                )
        return dict(words_of(self.text))

    def pairs(self) -> dict[str, str]:
        """KEY=VALUE parameters of an extended command, keys in upper case."""
        return {match[1].upper(): match[2].strip('"') for match in _PAIR.finditer(self.text)}


def _nan_after(match: re.Match[str]) -> bool:
    return _NAN.match(match.string, match.end()) is not None


def words_of(text: str) -> list[tuple[str, float]]:
    """All words of a line with a number of at most 1e9, in order: (letter, number)."""
    return [
        (m[1].upper(), number)
        for m in _WORD.finditer(text)
        if m[2] is not None and abs(number := float(m[2])) <= _LARGEST
    ]
