"""An experiment: parameters that a student changes, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TypeAlias

from passo.errors import CommandError
from passo.learn.bilingual import Shown, Words, short_figure
from passo.learn.pictures import Graph, Plane, Table

Value: TypeAlias = float | str


@dataclass(frozen=True, slots=True)
class Choice:
    """One value of a parameter that has only a few; `words` are its name."""

    value: Value
    words: Words = ""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value to change: a slider from `low` to `high` in steps of `step`, or one of `choices`. The
    default is one of these values. `unit` is empty for a count or a name."""

    name: str
    label: Words
    default: Value
    low: float = 0.0
    high: float = 0.0
    step: float = 1.0
    unit: Words = ""
    choices: Sequence[Choice] = ()

    def read(self, given: Value) -> Value:
        """The value of a text or a number. Raises CommandError outside of the bounds."""
        for choice in self.choices:
            if given == choice.value or _number(given) == choice.value:
                return choice.value
        number = _number(given)
        if not self.choices and number is not None and self.low <= number <= self.high:
            return number
        raise CommandError.of("learn.value", axis=self.name, value=given, limit=self.bounds)

    @property
    def bounds(self) -> str:
        """The allowed values, for an error."""
        if self.choices:
            return "one of " + ", ".join(_plain(choice.value) for choice in self.choices)
        return f"{self.low:g} to {self.high:g}"

    def shown(self, value: Value) -> Shown:
        """A value of this parameter in a text."""
        for choice in self.choices:
            if choice.value == value and choice.words:
                return Shown(_plain(value), words=choice.words)
        return Shown(_plain(value), self.unit)


@dataclass(frozen=True, slots=True)
class Number:
    """A result, shown with at most `decimals`. `words` stand in place of the figure, if they are
    given: for a verdict, or a name whose number a question checks."""

    name: str
    label: Words
    value: float
    unit: Words = ""
    decimals: int = 2
    words: Words = ""

    @property
    def shown(self) -> Shown:
        """The result in a text."""
        text = short_figure(self.value, self.decimals) if isfinite(self.value) else "–"
        return Shown(text, self.unit, self.words)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What follows from the parameters."""

    numbers: Sequence[Number]
    graphs: Sequence[Graph] = ()
    planes: Sequence[Plane] = ()
    tables: Sequence[Table] = ()

    def __getitem__(self, name: str) -> float:
        """The value of a number. Raises KeyError."""
        for number in self.numbers:
            if number.name == name:
                return number.value
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Experiment:
    """Parameters and the pure function of them. `compute` takes each parameter by its name; it
    returns within some 100 ms. Equal values give equal results on every computer."""

    name: str
    title: Words
    about: Words
    parameters: Sequence[Parameter]
    compute: Callable[..., Outcome]

    def values(self, given: Mapping[str, Value]) -> dict[str, Value]:
        """All parameters: the given ones, and the defaults. Raises CommandError for an unknown name
        or a value outside of its bounds."""
        known = {parameter.name: parameter for parameter in self.parameters}
        for name in given:
            if name not in known:
                limit = ", ".join(known)
                raise CommandError.of("learn.parameter", axis=self.name, value=name, limit=limit)
        return {
            name: parameter.read(given.get(name, parameter.default))
            for name, parameter in known.items()
        }

    def run(self, given: Mapping[str, Value]) -> Outcome:
        """The outcome of these values and the other defaults. Raises CommandError as `values`."""
        return self.compute(**self.values(given))

    def shown(self, given: Mapping[str, Value]) -> dict[str, Shown]:
        """Every parameter and every number by its name, for texts."""
        values = self.values(given)
        found = {one.name: one.shown(values[one.name]) for one in self.parameters}
        numbers = self.compute(**values).numbers
        return found | {number.name: number.shown for number in numbers}


def _number(given: Value) -> float | None:
    try:
        number = float(given)
    except ValueError:
        return None
    return number if isfinite(number) else None


def _plain(value: Value) -> str:
    return value if isinstance(value, str) else f"{value:.10g}"
