"""Parameters of commands that the printer handles, out of their text."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import NamedTuple

from passo.errors import WordError
from passo.gcode.registry import ANY, row_of
from passo.gcode.stray import stray_of

_WORD = re.compile(
    r"([A-Z])\s*(?:([-+]?(?:\d+\.?\d*|\.\d+))|(\"[^\"]*\")|(nan)\b)?", re.IGNORECASE | re.ASCII
)
_PAIR = re.compile(
    r"([^\s=]+)(?:\s*=\s*(\"(?:\\.|[^\"\\])*\"|'[^']*'|(?![^\s=]+\s*=)\S+)?)?", re.DOTALL
)
_QUOTED = re.compile(r"\\(.)", re.DOTALL)
_ESCAPE = re.compile(rb"\\([0-9A-Fa-f]{2})")
# Of a whole line of a console, which must hold nothing that has to wait for its turn.
_FORCED = re.compile(
    r"(?=.*F)(?:\s*(?:[STPR]\s*[-+]?(?:\d+\.?\d*|\.\d+)|S\s*nan\b|F(?!\s*[-+.\d])))*\s*",
    re.IGNORECASE,
)
LARGEST = 1e9  # as in the words of moves


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

    def check(self) -> None:
        """Raises WordError for the first word with no number, or one beyond 1e9, unless the
        declaration lets its letter stand alone, for a letter that comes twice, and for a character
        that is not G-code."""
        row = row_of(self.code)
        if self.name or row is None or row.bare is None:
            return
        if row.bare != ANY and (stray := stray_of(self.text, any_character=False)) is not None:
            raise WordError([stray])
        seen = set[str]()
        for match in _WORD.finditer(self.text):
            letter, number, text, nan = match[1].upper(), *match.groups()[1:]
            if letter in seen and row.bare != ANY and letter not in row.repeats:
                raise WordError.of("input.repeated", value=letter)
            seen.add(letter)
            if number is not None:
                if abs(float(number)) > LARGEST:
                    raise WordError.of("input.number", value=letter + written(float(number)))
            elif not (text or (row.nan and letter == "S" if nan else letter in row.bare)):
                if (stray := stray_of(self.text, any_character=True)) is not None:
                    raise WordError([stray])
                raise WordError.of("input.number", value=letter)

    def words(self) -> dict[str, float]:
        """Letters with their numbers; letters alone are left out."""
        return dict(words_of(self.text))

    def pairs(self) -> dict[str, str]:
        """KEY=VALUE parameters of an extended command: see `pairs_of`."""
        return pairs_of(self.text)


def pairs_of(text: str) -> dict[str, str]:
    r"""KEY=VALUE parameters, keys in upper case. A value with blanks stands in " or '; in ", `\"`
    is a quotation mark. Raises WordError for a key without a value."""
    pairs: dict[str, str] = {}
    for match in _PAIR.finditer(text):
        value = match[2]
        if value is None:
            raise WordError.of("input.number", value=match[1][:30])
        if value[:1] in ("'", '"') and value[:1] == value[-1:] and len(value) > 1:
            quote, value = value[0], value[1:-1]
            value = _QUOTED.sub(r"\1", value) if quote == '"' else value
        pairs[match[1].upper()] = value
    return pairs


def written(value: float) -> str:
    """A number without exponent, as people write it; one of more than 30 digits with it."""
    digits = f"{value:.15g}"
    return f"{Decimal(digits):f}" if abs(value) < 1e30 else f"{value:g}"


def numeral(value: float) -> str:
    """A number in commands, to 10 digits: the E of an exponent would be a word of its own."""
    return f"{Decimal(f'{value:.10g}'):f}"


_NO_WORDS = re.compile(r'"[^"]*("|\Z)|\([^)]*(\)|\Z)')
_COMMAND = re.compile(r"[GMT]\s*\d", re.IGNORECASE | re.ASCII)


def worded(text: str) -> str:
    """A command's text without what is quoted or in parentheses."""
    return _NO_WORDS.sub(lambda m: "" if m[1] or m[2] else m[0], text)


def alone(command: Command) -> bool:
    """No other command stands behind it in its line."""
    row = row_of(command.code)
    if command.name or row is None or row.bare in (None, ANY):
        return True
    own = {letter for letter in "GMT" if f" {letter}" in f" {row.parameters}"}
    return not any(m[0][0].upper() not in own for m in _COMMAND.finditer(worded(command.text)))


def forced(command: Command) -> bool:
    """A console's line that sets a heater or a fan at once (F), whichever source moves the
    machine."""
    row = row_of(command.code)
    return row is not None and row.forced and _FORCED.fullmatch(command.text) is not None


def words_of(text: str) -> list[tuple[str, float]]:
    """All words of a line with a number of at most 1e9, in order: (letter, number)."""
    return [
        (m[1].upper(), number)
        for m in _WORD.finditer(text)
        if m[2] is not None and abs(number := float(m[2])) <= LARGEST
    ]


def unescaped(text: str) -> str:
    r"""`\HH` is the byte of that number, in APrinter's strings: of UTF-8, if all are, else of
    Latin-1."""
    raw = _ESCAPE.sub(lambda m: bytes((int(m[1], 16),)), text.strip().encode())
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("latin-1")
