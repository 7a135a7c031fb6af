"""An option of a section of Klipper: how its text is read, and its default."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

Value: TypeAlias = "str | float | bool | tuple[Value, ...]"
Settings: TypeAlias = Mapping[str, Value]
"""The options of one section that are known already, by name."""
Default: TypeAlias = "Value | Callable[[Settings], Value | None] | None"


@dataclass(frozen=True, slots=True)
class Option:
    """One option. `#` in its name is a number. `read` converts its text. `default` may depend on
    the options before it; without a default, the option has a value only if it is given."""

    name: str
    read: Callable[[str], Value]
    default: Default = None
    expected: str = "a text"

    def can_read(self, value: str) -> bool:
        """Whether a text is a value of the option."""
        try:
            self.read(value)
        except ValueError:
            return False
        return True

    def default_in(self, section: Settings) -> Value | None:
        """The value of the option in a section that does not give it; None for no value."""
        return self.default(section) if callable(self.default) else self.default


Options: TypeAlias = tuple[Option, ...]

_TRUE, _FALSE = ("true", "yes", "on", "1"), ("false", "no", "off", "0")


def text(name: str, default: Default = None) -> Option:
    """An option whose value is a text: a word, a pin, G-code."""
    return Option(name, str, default)


def whole(name: str, default: Default = None) -> Option:
    """An option whose value is a whole number."""
    return Option(name, int, default, "a whole number")


def number(name: str, default: Default = None) -> Option:
    """An option whose value is a number."""
    return Option(name, float, default, "a number")


def flag(name: str, default: Default = None) -> Option:
    """An option whose value is true or false."""
    return Option(name, _true, default, "true or false")


def words(name: str, default: Default = None) -> Option:
    """An option whose value is a list of words."""
    return Option(name, _parts, default, "a list of words")


def numbers(name: str, default: Default = None) -> Option:
    """An option whose value is a list of numbers."""
    return Option(name, _numbers, default, "a list of numbers")


def whole_numbers(name: str, default: Default = None) -> Option:
    """An option whose value is a list of whole numbers."""
    return Option(name, _whole_numbers, default, "a list of whole numbers")


def points(name: str, default: Default = None) -> Option:
    """An option whose value is a list of points, one a line."""
    return Option(name, _points, default, "points, one a line")


def ratios(name: str, default: Default = None) -> Option:
    """An option whose value is a list of ratios: `50:17, 2:1`."""
    return Option(
        name,
        _ratios,
        default,
        "a list of ratios",
    )


def same_as(name: str, factor: float | None = None) -> Callable[[Settings], Value | None]:
    """A default that is another option of the section, or that number times `factor`."""

    def found(section: Settings) -> Value | None:
        value = section.get(name)
        return value * factor if factor is not None and isinstance(value, float) else value

    return found


def _true(value: str) -> bool:
    word = value.strip().lower()
    if word not in _TRUE and word not in _FALSE:
        raise ValueError
    return word in _TRUE


def _parts(value: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in value.split(",")) if value.strip() else ()


def _numbers(value: str) -> tuple[float, ...]:
    return tuple(map(float, _parts(value)))


def _whole_numbers(value: str) -> tuple[int, ...]:
    return tuple(map(int, _parts(value)))


def _ratios(value: str) -> tuple[tuple[float, ...], ...]:
    return tuple(_floats(ratio, ":") for ratio in _parts(value))


def _floats(value: str, between: str) -> tuple[float, ...]:
    return tuple(float(part) for part in value.split(between))


def _points(value: str) -> tuple[tuple[float, ...], ...]:
    return tuple(_floats(line, ",") for line in value.splitlines() if line.strip())
