"""Parameters of commands: letters of numbered commands, keys of named ones. A declaration lists
them, each with its kind, unit, range, default and meaning. The checks of a line, the help, the
reference, the completion of consoles and the page follow it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite
from typing import TypedDict, Unpack

from passo.errors import CommandError, WordError

LARGEST = 1e9  # the limit for words of moves, too
AXES = "ABCDEHIJKUVWXYZ"  # letters of axes, extruders and motors


class Form(Enum):
    """What a parameter is written as."""

    NUMBER = "number"
    INTEGER = "whole number"
    FLAG = "flag"  # a letter alone, or with 0 or 1; a key has 0 or 1
    TEXT = "text"
    REST = "rest"  # the rest of the line is a text, not words
    ANYTHING = "anything"  # every letter, with or without a number
    IGNORED = "ignored"  # of other firmware, without an effect
    REFUSED = "refused"  # what the command cannot set; `text` says who does


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a command, or several of the same kind, range and meaning. A number beyond
    `low` and `high` is refused; with `clamped` the nearest limit counts, and a note says so."""

    names: tuple[str, ...]
    form: Form
    text: str
    unit: str = ""
    low: float = -inf
    high: float = inf
    above: bool = False  # `low` itself is refused
    off: bool = False  # 0 is valid, too
    clamped: bool = False
    default: float | None = None
    required: bool = False
    choices: tuple[str, ...] = ()
    alone: bool = False  # a letter that needs no number
    nan: bool = False  # `S nan` is not a number, and switches the heater off
    repeats: bool = False  # the letter may come several times
    also: str = ""  # letters of the same meaning that are not shown

    @property
    def numeric(self) -> bool:
        """Whether the value is a number."""
        return self.form in (Form.NUMBER, Form.INTEGER)

    @property
    def label(self) -> str:
        """The names, as the reference shows them."""
        return " ".join(self.names) + (" …" if self.also else "")

    @property
    def limit(self) -> str:
        """The valid values with their unit; empty if each is valid."""
        if self.choices:
            return (" or " if len(self.choices) == 2 else ", ").join(self.choices)
        unit = f" {self.unit}" if self.unit else ""
        off = "0 (off), or " if self.off else ""
        if isfinite(self.low) and isfinite(self.high):
            if self.form is Form.INTEGER and self.high - self.low == 1:
                return f"{_figure(self.low)} or {_figure(self.high)}{unit}"
            if self.above:
                return f"{off}more than {_figure(self.low)}, at most {_figure(self.high)}{unit}"
            return f"{off}{_figure(self.low)} to {_figure(self.high)}{unit}"
        if isfinite(self.low):
            least = (
                f"more than {_figure(self.low)}{unit}"
                if self.above
                else f"at least {_figure(self.low)}{unit}"
            )
            return f"{off}{least}"
        return f"at most {_figure(self.high)}{unit}" if isfinite(self.high) else ""

    @property
    def usage(self) -> str:
        """The names with unit, range and default, in one line."""
        about = [self.limit or self.unit]
        about += [f"default {self.default:g}"] if self.default is not None else []
        shown = ", ".join(filter(None, about))
        blank = " " if len(self.names) > 1 or self.also else ""
        return f"{self.label}{blank}({shown})" if shown else self.label

    def check_number(self, name: str, value: float) -> None:
        """Raises CommandError for a number beyond the range."""
        if self.clamped or (self.off and value == 0):
            return
        beyond = not self.low <= value <= self.high or (self.above and value == self.low)
        if beyond or (self.form is Form.INTEGER and value != int(value)):
            limit = self.limit or "a whole number"
            raise CommandError.bad_value(name, value, limit)

    def check_text(self, name: str, text: str) -> None:
        """Raises CommandError for the value of a key that is no number, is beyond the range, or is
        not among the choices."""
        if self.form in (Form.NUMBER, Form.INTEGER, Form.FLAG):
            self.check_number(name, number_of(name, text))
        elif self.choices and text.lower() not in (choice.lower() for choice in self.choices):
            shown = text[:30] or "missing"
            raise CommandError.of("command.value", axis=name, value=shown, limit=self.limit)


def _figure(value: float) -> str:
    """A number without an exponent."""
    return f"{value:,.6f}".rstrip("0").rstrip(".")


def number_of(name: str, text: str) -> float:
    """The number that the text of a key is. Raises WordError."""
    try:
        value = float(text)
    except ValueError:
        value = inf
    if not abs(value) <= LARGEST:
        raise WordError.of("input.number", value=f"{name}={text[:30]}" if text else name)
    return value


class _Options(TypedDict, total=False):
    """Further fields of a Parameter."""

    above: bool
    off: bool
    clamped: bool
    default: float
    required: bool
    alone: bool
    nan: bool
    repeats: bool
    also: str


def number(
    names: str,
    text: str,
    unit: str = "",
    low: float = -inf,
    high: float = inf,
    **options: Unpack[_Options],
) -> Parameter:
    """Numbers, by their names with blanks between them. See the fields of Parameter."""
    return Parameter(tuple(names.split()), Form.NUMBER, text, unit, low, high, **options)


def integer(
    names: str, text: str, low: float = -inf, high: float = inf, **options: Unpack[_Options]
) -> Parameter:
    """Whole numbers."""
    return Parameter(tuple(names.split()), Form.INTEGER, text, "", low, high, **options)


def axes(
    names: str,
    text: str,
    unit: str = "",
    low: float = -inf,
    high: float = inf,
    *,
    alone: bool = False,
    but: str = "",
) -> Parameter:
    """Letters of axes, with `names` as examples, but not those of `but`."""
    shown = tuple(names.split())
    also = "".join(letter for letter in AXES if letter not in (*shown, *but))
    return Parameter(shown, Form.NUMBER, text, unit, low, high, alone=alone, also=also)


def flag(names: str, text: str) -> Parameter:
    """Letters that need no number; a number of 0 switches off what they mean."""
    return Parameter(tuple(names.split()), Form.FLAG, text, alone=True)


def text(names: str, text: str, *, required: bool = False) -> Parameter:
    """Texts, of letters in quotes."""
    return Parameter(tuple(names.split()), Form.TEXT, text, alone=True, required=required)


def choice(names: str, text: str, *choices: str, required: bool = False) -> Parameter:
    """Texts out of a list, in any case."""
    shown = tuple(names.split())
    return Parameter(shown, Form.TEXT, text, alone=True, required=required, choices=choices)


def rest(name: str = "", text: str = "") -> Parameter:
    """The rest of the line is a text; no character of it is checked."""
    return Parameter((name,) if name else (), Form.REST, text)


def anything(text: str = "") -> Parameter:
    """Every letter, with or without a number."""
    return Parameter((), Form.ANYTHING, text)


def ignored(names: str) -> Parameter:
    """Letters that other firmware has, and that have no effect here."""
    return Parameter(tuple(names.split()), Form.IGNORED, "", alone=True)


def refused(names: str, table: str) -> Parameter:
    """Letters of values that only a table of the machine file sets."""
    return Parameter(tuple(names), Form.REFUSED, table, alone=True)


def shown(parameters: tuple[Parameter, ...]) -> Iterator[Parameter]:
    """The parameters that a user can give."""
    hidden = (Form.IGNORED, Form.REFUSED)
    return (p for p in parameters if p.form not in hidden and (p.names or p.text))


TOOL = integer("T", "the tool, by default the one in use", 0)
AT_ONCE = flag("F", "at once, not in order with the moves")
