"""The parameters of commands that the printer handles, parsed from their text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from math import isnan
from typing import TYPE_CHECKING, Self, overload

from passo import _core
from passo.errors import CommandError, WordError
from passo.gcode.parameters import LARGEST, Form, number_of
from passo.gcode.registry import Declaration, Kind, row_of
from passo.gcode.stray import stray_of

if TYPE_CHECKING:
    from passo.config.machine import MachineConfig

# KEY=VALUE is not G-code, so the lexer does not split it into words.
_PAIR = re.compile(
    r"([^\s=]+)(?:\s*(=)\s*(\"(?:\\.|[^\"\\])*\"|'[^']*'|(?![^\s=(]+\s*=)\S+)?)?", re.DOTALL
)
_QUOTED = re.compile(r"\\(.)", re.DOTALL)
_ESCAPE = re.compile(rb"\\([0-9A-Fa-f]{2})")


_PLAIN = re.compile(r"[\w.+-]+", re.ASCII)
_CODE = re.compile(r"([A-Z])(\d+)(?:\.(\d))?")
Value = float | str | None  # None: a letter alone
Given = float | str | bool | None  # True: a letter alone; False and None: it is not given


class _Needed(Enum):
    """The default of a parameter that must be given, or has a default in its declaration."""

    DECLARED = "declared"


@dataclass(frozen=True, slots=True)
class Command:
    """One command: `letter` and `number` (with `minor` as in M862.3), or a `name`. `given` are the
    parameters of a command that a program calls; without them, those of the text count."""

    line: int
    letter: str
    number: int
    minor: int
    name: str
    text: str
    given: Mapping[str, Value] | None = None

    @classmethod
    def call(cls, code: str, **given: Given) -> Self:
        """A command with these values, by letter or key."""
        values: dict[str, Value] = {
            name: None if value is True else value
            for name, value in given.items()
            if value is not None and value is not False
        }
        numbered = _CODE.fullmatch(code)
        if numbered is None:
            pairs = (f"{name}={_quoted(value)}" for name, value in values.items())
            return cls(0, "", 0, 0, code, " ".join(pairs), values)
        letter, number, minor = numbered.groups()
        row = row_of(code)
        quote = "" if row is not None and row.kind is Kind.MOTION else '"'  # letters of axes
        words = (f"{name}{_lettered(value, quote)}" for name, value in values.items())
        return cls(0, letter, int(number), int(minor or 0), "", " ".join(words), values)

    @property
    def code(self) -> str:
        """The code as users write it: M104, M862.3, SET_VELOCITY_LIMIT."""
        if self.name:
            return self.name
        return f"{self.letter}{self.number}" + (f".{self.minor}" if self.minor else "")

    @property
    def keyed(self) -> bool:
        """Whether the parameters are KEY=VALUE, not letters as those of `G1 H2`."""
        return bool(self.name) and " " not in self.name

    # -- checks -----------------------------------------------------------------------------------

    def check(self, machine: MachineConfig | None = None, *, in_file: bool = False) -> None:
        """Raises CommandError for parameters that the declaration refuses, on this machine if one
        is given: a letter without a number or a second time, a number beyond 1e9 or beyond its
        range, a text that is not among the choices, a value that only the machine file sets. Raises
        it for a command that must not be in a file, too, and WordError for what is not G-code."""
        row = row_of(self.code)
        if row is None:
            return
        checked = not row.takes_text and bool(row.parameters or not self.name)
        if checked and not self.name and self.given is None:
            self._check_words(row)
        if in_file and row.not_in_files:
            raise CommandError.of("command.in-file", axis=row.code)
        if checked:
            self._check_values(row)
            if row.valid is not None and machine is not None:
                row.valid(self, machine)

    def _check_words(self, row: Declaration) -> None:
        if not row.takes_anything and (stray := stray_of(self.text, any_character=False)):
            raise WordError([stray])
        seen = set[str]()
        for letter, number, text in _core.split_text(self.text):
            if not (_is_letter(letter) or letter == '"'):
                continue
            known = row.by_name.get(letter)
            if letter in seen and not (row.takes_anything or (known and known.repeats)):
                raise WordError.of("input.repeated", value=letter)
            seen.add(letter)
            nan = number is not None and isnan(number)
            if number is not None and not nan:
                if abs(number) > LARGEST:
                    raise WordError.of("input.number", value=letter + written(number))
            elif nan or text is None or letter == '"' or (known and known.numeric):
                if row.takes_anything or (known and (known.nan if nan else known.alone)):
                    continue
                if (stray := stray_of(self.text, any_character=True)) is not None:
                    raise WordError([stray])
                raise WordError.of("input.number", value=letter)

    def _check_values(self, row: Declaration) -> None:
        given = self.values
        for parameter in row.parameters:
            if parameter.required and not given.keys() & set(parameter.names):
                wanted = " or ".join(parameter.names) + ("=" if self.keyed else "")
                raise CommandError.of("command.missing-value", axis=self.code, value=wanted)
        for name, value in given.items():
            parameter = row.by_name.get(name)
            if parameter is None:
                continue
            if parameter.form is Form.REFUSED:
                raise CommandError.of("command.fixed", value=parameter.text)
            if isinstance(value, str):
                stray = stray_of(value, any_character=False) if parameter.numeric else None
                if stray is not None:
                    raise WordError([stray])
                parameter.check_text(name, value)
            elif value is not None:
                parameter.check_number(name, value)

    def unknown(self) -> list[str]:
        """The letters or keys that the declaration of the command does not have."""
        row = row_of(self.code)
        if (
            row is None
            or row.takes_text
            or row.takes_anything
            or (self.keyed and not row.parameters)
        ):
            return []
        return [name for name in self.values if name not in row.by_name]

    # -- values -----------------------------------------------------------------------------------

    def has(self, *names: str) -> bool:
        """Whether one of these parameters is given."""
        return any(name in self.values for name in names)

    @overload
    def value(self, name: str, default: float = ...) -> float: ...

    @overload
    def value(self, name: str, default: None) -> float | None: ...

    def value(self, name: str, default: float | _Needed | None = _Needed.DECLARED) -> float | None:
        """The number of a parameter; without it `default`, or else the default of its declaration.
        Raises CommandError if it has none, and for a text that is not a number."""
        value = self.values.get(name)
        if value is not None:
            return number_of(name, value) if isinstance(value, str) else value
        return self._declared(name) if isinstance(default, _Needed) else default

    @overload
    def integer(self, name: str, default: int = ...) -> int: ...

    @overload
    def integer(self, name: str, default: None) -> int | None: ...

    def integer(self, name: str, default: int | _Needed | None = _Needed.DECLARED) -> int | None:
        """As `value`, for a whole number."""
        if not self.has(name) and not isinstance(default, _Needed):
            return default
        return int(self.value(name))

    def flag(self, name: str) -> bool:
        """Whether a letter is given, alone or with a number that is not 0, or a key with one."""
        if not self.has(name):
            return False
        return self.value(name, 0.0 if self.keyed else 1.0) != 0

    def string(self, name: str, default: str = "") -> str:
        """The text of a parameter."""
        value = self.values.get(name)
        return value if isinstance(value, str) else default

    def _declared(self, name: str) -> float:
        row = row_of(self.code)
        known = row.by_name.get(name) if row is not None else None
        if known is None or known.default is None:
            wanted = f"{name}=" if self.keyed else name
            raise CommandError.of("command.missing-value", axis=self.code, value=wanted)
        return known.default

    @property
    def values(self) -> Mapping[str, Value]:
        """The parameters by letter or key, as they are given."""
        if self.given is not None:
            return self.given
        if self.keyed:
            return self.pairs()
        found = ((k, n, t) for k, n, t in _core.split_text(self.text) if _is_letter(k))
        return {k: t if n is None else None if isnan(n) else n for k, n, t in found}

    def words(self) -> dict[str, float]:
        """The numbers by their letters, without letters that have no number."""
        if self.given is not None:
            return {k: float(v) for k, v in self.given.items() if isinstance(v, float | int)}
        return dict(words_of(self.text))

    def letters(self) -> list[str]:
        """The letters of all words, in order, with numbers or without."""
        return letters_of(self.text) if self.given is None else list(self.given)

    def pairs(self) -> dict[str, str]:
        """KEY=VALUE parameters of an extended command: see `pairs_of`."""
        if self.given is None:
            return pairs_of(self.text)
        return {
            k: numeral(v) if isinstance(v, float | int) else v or "" for k, v in self.given.items()
        }


def pairs_of(text: str) -> dict[str, str]:
    r"""KEY=VALUE parameters, keys in upper case. A value that contains blanks is quoted with " or
    '; within ", `\"` is a quotation mark. KEY= is an empty text.
    Raises WordError for a key alone."""
    pairs: dict[str, str] = {}
    for match in _PAIR.finditer(text):
        value = match[3] or ""
        if match[2] is None:
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
    if command.name or row is None or row.takes_text or row.takes_anything:
        return True
    if command.given is not None:
        return True
    return not any(
        number is not None and number >= 0 and letter in "GMT" and letter not in row.by_name
        for letter, number, _ in _core.split_text(command.text)
    )


def forced(command: Command) -> bool:
    """Whether a console's line sets a heater or a fan at once (letter F), even while another source
    moves the machine."""
    row = row_of(command.code)
    if row is None or not row.forced:
        return False
    if command.given is None:
        words = _core.split_text(command.text)
    else:
        words = [(k, v, None) for k, v in command.given.items() if not isinstance(v, str)]
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


def _lettered(value: Value, quote: str) -> str:
    """A value after its letter, and nothing for a letter alone."""
    if isinstance(value, str):
        return f"{quote}{value}{quote}"
    return "" if value is None else numeral(value)


def _quoted(value: Value) -> str:
    r"""A value of a key. A text with blanks or signs is in quotes, with `\"` for one in it."""
    if not isinstance(value, str):
        return "1" if value is None else numeral(value)
    if _PLAIN.fullmatch(value):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


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
