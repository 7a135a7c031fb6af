"""The parameters of commands that the printer handles, parsed from their text."""

from __future__ import annotations

import re
from decimal import Decimal
from math import isnan
from typing import NamedTuple

from passo import _core
from passo.errors import CommandError, WordError
from passo.gcode.registry import ANY, row_of
from passo.gcode.stray import stray_of

# KEY=VALUE is not G-code, so the lexer does not split it into words.
_PAIR = re.compile(
    r"([^\s=]+)(?:\s*=\s*(\"(?:\\.|[^\"\\])*\"|'[^']*'|(?![^\s=(]+\s*=)\S+)?)?", re.DOTALL
)
_QUOTED = re.compile(r"\\(.)", re.DOTALL)
_ESCAPE = re.compile(rb"\\([0-9A-Fa-f]{2})")
LARGEST = 1e9  # the limit for words of moves, too


class Command(NamedTuple):
    """One command: `letter` and `number` (with `minor` as in M862.3), or a `name`."""

    line: int
    letter: str
    number: int
    minor: int
    name: str
    text: str

    @property
    def code(self) -> str:
        """The code as users write it: M104, M862.3, SET_VELOCITY_LIMIT."""
        if self.name:
            return self.name
        return f"{self.letter}{self.number}" + (f".{self.minor}" if self.minor else "")

    def check(self) -> None:
        """Raises WordError for the first word without a number (unless the declaration allows its
        letter alone) or with a number beyond 1e9, for a repeated letter, and for a character that
        is not G-code."""
        row = row_of(self.code)
        if self.name or row is None or row.bare is None:
            return
        if row.bare != ANY and (stray := stray_of(self.text, any_character=False)) is not None:
            raise WordError([stray])
        seen = set[str]()
        for letter, number, text in _core.split_text(self.text):
            if not (_is_letter(letter) or letter == '"'):
                continue
            if letter in seen and row.bare != ANY and letter not in row.repeats:
                raise WordError.of("input.repeated", value=letter)
            seen.add(letter)
            nan = number is not None and isnan(number)
            if number is not None and not nan:
                if abs(number) > LARGEST:
                    raise WordError.of("input.number", value=letter + written(number))
            elif nan or text is None or letter == '"':
                if row.nan and letter == "S" if nan else row.bare == ANY or letter in row.bare:
                    continue
                if (stray := stray_of(self.text, any_character=True)) is not None:
                    raise WordError([stray])
                raise WordError.of("input.number", value=letter)

    def check_values(self, *, in_file: bool) -> None:
        """Raises CommandError for a number beyond the bounds of the declaration, for a value that
        only the machine file sets, and for a command that must not be in a file."""
        row = row_of(self.code)
        if row is None:
            return
        if in_file and row.not_in_files:
            raise CommandError.of("command.in-file", axis=row.code)
        letters, table = row.fixed
        for letter, value in self.words().items() if row.bounds or letters else ():
            if letter in letters:
                raise CommandError.of("command.fixed", value=table)
            for bounds in row.bounds:
                if letter in bounds.letters and not bounds.low <= value <= bounds.high:
                    raise CommandError.bad_value(letter, value, bounds.limit)

    def words(self) -> dict[str, float]:
        """The numbers by their letters, without letters that have no number."""
        return dict(words_of(self.text))

    def letters(self) -> list[str]:
        """The letters of all words, in order, with numbers or without."""
        return letters_of(self.text)

    def pairs(self) -> dict[str, str]:
        """KEY=VALUE parameters of an extended command: see `pairs_of`."""
        return pairs_of(self.text)


def pairs_of(text: str) -> dict[str, str]:
    r"""KEY=VALUE parameters, keys in upper case. A value that contains blanks is quoted with " or
    '; within ", `\"` is a quotation mark. Raises WordError for a key without a value."""
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
    """A number without exponent, as users write it; a number of more than 30 digits with
    exponent."""
    digits = f"{value:.15g}"
    return f"{Decimal(digits):f}" if abs(value) < 1e30 else f"{value:g}"


def numeral(value: float) -> str:
    """A number with up to 10 digits and without exponent, for a command: the E of an exponent would
    be another word."""
    return f"{Decimal(f'{value:.10g}'):f}"


def alone(command: Command) -> bool:
    """Whether the line contains no other command after this one."""
    row = row_of(command.code)
    if command.name or row is None or row.bare in (None, ANY):
        return True
    own = {letter for letter in "GMT" if f" {letter}" in f" {row.parameters}"}
    return not any(
        number is not None and number >= 0 and letter in "GMT" and letter not in own
        for letter, number, _ in _core.split_text(command.text)
    )


def forced(command: Command) -> bool:
    """Whether a console's line sets a heater or a fan at once (letter F), even while another source
    moves the machine."""
    row = row_of(command.code)
    if row is None or not row.forced:
        return False
    words = _core.split_text(command.text)
    return any(word[0] == "F" for word in words) and all(_sets_at_once(*word) for word in words)


def _sets_at_once(letter: str, number: float | None, text: str | None) -> bool:
    """Whether a `forced` line may contain this word, because it does not make the command wait."""
    if number is None:
        return letter == "F" and text is None
    return letter == "S" or (letter in "TPR" and not isnan(number))


def words_of(text: str) -> list[tuple[str, float]]:
    """All words of a line with a number of at most 1e9, in order: (letter, number)."""
    return [
        (letter, number)
        for letter, number, _ in _core.split_text(text)
        if number is not None and abs(number) <= LARGEST
    ]


def letters_of(text: str) -> list[str]:
    """The letters of all words of a text, in order, with numbers or without."""
    return [letter for letter, _, _ in _core.split_text(text) if _is_letter(letter)]


def _is_letter(character: str) -> bool:
    return "A" <= character <= "Z"


def unescaped(text: str) -> str:
    r"""The text with each `\HH` of APrinter's strings replaced by the byte of this hexadecimal
    number. The bytes are read as UTF-8 if they are valid, else as Latin-1."""
    raw = _ESCAPE.sub(lambda m: bytes((int(m[1], 16),)), text.strip().encode())
    try:
        return raw.decode()
    except UnicodeDecodeError:
        return raw.decode("latin-1")
