"""The filters, tests and functions of templates: all of Jinja2, within the bounds of a template."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from random import Random
from typing import Any, cast

from jinja2 import pass_environment
from jinja2.defaults import DEFAULT_NAMESPACE
from jinja2.environment import Environment
from jinja2.filters import FILTERS, make_attrgetter
from jinja2.runtime import Undefined
from jinja2.tests import TESTS

from passo.gcode.template_bounds import Bounds
from passo.gcode.template_words import kind_of

REFUSED: Mapping[str, str] = {
    "lipsum": "it writes filler text",
    "striptags": "it is for web pages, and its time has no bound",
    "urlize": "it is for web pages, and its time has no bound",
}
"""The filters and functions of Jinja2 that templates do not have, each with the reason."""


class _Given:
    """The arguments of a filter: the value first, then those in parentheses."""

    def __init__(self, values: list[Any], named: dict[str, Any]) -> None:
        self.values, self.named = values, named

    def get(self, place: int, name: str, default: Any) -> Any:
        """The argument at this place, or of this name."""
        return self.values[place] if len(self.values) > place else self.named.get(name, default)


def _center(bounds: Bounds, given: _Given) -> None:
    bounds.columns(given.get(1, "width", 80))


def _indent(bounds: Bounds, given: _Given) -> None:
    width = given.get(1, "width", 4)
    bounds.columns(width)
    text = str(given.values[0])
    bounds.replaceable(text, "\n", width if isinstance(width, str) else " " * width)


def _wordwrap(bounds: Bounds, given: _Given) -> None:
    bounds.columns(given.get(3, "wrapstring", None) or "\n")


def _tojson(bounds: Bounds, given: _Given) -> None:
    bounds.columns(given.get(1, "indent", None) or 0)


def _format(bounds: Bounds, given: _Given) -> None:
    bounds.form(str(given.values[0]))


def _round(bounds: Bounds, given: _Given) -> None:
    bounds.decimals(given.get(1, "precision", 0))


def _pieces(bounds: Bounds, given: _Given) -> None:
    count = given.get(1, "linecount", None) or given.get(1, "slices", 0)
    bounds.range(count)


def _replace(bounds: Bounds, given: _Given) -> None:
    old, new = str(given.get(1, "old", "")), str(given.get(2, "new", ""))
    bounds.replaceable(str(given.values[0]), old, new)


_CHECKS: Mapping[str, Callable[[Bounds, _Given], None]] = {
    "batch": _pieces,
    "center": _center,
    "format": _format,
    "indent": _indent,
    "replace": _replace,
    "round": _round,
    "slice": _pieces,
    "tojson": _tojson,
    "wordwrap": _wordwrap,
}
"""Checks of the arguments of filters whose result may be much larger than their value."""


class Library:
    """The filters, tests and functions of one template. `bounds` gives the bounds of the current
    rendering, and `random` its source of random numbers."""

    def __init__(self, bounds: Callable[[], Bounds], random: Callable[[], Random]) -> None:
        self._bounds, self._random = bounds, random
        kept = _kept(FILTERS) | {
            "join": self._joined,
            "random": self._picked,
            "string": _text,
            "sum": self._sum,
        }
        self.filters = {name: self._limited(made, name) for name, made in kept.items()}
        self.tests = {name: self._limited(made) for name, made in TESTS.items()}
        self.functions = _kept(DEFAULT_NAMESPACE) | {"range": self._range}

    def _limited(self, function: Callable[..., Any], name: str = "") -> Callable[..., Any]:
        """A filter or a test that costs steps, and whose arguments and result are limited."""
        # the context or the environment is its first argument
        passed = 1 if hasattr(function, "jinja_pass_arg") else 0
        check = _CHECKS.get(name)

        @wraps(function)
        def limited(*args: Any, **kwargs: Any) -> Any:
            bounds = self._bounds()
            bounds.budget.spend(1)
            given = _Given(
                [bounds.read(one) for one in args[passed:]],
                {key: bounds.read(one) for key, one in kwargs.items()},
            )
            if check:
                check(bounds, given)
            return bounds.sized(function(*args[:passed], *given.values, **given.named))

        return limited

    def _range(self, *args: int) -> range:
        return self._bounds().range(*args)

    @pass_environment
    def _joined(
        self,
        environment: Environment,
        values: Iterable[Any],
        d: Any = "",
        attribute: str | int | None = None,
    ) -> str:
        parts = map(make_attrgetter(environment, attribute), values)
        return str(d).join(self._bounds().texts(parts, str(d)))

    @pass_environment
    def _picked(self, environment: Environment, values: Sequence[Any]) -> Any:
        if not values:
            return environment.undefined("random has no item to choose: the list is empty")
        return self._random().choice(values)

    @pass_environment
    def _sum(
        self,
        environment: Environment,
        values: Iterable[Any],
        attribute: str | int | None = None,
        start: Any = 0,
    ) -> Any:
        parts = map(make_attrgetter(environment, attribute), values)
        if isinstance(start, list | tuple):
            kind = cast("type[list[Any]]", type(cast("object", start)))
            joined = list(cast("list[Any]", start))
            for part in parts:
                if not isinstance(part, kind):
                    raise TypeError(f"sum of lists takes lists, not {kind_of(part)}")
                items = cast("list[Any]", part)
                self._bounds().grow(joined, (items,))
                joined.extend(items)
            return kind(joined)
        total = start
        for part in parts:
            if not isinstance(part, int | float):
                raise TypeError(f"sum takes numbers, not {kind_of(part)}; for lists: start=[]")
            total += part
        return total


def _text(value: object) -> str:
    """The text of a value; empty for a name without a value, as in Klipper: KAMP's line of purging
    takes G10 to be such a name."""
    return "" if isinstance(value, Undefined) else str(value)


def _kept(found: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in found.items() if name not in REFUSED}
