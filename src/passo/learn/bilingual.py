"""Texts in English and Italian, with places for computed values."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

Language: TypeAlias = Literal["en", "it"]
LANGUAGES: tuple[Language, ...] = ("en", "it")

_PLACE = re.compile(r"\{([a-z][a-z0-9_.]*)(:n)?\}")


@dataclass(frozen=True, slots=True)
class Text:
    """One text in both languages. `{name}` is a place for a value with its unit, `{name:n}` for the
    figure alone; `{case.name}` is the value of one case of a lesson."""

    en: str
    it: str

    def of(self, language: Language) -> str:
        """The text in one language."""
        return self.it if language == "it" else self.en


Words: TypeAlias = Text | str
"""A text, or a symbol that both languages share, such as a unit."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A value as a text shows it: the figure, and the unit or an empty text; or `words` in their
    place."""

    figure: str
    unit: Words = ""
    words: Words = ""

    def of(self, language: Language, *, bare: bool = False) -> str:
        """The figure with its unit; `bare`: without."""
        if self.words and not bare:
            return said(self.words, language)
        unit = said(self.unit, language)
        space = "" if unit == "°" else " "
        return self.figure if bare or not unit else f"{self.figure}{space}{unit}"


def said(words: Words, language: Language) -> str:
    """The words in one language."""
    return words if isinstance(words, str) else words.of(language)


def places(text: str) -> list[str]:
    """The names of the values that a text has places for, in their order."""
    return [name for name, _ in _PLACE.findall(text)]


def filled(words: Words, language: Language, values: Mapping[str, Shown]) -> str:
    """The text in one language with its values. Raises KeyError for a place without a value."""
    put: Callable[[re.Match[str]], str] = lambda found: values[found[1]].of(  # noqa: E731
        language, bare=bool(found[2])
    )
    return _PLACE.sub(put, said(words, language))


def figure(value: float, decimals: int) -> str:
    """A number with a fixed count of decimals, and a true minus sign."""
    text = f"{value:.{decimals}f}"
    return text.replace("-", "\N{MINUS SIGN}") if float(text) else text.lstrip("-")


def short_figure(value: float, decimals: int) -> str:
    """Like `figure`, without zeros at the end of the decimals."""
    text = figure(value, decimals)
    return text.rstrip("0").rstrip(".") if "." in text else text
